// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/call_stats.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

namespace tessera::rpc {

namespace {

std::vector<std::chrono::nanoseconds> call_bounds() {
  using std::chrono::milliseconds;
  return {milliseconds(1),      milliseconds(2),     milliseconds(5),    milliseconds(10),
          milliseconds(25),     milliseconds(50),    milliseconds(100),  milliseconds(250),
          milliseconds(500),    milliseconds(1000),  milliseconds(2500), milliseconds(5000),
          milliseconds(10'000), milliseconds(60'000)};
}

std::size_t index_of(const grpc::Status& status) {
  const auto code = static_cast<std::size_t>(std::max(0, static_cast<int>(status.error_code())));
  return code < kStatusCodes ? code : static_cast<std::size_t>(grpc::StatusCode::UNKNOWN);
}

}  // namespace

std::string code_name(std::size_t code) {
  static constexpr std::array<std::string_view, kStatusCodes> kNames{
      "OK",        "CANCELLED",      "UNKNOWN",           "INVALID_ARGUMENT",   "DEADLINE_EXCEEDED",
      "NOT_FOUND", "ALREADY_EXISTS", "PERMISSION_DENIED", "RESOURCE_EXHAUSTED", "FAILED_PRECONDITION",
      "ABORTED",   "OUT_OF_RANGE",   "UNIMPLEMENTED",     "INTERNAL",           "UNAVAILABLE",
      "DATA_LOSS", "UNAUTHENTICATED"};
  return std::string(kNames.at(code));
}

MethodStats::MethodStats() : durations(call_bounds()) {}

CallStats::CallStats(const auth::Methods& methods) {
  for (const auto& [path, method] : methods.all()) methods_.try_emplace(path);
}

CallStats::CallStats(const std::vector<std::string>& names) {
  for (const std::string& name : names) methods_.try_emplace(name);
}

void CallStats::note_rejected(const grpc::Status& status) {
  ++rejected_[index_of(status)];
}

void CallTimer::end(const grpc::Status& status) {
  if (has_ended_.exchange(true)) return;
  --method_.in_progress;
  ++method_.ended[index_of(status)];
  method_.durations.observe(std::chrono::steady_clock::now() - begin_);
}

}  // namespace tessera::rpc
