// SPDX-License-Identifier: Apache-2.0
#include "client/page/local_events.hpp"

#include <fmt/format.h>

namespace tessera::client {
namespace {

constexpr std::chrono::milliseconds kInterval{500};
constexpr std::chrono::seconds kKeepAliveInterval{15};

}  // namespace

http::BodySource::State LocalEvents::read(std::string& out, std::size_t) {
  const Clock::time_point now = Clock::now();
  if (sent_ == 0) out += "event: reset\ndata: {}\n\n";
  if (const view::JobHeader header = job_.header(); header.revision != sent_) {
    sent_ = header.revision;
    out += fmt::format("id: {}\nevent: jobs\ndata: {{\"jobs\":[{}]}}\n\n", header.revision, header.json);
  } else if (now >= last_written_ + kKeepAliveInterval) {
    out += ": still here\n\n";
  }
  if (!out.empty()) last_written_ = now;
  return State::kWait;
}

std::chrono::milliseconds LocalEvents::longest_wait() const {
  return kInterval;
}

}  // namespace tessera::client
