// SPDX-License-Identifier: Apache-2.0
// Frames on the command line: ranges such as 1-48x2, and names of files with a place for the number. Pure
// functions.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::client {

inline constexpr std::int32_t kMaxFrame = 1'000'000;

struct FrameFlags {
  std::vector<std::int32_t> frames;  // in the order given; empty: the scene at frame 0
  bool preview_first = false;
};

// Adds --frames. A bad value ends parsing with a sentence that names the flag.
void add_frame_list(CLI::App& command, std::vector<std::int32_t>& frames, const std::string& help);
// Adds --frames and --preview-first in the same way.
void add_frame_options(CLI::App& command, FrameFlags& flags);

// The frames in the order in which they are rendered.
std::vector<std::int32_t> render_order(const FrameFlags& flags);

// "1-48", "1-48x2" for every second one, or a list of these and of numbers such as "1,5,9-12". Each frame
// once. INVALID_ARGUMENT otherwise.
core::Result<std::vector<std::int32_t>> parse_frames(std::string_view text);
// The shortest such text of frames in this order.
std::string frames_text(std::span<const std::int32_t> frames);

// Whether the file's name has a place for the number of a frame: "out.####.exr".
bool has_frame_number(std::string_view path);
// The path with the number at the last place for it, with zeros in front to as many digits as the place has.
std::string path_of_frame(const std::string& path, std::int32_t frame);
std::vector<std::string> paths_of_frame(const std::vector<std::string>& paths, std::int32_t frame);
// INVALID_ARGUMENT if several frames would be written to one file.
core::Status check_frame_paths(const std::vector<std::string>& paths, std::size_t frame_count);

}  // namespace tessera::client
