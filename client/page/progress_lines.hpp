// SPDX-License-Identifier: Apache-2.0
// The progress of a local render for programs (--json): lines on stdout, each the job as the HTTP API has it
// (docs/http-api.md). Not thread-safe.
#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "client/page/local_job.hpp"
#include "client/render_observer.hpp"

namespace tessera::client {

class ProgressLines final : public RenderObserver {
 public:
  // `name`: of the scene.
  ProgressLines(std::string name, const core::RenderSettings& settings, const core::DisplaySettings& display)
      : job_(std::move(name), settings, display) {}

  // Prints the last line, with `written`: the paths of the image files.
  void finish(const std::vector<std::string>& written);

  // ---- RenderObserver: a line at first, and one a second while samples are added ----
  void begin(const core::Film& film, const core::RenderSettings& settings) override;
  std::mutex& film_mutex() override { return film_mutex_; }
  void samples_added(const core::PixelRect& rect, const core::SampleRange& range) override;
  void end() override { job_.end(); }

 private:
  using Clock = std::chrono::steady_clock;

  void print();

  LocalJob job_;
  std::mutex film_mutex_;  // the film is not read after begin()
  Clock::time_point printed_at_{};
};

}  // namespace tessera::client
