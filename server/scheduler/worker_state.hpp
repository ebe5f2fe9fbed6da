// SPDX-License-Identifier: Apache-2.0
// A worker's life, as far as it is heard of.
//
//                    Synchronize, draining
//   Synchronize     ┌────────────────────▶
//   ─────────▶ PRESENT                  DRAINING
//                │ ▲ ◀────────────────────┘ │ ▲
//                │ │  Synchronize           │ │ Synchronize, draining
//                │ │                        │ │
//                │ └──Synchronize── SILENT ─┼─┘
//                └──────────────────▶ │ ◀───┘
//             not for lease_duration  │ not for forget_after
//                                     ▼
//                                 FORGOTTEN
//
// It is given leases while it is PRESENT. What it holds when it falls SILENT goes to others. FORGOTTEN is
// final: its entry is gone, and one that comes back begins anew.
#pragma once

#include <string_view>

namespace tessera::scheduler {

enum class WorkerState { kPresent, kDraining, kSilent, kForgotten };

// "present", "draining", …: for sentences.
std::string_view worker_state_name(WorkerState state);

// Whether the arrow is drawn above. A state has no arrow to itself.
bool may_become(WorkerState from, WorkerState to);

}  // namespace tessera::scheduler
