// SPDX-License-Identifier: Apache-2.0
// Why a job failed, for programs. Plain values.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

enum class FailureReason {
  kUnknown,
  kInvalidScene,  // the scene, an override or an output setting is invalid
  kLimit,         // the scene exceeds a limit of the farm
  kWorkersLost,   // workers died or hung, again and again, while they rendered the same samples
  kDeclined,      // workers cannot build the scene
  kFileLost,      // a file of the bundle is lost or damaged
  kFilmLost,      // the stored film is damaged, or its samples can no longer be verified
  kInternal,      // a defect, or a part of the system that does not work
};

// The most workers that a failure names.
inline constexpr std::size_t kMaxFailureWorkers = 8;

struct FailureDetails {
  FailureReason reason = FailureReason::kUnknown;
  // The samples that could not be rendered. Absent if there are none in particular.
  std::optional<WorkItem> item{};
  // The names of the workers that it happened to, at most kMaxFailureWorkers.
  std::vector<std::string> workers{};
  bool operator==(const FailureDetails&) const = default;
};

struct Failure {
  // For people: what happened and what to change.
  std::string message;
  FailureDetails details{};
};

}  // namespace tessera::scheduler
