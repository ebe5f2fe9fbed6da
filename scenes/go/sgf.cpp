// SPDX-License-Identifier: Apache-2.0
#include "scenes/go/sgf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <iterator>
#include <optional>

namespace tessera::go {
namespace {

using core::ErrorCode;
using core::Result;
using core::Status;

struct Property {
  std::string name;
  std::vector<std::string> values;
  int line = 0;
};

bool is_space(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}
bool is_letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0;
}
std::string trimmed(const std::string& text) {
  const auto first = std::find_if_not(text.begin(), text.end(), is_space);
  const auto last = std::find_if_not(text.rbegin(), std::make_reverse_iterator(first), is_space).base();
  return {first, last};
}

bool is_capital(char c) {
  return std::isupper(static_cast<unsigned char>(c)) != 0;
}

std::string shown(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte > 32 && byte < 127 ? fmt::format("'{}'", c) : fmt::format("the byte {:#04x}", byte);
}

// The beginning of a value, fit for a message of one line.
std::string shown(const std::string& value) {
  constexpr std::size_t kLongest = 20;
  std::string text = value.substr(0, kLongest) + (value.size() > kLongest ? "..." : "");
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

// Splits a file into the properties of its main line: at every branch the first variation is followed, so the
// main line ends at the first ')'.
class Reader {
 public:
  Reader(std::string_view text, const std::string& file_name) : text_(text), file_name_(file_name) {}

  Result<std::vector<Property>> main_line() {
    if (!skip_to_game()) return fail_here("there is no game; a record begins with '(;'");
    std::vector<Property> properties;
    bool in_main_line = true;
    int depth = 0;
    for (skip_space(); position_ < text_.size(); skip_space()) {
      const char c = text_[position_];
      if (is_letter(c)) {
        Result<Property> property = read_property();
        if (!property) return core::fail(property.error());
        if (in_main_line) properties.push_back(std::move(*property));
        continue;
      }
      if (c != '(' && c != ')' && c != ';') return fail_here(shown(c) + " does not belong here");
      ++position_;
      if (c == '(') ++depth;
      if (c == ')') {
        in_main_line = false;
        if (--depth == 0) return properties;
      }
    }
    return fail_here(
        fmt::format("the record ends within a game: {} ')' missing; is the file cut off?", depth));
  }

 private:
  tl::unexpected<core::Error> fail_here(const std::string& message) const {
    return core::fail(ErrorCode::kInvalidArgument, fmt::format("{}:{}: {}", file_name_, line_, message));
  }

  void advance() {
    if (text_[position_++] == '\n') ++line_;
  }
  void skip_space() {
    while (position_ < text_.size() && is_space(text_[position_])) advance();
  }

  // To the '(' of the first "(;"; whatever stands before it is not SGF.
  bool skip_to_game() {
    const int first_line = line_;
    for (; position_ < text_.size(); advance()) {
      if (text_[position_] != '(') continue;
      std::size_t next = position_ + 1;
      while (next < text_.size() && is_space(text_[next])) ++next;
      if (next < text_.size() && text_[next] == ';') return true;
    }
    line_ = first_line;
    return false;
  }

  // FF[3] and older allow small letters in names, which mean nothing: AddBlack is AB.
  Result<Property> read_property() {
    Property property{{}, {}, line_};
    for (; position_ < text_.size() && is_letter(text_[position_]); ++position_) {
      if (is_capital(text_[position_])) property.name += text_[position_];
    }
    if (property.name.empty()) return fail_here("names of properties are capital letters, as in B[dd]");
    for (skip_space(); position_ < text_.size() && text_[position_] == '['; skip_space()) {
      Result<std::string> value = read_value();
      if (!value) return core::fail(value.error());
      property.values.push_back(std::move(*value));
    }
    if (property.values.empty())
      return fail_here(fmt::format("'{0}' has no value; write {0}[...]", property.name));
    return property;
  }

  // From '[' to ']'; a backslash takes the character after it as it is.
  Result<std::string> read_value() {
    const int first_line = line_;
    std::string value;
    for (++position_; position_ < text_.size() && text_[position_] != ']'; advance()) {
      if (text_[position_] == '\\') advance();
      if (position_ >= text_.size()) break;
      value += text_[position_];
    }
    if (position_ >= text_.size()) {
      line_ = first_line;
      return fail_here("the '[' is never closed; add a ']'");
    }
    ++position_;
    return value;
  }

  std::string_view text_;
  const std::string& file_name_;
  std::size_t position_ = 0;
  int line_ = 1;
};

// Turns properties into the record of a game.
class Interpreter {
 public:
  explicit Interpreter(const std::string& file_name) : file_name_(file_name) {}

  Result<GameRecord> record(const std::vector<Property>& properties) {
    for (const Property& property : properties) {
      const Status read = read_about_game(property);
      if (!read) return core::fail(read.error());
    }
    for (const Property& property : properties) {
      const Status read = read_stones(property);
      if (!read) return core::fail(read.error());
    }
    return std::move(record_);
  }

 private:
  tl::unexpected<core::Error> fail_at(const Property& property, const std::string& value,
                                      const std::string& message) const {
    return core::fail(ErrorCode::kInvalidArgument, fmt::format("{}:{}: {}[{}]: {}", file_name_, property.line,
                                                               property.name, shown(value), message));
  }

  Status read_about_game(const Property& property) {
    const std::string value = trimmed(property.values.front());
    if (property.name == "GM" && value != "1") return fail_at(property, value, "not a game of go, GM[1]");
    if (property.name == "SZ") return read_size(property);
    if (property.name == "PB") record_.black = value;
    if (property.name == "PW") record_.white = value;
    if (property.name == "EV") record_.event = value;
    if (property.name == "DT") record_.date = value;
    if (property.name == "RE") record_.result = value;
    return {};
  }

  Status read_size(const Property& property) {
    const std::string value = trimmed(property.values.front());
    const std::size_t colon = value.find(':');
    const std::string width = value.substr(0, colon);
    const auto [end, error] = std::from_chars(width.data(), width.data() + width.size(), record_.size);
    const bool square = colon == std::string::npos || value.substr(colon + 1) == width;
    if (error == std::errc() && end == width.data() + width.size() && square &&
        record_.size >= kMinBoardSize && record_.size <= kMaxBoardSize)
      return {};
    return fail_at(property, value,
                   fmt::format("boards are square, with {} to {} lines", kMinBoardSize, kMaxBoardSize));
  }

  Status read_stones(const Property& property) {
    if (property.name == "B") return read_move(property, Stone::kBlack);
    if (property.name == "W") return read_move(property, Stone::kWhite);
    if (property.name == "AB") return read_set_up(property, Stone::kBlack);
    if (property.name == "AW") return read_set_up(property, Stone::kWhite);
    if (property.name == "AE") return read_set_up(property, Stone::kNone);
    return {};
  }

  // Two small letters, column and row. Absent if they are no point of the board.
  std::optional<Point> point_of(std::string_view letters) const {
    if (letters.size() != 2) return std::nullopt;
    const Point p{letters[0] - 'a', letters[1] - 'a'};
    const bool inside = std::min(p.column, p.row) >= 0 && std::max(p.column, p.row) < record_.size;
    return inside ? std::optional(p) : std::nullopt;
  }

  std::string where_points_are() const {
    const auto last = static_cast<char>('a' + record_.size - 1);
    return fmt::format("not a point of this board; they run from aa to {}{}", last, last);
  }

  Status read_move(const Property& property, Stone color) {
    const std::string value = trimmed(property.values.front());
    if (property.values.size() > 1) return fail_at(property, value, "a move is one point, not several");
    if (value.empty() || value == "tt") {
      record_.actions.push_back({Action::Kind::kPass, color, {}, property.line});
      return {};
    }
    const std::optional<Point> point = point_of(value);
    if (!point) return fail_at(property, value, where_points_are() + ", and a pass is empty");
    record_.actions.push_back({Action::Kind::kMove, color, *point, property.line});
    return {};
  }

  // Each value is a point, or a rectangle between two corners: "aa:cc".
  Status read_set_up(const Property& property, Stone color) {
    for (const std::string& value : property.values) {
      const std::size_t colon = value.find(':');
      const std::string first = value.substr(0, colon);
      const auto from = point_of(first);
      const auto to = point_of(colon == std::string::npos ? first : value.substr(colon + 1));
      if (!from || !to) return fail_at(property, value, where_points_are());
      for (int row = std::min(from->row, to->row); row <= std::max(from->row, to->row); ++row) {
        for (int c = std::min(from->column, to->column); c <= std::max(from->column, to->column); ++c)
          record_.actions.push_back({Action::Kind::kSetUp, color, {c, row}, property.line});
      }
    }
    return {};
  }

  const std::string& file_name_;
  GameRecord record_;
};

}  // namespace

int GameRecord::move_count() const {
  return static_cast<int>(std::count_if(actions.begin(), actions.end(),
                                        [](const Action& a) { return a.kind != Action::Kind::kSetUp; }));
}

Result<GameRecord> parse_sgf(std::string_view text, const std::string& file_name) {
  const Result<std::vector<Property>> properties = Reader(text, file_name).main_line();
  if (!properties) return core::fail(properties.error());
  return Interpreter(file_name).record(*properties);
}

}  // namespace tessera::go
