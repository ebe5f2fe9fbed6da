// SPDX-License-Identifier: Apache-2.0
// A local render as a job of the HTTP API (docs/http-api.md). Thread-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

#include "core/film/film.hpp"
#include "core/image/display.hpp"
#include "core/scene/settings.hpp"
#include "core/view/tile_source.hpp"

namespace tessera::client {

inline constexpr const char* kLocalJobId = "local";

class LocalJob {
 public:
  // `name`: of the scene.
  LocalJob(std::string name, const core::RenderSettings& settings, const core::DisplaySettings& display);

  const std::string& name() const { return name_; }
  const core::RenderSettings& settings() const { return settings_; }
  const core::DisplaySettings& display() const { return display_; }

  // The render begins with the samples of this film.
  void begin(const core::Film& film);
  void add(std::uint64_t samples);
  void end();

  bool has_all_samples() const;
  // In ASCII, so that no name can control a terminal.
  view::JobHeader header() const;
  // "2026-01-31T12:00:00Z"
  std::string started_at() const;

 private:
  using Clock = std::chrono::steady_clock;

  std::uint64_t total_samples() const;

  const std::string name_;
  const core::RenderSettings settings_;
  const core::DisplaySettings display_;
  const std::chrono::system_clock::time_point created_ = std::chrono::system_clock::now();

  mutable std::mutex mutex_;
  // Guarded by mutex_:
  view::Revision revision_ = 1;
  std::uint64_t first_samples_ = 0, samples_ = 0;
  Clock::time_point began_ = Clock::now(), changed_ = began_;
  bool is_over_ = false;
  std::chrono::system_clock::time_point finished_{};
};

}  // namespace tessera::client
