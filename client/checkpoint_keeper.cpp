// SPDX-License-Identifier: Apache-2.0
#include "client/checkpoint_keeper.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

namespace tessera::client {

CheckpointKeeper::CheckpointKeeper(CheckpointPlan plan, RenderIdentity render, SharedFilm& film,
                                   Notices& notices)
    : plan_(std::move(plan)), render_(std::move(render)), film_(film), notices_(notices) {
  if (!plan_.continues) look_at_file();
  task_.emplace(
      plan_.interval_seconds, [this] { return write(); },
      [this](const std::string& message) { notices_.add("no checkpoint was written: " + message); });
}

core::Status CheckpointKeeper::finish(bool complete) {
  task_.reset();
  if (!complete || plan_.is_kept) return write();
  if (is_foreign_) return {};
  if (std::remove(plan_.path.c_str()) == 0 || errno == ENOENT) return {};
  return core::fail(core::ErrorCode::kUnavailable,
                    fmt::format("cannot remove '{}': {}", plan_.path, std::strerror(errno)));
}

core::Status CheckpointKeeper::write() {
  const std::uint64_t samples = film_.totals().counters.samples;
  if (samples <= samples_in_file_) return {};
  core::Status written = write_checkpoint(plan_.path, render_, film_);
  if (written) {
    samples_in_file_ = samples;
    is_foreign_ = false;
  }
  return written;
}

// An earlier render may have left something there that took days.
void CheckpointKeeper::look_at_file() {
  const auto header = read_checkpoint_header(plan_.path);
  is_foreign_ = !header && header.error().code != core::ErrorCode::kNotFound;
  if (!header) return;
  if (const std::string what = difference(header->render, render_); !what.empty()) {
    is_foreign_ = true;
    return notices_.add(
        fmt::format("'{}' is the checkpoint of another render, and is replaced when this one has its own: {}",
                    plan_.path, what));
  }
  samples_in_file_ = header->totals.counters.samples;
  notices_.add(
      fmt::format("'{}' has samples of this very render: --resume carries on with them", plan_.path));
}

}  // namespace tessera::client
