// SPDX-License-Identifier: Apache-2.0
// The lifecycle of a worker, by its heartbeats.
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
// A PRESENT worker is given leases. The leases of a worker that becomes SILENT go to others. FORGOTTEN is
// final: the entry is removed, and a worker that returns is registered as a new one.
#pragma once

#include <cstddef>
#include <string_view>

namespace tessera::scheduler {

enum class WorkerState { kPresent, kDraining, kSilent, kForgotten };

// "present", "draining", …, for messages.
std::string_view worker_state_name(WorkerState state);

// What a registered worker does.
enum class WorkerActivity {
  kBusy,      // holds leases
  kIdle,      // holds none, and would take some
  kStuck,     // is given none (Worker::stuck)
  kDraining,  // takes none
  kSilent,
};
inline constexpr std::size_t kWorkerActivities = 5;

// "busy", "idle", …
std::string_view worker_activity_name(WorkerActivity activity);

// Whether the diagram has the transition. No state has a transition to itself.
bool may_become(WorkerState from, WorkerState to);

}  // namespace tessera::scheduler
