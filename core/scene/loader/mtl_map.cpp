#include "core/scene/loader/mtl_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// The options of map statements and what follows them: from `least` to `most` numbers, or else one word.
struct Option {
  std::string_view name;
  int least, most;
};
constexpr int kWord = 0;
constexpr std::array kOptions{Option{"-s", 1, 3},          Option{"-o", 1, 3},
                              Option{"-t", 1, 3},          Option{"-mm", 2, 2},
                              Option{"-bm", 1, 1},         Option{"-boost", 1, 1},
                              Option{"-texres", 1, 3},     Option{"-clamp", 0, kWord},
                              Option{"-blendu", 0, kWord}, Option{"-blendv", 0, kWord},
                              Option{"-cc", 0, kWord},     Option{"-imfchan", 0, kWord},
                              Option{"-type", 0, kWord},   Option{"-colorspace", 0, kWord}};

// Takes as many numbers off the front of `line` as are there, up to `most`. A name that begins with a digit
// ("2.png") is no number, and the last word is the name whatever it looks like.
int take_numbers(std::string_view& line, std::array<float, 3>& numbers, int most) {
  int count = 0;
  while (count < most) {
    std::string_view rest = line;
    const auto number = parse_float(take_word(rest));
    if (!number || rest.empty()) break;
    numbers[static_cast<std::size_t>(count++)] = *number;
    line = rest;
  }
  return count;
}

Status take_option(const Option& option, std::string_view& line, MtlMap& map) {
  if (option.most == kWord) {
    const std::string_view word = take_word(line);
    if (option.name != "-clamp") return {};
    map.clamp = word == "on";
    if (word == "on" || word == "off") return {};
    return mistake(fmt::format("'-clamp' must be followed by on or off, got {}", in_quotes(word)));
  }
  const bool scales = option.name == "-s";
  std::array<float, 3> numbers = scales ? std::array{1.0f, 1.0f, 1.0f} : std::array<float, 3>{};
  if (take_numbers(line, numbers, option.most) < option.least)
    return mistake(fmt::format("'{}' must be followed by {} and the name of a picture, got {}", option.name,
                               option.least == 1 ? "a number" : "2 numbers", in_quotes(line)));
  if (scales) map.scale = {numbers[0], numbers[1]};
  if (option.name == "-o") map.offset = {numbers[0], numbers[1]};
  return {};
}

std::string_view without_quotes(std::string_view name) {
  if (name.size() > 2 && name.front() == '"' && name.back() == '"') return name.substr(1, name.size() - 2);
  return name;
}

}  // namespace

Result<MtlMap> read_mtl_map(std::string_view keyword, std::string_view line) {
  MtlMap map;
  line = trimmed(line);
  while (line.starts_with('-')) {
    const std::string_view name = take_word(line);
    const auto* option =
        std::find_if(kOptions.begin(), kOptions.end(), [&](const Option& o) { return o.name == name; });
    if (option == kOptions.end())
      return mistake(fmt::format("{} is not an option of '{}'", in_quotes(name), keyword));
    if (auto ok = take_option(*option, line, map); !ok) return fail(ok.error());
  }
  map.file = without_quotes(line);
  if (name_without_comment(map.file).empty())
    return mistake(fmt::format("'{}' needs the name of a picture", keyword));
  std::replace(map.file.begin(), map.file.end(), '\\', '/');
  return map;
}

}  // namespace tessera::core
