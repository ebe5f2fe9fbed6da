// SPDX-License-Identifier: Apache-2.0
#include "client/frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>

namespace tessera::client {
namespace {

constexpr std::size_t kMaxFrames = 100'000;

tl::unexpected<core::Error> invalid(std::string message) {
  return core::fail(core::ErrorCode::kInvalidArgument, std::move(message));
}

std::optional<std::int32_t> frame_number(std::string_view text) {
  std::int32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = !text.empty() && error == std::errc() && end == text.data() + text.size();
  return is_number && value >= 0 && value <= kMaxFrame ? std::optional(value) : std::nullopt;
}

struct FrameRange {
  std::int32_t first, last, step = 1;
};

// "7", "1-48" or "1-48x2".
std::optional<FrameRange> frame_range(std::string_view text) {
  const std::size_t dash = text.find('-'), cross = text.find('x');
  if (dash == std::string_view::npos) {
    const auto only = frame_number(text);
    return only ? std::optional(FrameRange{*only, *only}) : std::nullopt;
  }
  if (cross < dash) return std::nullopt;
  const auto first = frame_number(text.substr(0, dash));
  const auto last = frame_number(text.substr(dash + 1, std::min(cross, text.size()) - dash - 1));
  const auto step = cross == std::string_view::npos ? std::optional(1) : frame_number(text.substr(cross + 1));
  if (!first || !last || !step || *first > *last || *step == 0) return std::nullopt;
  return FrameRange{*first, *last, *step};
}

// The position and length of the last run of '#' in the file's name.
struct NumberPlace {
  std::size_t begin = std::string_view::npos, digits = 0;
};
NumberPlace number_place(std::string_view path) {
  const std::size_t last = path.rfind('#'), folder = path.rfind('/');
  if (last == std::string_view::npos || (folder != std::string_view::npos && last < folder)) return {};
  const std::size_t before = path.find_last_not_of('#', last);
  const std::size_t begin = before == std::string_view::npos ? 0 : before + 1;
  return {begin, last - begin + 1};
}

// How many frames from `begin` on have the same distance, and that.
FrameRange range_from(std::span<const std::int32_t> frames) {
  if (frames.size() < 2 || frames[1] <= frames[0]) return {frames[0], frames[0]};
  const std::int32_t step = frames[1] - frames[0];
  std::size_t end = 2;
  while (end < frames.size() && frames[end] - frames[end - 1] == step) ++end;
  if (end == 2 && step > 1) return {frames[0], frames[0]};
  return {frames[0], frames[end - 1], step};
}

std::string range_text(const FrameRange& range) {
  if (range.first == range.last) return fmt::to_string(range.first);
  return fmt::format("{}-{}{}", range.first, range.last,
                     range.step == 1 ? "" : fmt::format("x{}", range.step));
}

}  // namespace

void add_frame_list(CLI::App& command, std::vector<std::int32_t>& frames, const std::string& help) {
  command
      .add_option_function<std::string>(
          "--frames",
          [&frames](const std::string& text) {
            auto parsed = parse_frames(text);
            if (!parsed) throw CLI::ValidationError("--frames", parsed.error().message);
            frames = std::move(*parsed);
          },
          help)
      ->type_name("FRAMES");
}

void add_frame_options(CLI::App& command, FrameFlags& flags) {
  add_frame_list(
      command, flags.frames,
      "Frames of an animated scene: 1-48, every second one with 1-48x2, or a list such as 1,5,9-12. "
      "A run of # in the name of a file stands for the number [default: frame 0]");
  command.add_flag("--preview-first", flags.preview_first,
                   "Render the first, the middle and the last frame before the others");
}

std::vector<std::int32_t> render_order(const FrameFlags& flags) {
  std::vector<std::int32_t> order = flags.frames;
  if (!flags.preview_first || order.size() < 3) return order;
  const auto bring_forward = [&order](std::size_t from, std::size_t to) {
    const auto begin = order.begin();
    std::rotate(begin + static_cast<std::ptrdiff_t>(to), begin + static_cast<std::ptrdiff_t>(from),
                begin + static_cast<std::ptrdiff_t>(from) + 1);
  };
  bring_forward(order.size() / 2, 1);
  bring_forward(order.size() - 1, 2);
  return order;
}

core::Result<std::vector<std::int32_t>> parse_frames(std::string_view text) {
  std::vector<std::int32_t> frames;
  std::set<std::int32_t> seen;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const auto range = frame_range(text.substr(begin, end - begin));
    if (!range)
      return invalid(fmt::format("must be frames from 0 to {} such as 1-48, 1-48x2 or 1,5,9-12; got '{}'",
                                 kMaxFrame, text));
    for (std::int32_t frame = range->first; frame <= range->last; frame += range->step) {
      if (!seen.insert(frame).second) return invalid(fmt::format("frame {} is named twice", frame));
      if (frames.size() == kMaxFrames)
        return invalid(fmt::format("must be at most {} frames; got '{}'", kMaxFrames, text));
      frames.push_back(frame);
    }
    begin = end + 1;
  }
  return frames;
}

std::string frames_text(std::span<const std::int32_t> frames) {
  std::string text;
  while (!frames.empty()) {
    const FrameRange range = range_from(frames);
    text += (text.empty() ? "" : ",") + range_text(range);
    frames = frames.subspan(static_cast<std::size_t>((range.last - range.first) / range.step) + 1);
  }
  return text;
}

bool has_frame_number(std::string_view path) {
  return number_place(path).digits > 0;
}

std::string path_of_frame(const std::string& path, std::int32_t frame) {
  const NumberPlace place = number_place(path);
  if (place.digits == 0) return path;
  return path.substr(0, place.begin) + fmt::format("{:0{}}", frame, place.digits) +
         path.substr(place.begin + place.digits);
}

std::vector<std::string> paths_of_frame(const std::vector<std::string>& paths, std::int32_t frame) {
  std::vector<std::string> of_frame;
  for (const std::string& path : paths) of_frame.push_back(path_of_frame(path, frame));
  return of_frame;
}

core::Status check_frame_paths(const std::vector<std::string>& paths, std::size_t frame_count) {
  if (frame_count < 2) return {};
  for (const std::string& path : paths)
    if (!has_frame_number(path))
      return invalid(
          fmt::format("'{}' is one file for {} frames: write the place of the number as in "
                      "out.####.exr",
                      path, frame_count));
  return {};
}

}  // namespace tessera::client
