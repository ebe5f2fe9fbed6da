// SPDX-License-Identifier: Apache-2.0
// Counts calls by method and status code, with the time until the coordinator has answered; and the bytes of
// what calls carry. Lock-free; thread-safe.
#pragma once

#include <grpcpp/support/status.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/auth/methods.hpp"
#include "server/base/duration_histogram.hpp"

namespace tessera::rpc {

inline constexpr std::size_t kStatusCodes = 17;

// "OK", "CANCELLED", …; the codes of gRPC are 0 to 16.
std::string code_name(std::size_t code);

struct MethodStats {
  MethodStats();

  std::atomic<std::int64_t> in_progress{0};
  std::array<std::atomic<std::uint64_t>, kStatusCodes> ended{};  // by status code
  base::DurationHistogram durations;
};

// Bytes of contents, without those of messages around them.
struct Traffic {
  std::atomic<std::uint64_t> blobs_received{0}, blobs_sent{0}, results_received{0}, images_sent{0},
      watched_sent{0};
};

class CallStats {
 public:
  explicit CallStats(const auth::Methods& methods);
  // Of calls that are no methods of gRPC, by their names.
  explicit CallStats(const std::vector<std::string>& names);

  // By path or name. Has every method of the table.
  const std::map<std::string, MethodStats>& methods() const { return methods_; }
  MethodStats& of(const auth::Method& method) { return of(method.path); }
  MethodStats& of(const std::string& name) { return methods_.at(name); }

  void note_rejected(const grpc::Status& status);
  // Calls that were rejected before their message was read, by status code.
  std::uint64_t rejected(std::size_t code) const { return rejected_[code]; }

  Traffic traffic;

 private:
  std::map<std::string, MethodStats> methods_;
  std::array<std::atomic<std::uint64_t>, kStatusCodes> rejected_{};
};

// Measures one call: it begins with the object and ends with end(), or else with the object.
class CallTimer {
 public:
  CallTimer(CallStats& stats, const auth::Method& method) : CallTimer(stats.of(method)) {}
  explicit CallTimer(MethodStats& method) : method_(method) { ++method_.in_progress; }
  ~CallTimer() { end(grpc::Status(grpc::StatusCode::CANCELLED, "")); }
  CallTimer(const CallTimer&) = delete;
  CallTimer& operator=(const CallTimer&) = delete;

  // The first call counts.
  void end(const grpc::Status& status);

 private:
  MethodStats& method_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::atomic<bool> has_ended_{false};
};

}  // namespace tessera::rpc
