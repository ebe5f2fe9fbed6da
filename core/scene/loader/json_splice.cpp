// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/json_splice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

using Step = std::variant<std::string, std::size_t>;  // a key, or an index

tl::unexpected<Error> invalid_path(const std::string& path, const std::string& what) {
  return fail(ErrorCode::kInvalidArgument, fmt::format("{}: {}", path, what));
}

// "shapes[2].transform" as its steps; empty if it is no path.
std::vector<Step> steps_of(std::string_view path) {
  std::vector<Step> steps;
  while (!path.empty()) {
    if (path.front() == '[') {
      std::size_t index = 0;
      const auto [end, error] = std::from_chars(path.data() + 1, path.data() + path.size(), index);
      if (error != std::errc() || end == path.data() + path.size() || *end != ']') return {};
      steps.emplace_back(index);
      path.remove_prefix(static_cast<std::size_t>(end - path.data()) + 1);
    } else {
      if (!steps.empty()) {
        if (path.front() != '.') return {};
        path.remove_prefix(1);
      }
      const std::size_t size = std::min(path.find_first_of(".["), path.size());
      if (size == 0) return {};
      steps.emplace_back(std::string(path.substr(0, size)));
      path.remove_prefix(size);
    }
  }
  return steps;
}

// Reads over a text that is valid JSON with comments.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : text_(text) { skip_blanks(); }

  std::size_t position() const { return at_; }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  // Takes the character and what is blank behind it.
  void take() {
    ++at_;
    skip_blanks();
  }
  bool take_if(char c) {
    if (peek() != c) return false;
    take();
    return true;
  }
  // The end of the value here, and then what is blank behind it is skipped.
  std::size_t skip_value();
  std::string take_key();

 private:
  void skip_blanks();
  void skip_string();

  std::string_view text_;
  std::size_t at_ = 0;
};

void Cursor::skip_blanks() {
  while (at_ < text_.size()) {
    const std::string_view rest = text_.substr(at_);
    if (rest.starts_with("//")) {
      at_ += std::min(rest.find('\n'), rest.size());
    } else if (rest.starts_with("/*")) {
      at_ += std::min(rest.find("*/", 2), rest.size() - 2) + 2;
    } else if (rest.starts_with("\xef\xbb\xbf")) {  // a byte order mark
      at_ += 3;
    } else if (rest.front() == ' ' || rest.front() == '\t' || rest.front() == '\r' || rest.front() == '\n') {
      ++at_;
    } else {
      return;
    }
  }
}

void Cursor::skip_string() {
  for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_)
    if (text_[at_] == '\\') ++at_;
  at_ = std::min(at_ + 1, text_.size());
}

std::string Cursor::take_key() {
  const std::size_t begin = at_;
  skip_string();
  const auto key = nlohmann::json::parse(text_.substr(begin, at_ - begin), nullptr, false);
  skip_blanks();
  take_if(':');
  return key.is_string() ? key.get<std::string>() : std::string();
}

std::size_t Cursor::skip_value() {
  int depth = 0;
  std::size_t end = at_;
  do {
    const char c = peek();
    if (c == '"') {
      skip_string();
    } else if (c == '{' || c == '[') {
      ++depth, ++at_;
    } else if (c == '}' || c == ']') {
      --depth, ++at_;
    } else if (c == ',' || c == ':') {
      ++at_;
    } else {
      at_ += std::min(text_.substr(at_).find_first_of(",:{}[]\" \t\r\n/"), text_.size() - at_);
    }
    end = at_;
    skip_blanks();
  } while (depth > 0 && at_ < text_.size());
  return end;
}

// Part of the text to replace.
struct Splice {
  std::size_t begin = 0, end = 0;
  std::string text;
};

// The value as a member of objects that do not exist yet; nothing if there are indices among the steps.
std::optional<std::string> nested(std::span<const Step> steps, std::string value) {
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    const auto* key = std::get_if<std::string>(&*step);
    if (key == nullptr) return std::nullopt;
    value = step + 1 == steps.rend() ? fmt::format("{}: {}", json_string(*key), value)
                                     : fmt::format("{{{}: {}}}", json_string(*key), value);
  }
  return value;
}

class SpliceFinder {
 public:
  SpliceFinder(std::string_view text, const std::string& path, const std::string& value)
      : cursor_(text), path_(path), value_(value), steps_(steps_of(path)) {}

  Result<Splice> find();

 private:
  // Moves to the member or element; without one, the splice that adds a member, or an error.
  std::optional<Result<Splice>> enter(const std::string& key, std::size_t step);
  std::optional<Result<Splice>> enter(std::size_t index, std::size_t step);
  // "camera" for the first step of "camera.position".
  std::string path_to(std::size_t step) const;

  Cursor cursor_;
  const std::string& path_;
  const std::string& value_;
  std::vector<Step> steps_;
};

std::string SpliceFinder::path_to(std::size_t step) const {
  std::string path;
  for (std::size_t i = 0; i < step; ++i) {
    const auto* key = std::get_if<std::string>(&steps_[i]);
    path += key == nullptr ? fmt::format("[{}]", *std::get_if<std::size_t>(&steps_[i]))
                           : (path.empty() ? "" : ".") + *key;
  }
  return path.empty() ? "the scene" : in_quotes(path);
}

std::optional<Result<Splice>> SpliceFinder::enter(const std::string& key, std::size_t step) {
  if (cursor_.peek() != '{') return invalid_path(path_, path_to(step) + " is no object, so it has no keys");
  const std::size_t inside = cursor_.position() + 1;
  cursor_.take();
  const bool is_empty = cursor_.peek() == '}';
  while (cursor_.peek() == '"') {
    if (cursor_.take_key() == key) return std::nullopt;
    cursor_.skip_value();
    cursor_.take_if(',');
  }
  const auto member = nested(std::span(steps_).subspan(step), value_);
  if (!member) return invalid_path(path_, path_to(step + 1) + " is not in the scene");
  return Splice{inside, inside, is_empty ? *member : *member + ", "};
}

std::optional<Result<Splice>> SpliceFinder::enter(std::size_t index, std::size_t step) {
  if (cursor_.peek() != '[') return invalid_path(path_, path_to(step) + " is no list, so it has no elements");
  cursor_.take();
  std::size_t count = 0;
  for (; cursor_.peek() != ']' && cursor_.peek() != '\0'; ++count) {
    if (count == index) return std::nullopt;
    cursor_.skip_value();
    cursor_.take_if(',');
  }
  return invalid_path(path_, fmt::format("{} has {} elements, counted from 0", path_to(step), count));
}

Result<Splice> SpliceFinder::find() {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    auto ended = std::visit([&](const auto& step) { return enter(step, i); }, steps_[i]);
    if (ended) return *std::move(ended);
  }
  const std::size_t begin = cursor_.position();
  return Splice{begin, cursor_.skip_value(), value_};
}

}  // namespace

bool is_value_path(std::string_view path) {
  return !steps_of(path).empty();
}

std::string json_string(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Result<std::string> with_json_value(std::string text, const std::string& path, const std::string& value) {
  const auto splice = SpliceFinder(text, path, value).find();
  if (!splice) return fail(splice.error());
  // Lines of the old value stay, so that places in messages are those of the file.
  const auto lines = std::count(text.begin() + static_cast<std::ptrdiff_t>(splice->begin),
                                text.begin() + static_cast<std::ptrdiff_t>(splice->end), '\n');
  text.replace(splice->begin, splice->end - splice->begin,
               splice->text + std::string(static_cast<std::size_t>(lines), '\n'));
  return text;
}

}  // namespace tessera::core
