// SPDX-License-Identifier: Apache-2.0
// The local render as server-sent events: the job at first, and whenever it has changed.
#pragma once

#include <chrono>
#include <string>

#include "client/page/local_job.hpp"
#include "core/http/server.hpp"

namespace tessera::client {

class LocalEvents final : public http::BodySource {
 public:
  // `job` must outlive the stream.
  explicit LocalEvents(const LocalJob& job) : job_(job) {}

  State read(std::string& out, std::size_t max_bytes) override;
  std::chrono::milliseconds longest_wait() const override;

 private:
  using Clock = std::chrono::steady_clock;

  const LocalJob& job_;
  view::Revision sent_ = 0;
  Clock::time_point last_written_{};
};

}  // namespace tessera::client
