// SPDX-License-Identifier: Apache-2.0
// Logs and delays rejections. The log has one line in ten seconds at most. Answers to a machine that is
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

  // Notes a rejection. Returns whether the machine was rejected so often that the answer must be delayed.
  bool note(const std::string& machine, const std::string& method, const grpc::Status& why);
  // Logs the last suppressed rejection if it is due. Call it regularly.
  void flush();

 private:
  // The rate for each machine; a burst may have those of ten seconds.
  static constexpr double kPromptAnswersPerSecond = 2;

  CallRate rate_;
  std::mutex mutex_;
  coordinator::RateLimitedLog log_;  // guarded by mutex_
};

}  // namespace tessera::rpc
