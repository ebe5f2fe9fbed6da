// SPDX-License-Identifier: Apache-2.0
// Callers that are not admitted: the log names them, at most once in ten seconds, and those who come again
// and again wait for their answers, so that tokens cannot be guessed in a hurry. Thread-safe.
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

  // Whether this machine has been rejected so often that the answer must be held back.
  bool note(const std::string& machine, const std::string& method, const grpc::Status& why);
  // Logs what is still to be told. To be called regularly.
  void flush();

 private:
  // Of each machine; ten seconds' worth at once.
  static constexpr double kPromptAnswersPerSecond = 2;

  CallRate rate_;
  std::mutex mutex_;
  coordinator::RateLimitedLog log_;  // guarded by mutex_
};

}  // namespace tessera::rpc
