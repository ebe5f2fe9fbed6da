// SPDX-License-Identifier: Apache-2.0
#include "client/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <utility>

namespace tessera::client {
namespace {

constexpr double kSecondsBetweenRedraws = 0.1;
constexpr double kSecondsBetweenLines = 5;
constexpr double kSpeedWindowSeconds = 10;
constexpr int kDefaultColumns = 80;
constexpr int kWidestBar = 40;
constexpr int kNarrowestBar = 5;
constexpr std::size_t kUsualTextWidth = 55;  // keeps the bar's length steady while the numbers grow
constexpr std::string_view kEraseLine = "\r\x1b[K";

int stderr_columns() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kDefaultColumns;
}

double fraction_done(const ProgressState& state) {
  if (state.samples_total == 0) return 0;
  return std::min(1.0, static_cast<double>(state.samples_done) / static_cast<double>(state.samples_total));
}

std::string bar(double fraction, int width) {
  const int filled = static_cast<int>(fraction * width);
  return fmt::format("[{:=<{}}{:<{}}] ", "", filled, filled < width ? ">" : "", width - filled);
}

}  // namespace

ProgressOutput stderr_progress_output() {
  return {::isatty(STDERR_FILENO) == 1, stderr_columns, [](std::string_view text) {
            std::fwrite(text.data(), 1, text.size(), stderr);
            std::fflush(stderr);
          }};
}

ProgressOutput no_progress_output() {
  return {false, [] { return kDefaultColumns; }, [](std::string_view) {}};
}

ProgressLine::ProgressLine(ProgressOutput output, double start_seconds)
    : output_(std::move(output)), start_seconds_(start_seconds), last_drawn_seconds_(start_seconds) {}

void ProgressLine::update(const ProgressState& state, double now_seconds) {
  observe(state, now_seconds);
  const double interval = output_.is_terminal ? kSecondsBetweenRedraws : kSecondsBetweenLines;
  const bool due = now_seconds - last_drawn_seconds_ >= interval;
  if (due || (output_.is_terminal && !on_screen_)) draw(state, now_seconds);
}

void ProgressLine::finish(const ProgressState& state, double now_seconds) {
  observe(state, now_seconds);
  draw(state, now_seconds);
  if (output_.is_terminal) output_.write("\n");
  on_screen_ = false;
}

void ProgressLine::erase() {
  if (on_screen_) output_.write(kEraseLine);
  on_screen_ = false;
}

void ProgressLine::observe(const ProgressState& state, double now_seconds) {
  recent_.push_back({now_seconds, state.samples_done});
  while (recent_.size() > 2 && now_seconds - recent_[1].seconds >= kSpeedWindowSeconds) recent_.pop_front();
}

double ProgressLine::samples_per_second() const {
  const Observation &first = recent_.front(), &last = recent_.back();
  const double seconds = last.seconds - first.seconds;
  if (seconds <= 0 || last.samples_done <= first.samples_done) return 0;
  return static_cast<double>(last.samples_done - first.samples_done) / seconds;
}

std::string ProgressLine::describe(const ProgressState& state, double now_seconds) const {
  const double speed = samples_per_second();
  std::string text =
      fmt::format("{:5.1f}%  {:>5} samples/s", 100 * fraction_done(state), format_count(speed));
  if (speed > 0 && state.samples_done < state.samples_total) {
    const double left = static_cast<double>(state.samples_total - state.samples_done) / speed;
    text += fmt::format("  {} left", format_duration(left));
  }
  text += fmt::format("  {} elapsed", format_duration(now_seconds - start_seconds_));
  if (!state.note.empty()) text += "  " + state.note;
  return text;
}

void ProgressLine::draw(const ProgressState& state, double now_seconds) {
  last_drawn_seconds_ = now_seconds;
  std::string text = describe(state, now_seconds);
  if (!output_.is_terminal) return output_.write(text + "\n");
  // The last column stays free: writing there makes some terminals wrap.
  const int columns = output_.columns() - 1;
  const int room = columns - static_cast<int>(std::max(text.size(), kUsualTextWidth)) - 3;
  if (room >= kNarrowestBar) text.insert(0, bar(fraction_done(state), std::min(room, kWidestBar)));
  text.resize(std::min(text.size(), static_cast<std::size_t>(std::max(columns, 0))));
  output_.write(std::string(kEraseLine) + text);
  on_screen_ = true;
}

std::string format_count(double count) {
  constexpr std::string_view kUnits = "kMGT";
  if (count < 999.5) return fmt::format("{:.0f}", count);
  std::size_t unit = 0;
  for (count /= 1000; count >= 999.5 && unit + 1 < kUnits.size(); ++unit) count /= 1000;
  const int decimals = count < 9.995 ? 2 : count < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f}{}", count, decimals, kUnits[unit]);
}

std::string format_duration(double seconds) {
  constexpr double kLongestSeconds = 1000.0 * 24 * 3600;
  const auto total = static_cast<long>(std::lround(std::clamp(seconds, 0.0, kLongestSeconds)));
  const long hours = total / 3600;
  if (hours >= 24) return fmt::format("{}d {}h", hours / 24, hours % 24);
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, total / 60 % 60, total % 60);
  return fmt::format("{}:{:02}", total / 60, total % 60);
}

}  // namespace tessera::client
