// SPDX-License-Identifier: Apache-2.0
// The progress of long work: one line redrawn on a terminal, plain lines every few seconds
// elsewhere. Time is an argument, in seconds on any steady clock. Not thread-safe.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <string_view>

namespace tessera::client {

// Where the text goes.
struct ProgressOutput {
  bool is_terminal = false;      // whether the line may be redrawn in place
  std::function<int()> columns;  // of the terminal, asked at each drawing, so that resizing works
  std::function<void(std::string_view)> write;  // must flush
};
ProgressOutput stderr_progress_output();
ProgressOutput no_progress_output();

struct ProgressState {
  std::uint64_t samples_done = 0;
  std::uint64_t samples_total = 0;
  std::string note;  // shown at the end of the line where there is room, e.g. "3 workers"
};

class ProgressLine {
 public:
  ProgressLine(ProgressOutput output, double start_seconds);

  // Says where the work stands; draws if enough time has passed. Cheap enough to be called often.
  void update(const ProgressState& state, double now_seconds);
  // Draws a last time, and ends the line.
  void finish(const ProgressState& state, double now_seconds);
  // Takes the line off the terminal so that something else can be printed; the next update() draws it anew.
  void erase();

 private:
  struct Observation {
    double seconds = 0;
    std::uint64_t samples_done = 0;
  };

  void observe(const ProgressState& state, double now_seconds);
  double samples_per_second() const;
  std::string describe(const ProgressState& state, double now_seconds) const;
  void draw(const ProgressState& state, double now_seconds);

  ProgressOutput output_;
  double start_seconds_;
  double last_drawn_seconds_;
  bool on_screen_ = false;
  std::deque<Observation> recent_;  // the last seconds, from which the speed is taken
};

// "950", "1.23k", "45.6M", "7.89G".
std::string format_count(double count);
// "0:07", "12:34", "1:02:03", "3d 4h".
std::string format_duration(double seconds);

}  // namespace tessera::client
