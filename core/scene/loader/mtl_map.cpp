// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/mtl_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// An option of map statements with its arguments: up to `max_numbers` numbers, or else one word.
struct Option {
  std::string_view name;
  int max_numbers;
};
constexpr int kWord = 0;
constexpr std::array kOptions{Option{"-s", 3},          Option{"-o", 3},
                              Option{"-t", 3},          Option{"-mm", 2},
                              Option{"-bm", 1},         Option{"-boost", 1},
                              Option{"-texres", 3},     Option{"-clamp", kWord},
                              Option{"-blendu", kWord}, Option{"-blendv", kWord},
                              Option{"-cc", kWord},     Option{"-imfchan", kWord},
                              Option{"-type", kWord},   Option{"-colorspace", kWord}};

// What stands for the number of a tile in the name of an image, and the first tile.
struct Tiles {
  std::string_view place, first;
};
constexpr std::array kTiles{Tiles{"<UDIM>", "1001"}, Tiles{"<UVTILE>", "u1_v1"}};

class MapReader {
 public:
  MapReader(std::string_view keyword, std::string_view line, int line_number, FileWarnings& warnings)
      : keyword_(keyword), line_(trimmed(line)), warnings_(warnings) {
    map_.line = line_number;
  }

  std::optional<MtlMap> read();

 private:
  void take_option();
  int take_numbers(std::array<float, 3>& numbers, int max_count);
  void set_numbers(std::string_view option, const std::array<float, 3>& numbers, int count);
  void take_clamp();
  void take_channel();
  void use_first_tile();

  template <typename Text>
  void warn(std::string_view kind, const Text& text) {
    warnings_.add(kind, map_.line, text);
  }

  std::string_view keyword_, line_;
  FileWarnings& warnings_;
  MtlMap map_;
};

// The last word is always the name.
bool is_last_word(std::string_view line) {
  take_word(line);
  return line.empty();
}

std::optional<MtlMap> MapReader::read() {
  while (line_.starts_with('-') && !is_last_word(line_)) take_option();
  map_.file = without_quotes(line_);
  use_first_tile();
  const bool is_option = std::any_of(kOptions.begin(), kOptions.end(),
                                     [&](const Option& option) { return option.name == map_.file; });
  if (!name_without_comment(map_.file).empty() && !is_option) return map_;
  warn("map without a name",
       [&] { return fmt::format("'{}' names no image; the line is ignored", keyword_); });
  return std::nullopt;
}

void MapReader::take_option() {
  const std::string_view name = take_word(line_);
  const auto* option =
      std::find_if(kOptions.begin(), kOptions.end(), [&](const Option& o) { return o.name == name; });
  std::array<float, 3> numbers{};
  if (option == kOptions.end()) {
    take_numbers(numbers, 3);
    warn(fmt::format("option {}", name), [&] {
      return fmt::format("{} is not an option of '{}'; it is ignored", in_quotes(name), keyword_);
    });
  } else if (option->name == "-clamp") {
    take_clamp();
  } else if (option->name == "-imfchan") {
    take_channel();
  } else if (option->max_numbers == kWord) {
    if (!is_last_word(line_)) take_word(line_);
  } else {
    set_numbers(name, numbers, take_numbers(numbers, option->max_numbers));
  }
}

// Takes leading numbers off the line, up to `max_count`.
int MapReader::take_numbers(std::array<float, 3>& numbers, int max_count) {
  int count = 0;
  while (count < max_count && !is_last_word(line_)) {
    std::string_view rest = line_;
    const auto number = parse_float(take_word(rest));
    if (!number) break;
    numbers[static_cast<std::size_t>(count++)] = *number;
    line_ = rest;
  }
  return count;
}

void MapReader::set_numbers(std::string_view option, const std::array<float, 3>& numbers, int count) {
  if (count == 0)
    return warn(fmt::format("option {}", option), [&] {
      return fmt::format("'{}' must be followed by a number and the name of an image; it is ignored", option);
    });
  if (option == "-s") map_.scale = {numbers[0], count > 1 ? numbers[1] : 1};
  if (option == "-o") map_.offset = {numbers[0], numbers[1]};
  if (option == "-bm") map_.bump_multiplier = numbers[0];
}

void MapReader::take_clamp() {
  std::string_view rest = line_;
  const std::string_view word = take_word(rest);
  if (word == "on" || word == "off") {
    map_.clamp = word == "on";
    line_ = rest;
  } else {
    warn("-clamp", [&] {
      return fmt::format("'-clamp' must be followed by on or off, got {}; it is ignored", in_quotes(word));
    });
  }
}

// The others are luminance, matte and depth, which the first channel stands for.
void MapReader::take_channel() {
  if (is_last_word(line_)) return;
  const std::string_view word = take_word(line_);
  if (word == "r") map_.channel = TextureChannel::kRed;
  if (word == "g") map_.channel = TextureChannel::kGreen;
  if (word == "b") map_.channel = TextureChannel::kBlue;
}

void MapReader::use_first_tile() {
  for (const Tiles& tiles : kTiles) {
    const std::size_t at = map_.file.find(tiles.place);
    if (at == std::string::npos) continue;
    warn("UDIM", [&] {
      return fmt::format(
          "{} stands for the tiles of an image, which are not supported; tile {} is used for all",
          in_quotes(map_.file), tiles.first);
    });
    map_.file.replace(at, tiles.place.size(), tiles.first);
  }
}

}  // namespace

std::optional<MtlMap> read_mtl_map(std::string_view keyword, std::string_view line, int line_number,
                                   FileWarnings& warnings) {
  return MapReader(keyword, line, line_number, warnings).read();
}

}  // namespace tessera::core
