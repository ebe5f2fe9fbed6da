// SPDX-License-Identifier: Apache-2.0
// Logs and delays rejections. The log has one line in ten seconds at most. Answers to a machine that is
// rejected often are delayed, so that tokens cannot be guessed fast. Thread-safe.
#pragma once

#include <grpcpp/support/status.h>

#include <string>

#include "core/base/mutex.hpp"
#include "core/common/rate_limited_log.hpp"
#include "server/auth/call_rate.hpp"

namespace tessera::auth {

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

  // Logs the line that `take` returns, without the lock.
  template <typename Take>
  void log(Take take);

  CallRate rate_;
  core::Mutex mutex_;
  common::RateLimitedLog log_ TESSERA_GUARDED_BY(mutex_);
};

}  // namespace tessera::auth
