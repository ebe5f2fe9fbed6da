// SPDX-License-Identifier: Apache-2.0
// Callers that are not admitted. The log names one at most once in ten seconds. Answers to a machine that is
// rejected often are delayed, so that tokens cannot be guessed fast. Thread-safe.
#pragma once

#include <grpcpp/support/status.h>

#include <mutex>
#include <string>

#include "server/coordinator/rate_limited_log.hpp"
#include "server/rpc/call_rate.hpp"

namespace tessera::rpc {

class Rejections {
 public:
  Rejections() : rate_(kPromptAnswersPerSecond) {}

  // Whether this machine has been rejected so often that the answer must be delayed.
  bool note(const std::string& machine, const std::string& method, const grpc::Status& why);
  // Logs the last rejection that was left out, if it is time. To be called regularly.
  void flush();

 private:
  // For each machine; bursts can have ten seconds' worth.
  static constexpr double kPromptAnswersPerSecond = 2;

  CallRate rate_;
  std::mutex mutex_;
  coordinator::RateLimitedLog log_;  // guarded by mutex_
};

}  // namespace tessera::rpc
