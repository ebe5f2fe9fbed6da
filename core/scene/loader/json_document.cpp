// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/json_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "core/scene/loader/json_error.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

using nlohmann::json;

// An iterator that records how far nlohmann has read.
class TrackingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  TrackingIterator(const char* at, const char** reached) : at_(at), reached_(reached) {}
  reference operator*() const { return *at_; }
  TrackingIterator& operator++() {
    *reached_ = ++at_;
    return *this;
  }
  bool operator==(const TrackingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const TrackingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  const char** reached_;
};

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

// nlohmann's SAX interface; builds the tree.
class TreeBuilder {
 public:
  TreeBuilder(std::string_view text, std::string file, Mistakes& mistakes)
      : text_(text),
        reached_(text.data()),
        counted_(text.data()),
        file_(std::move(file)),
        mistakes_(mistakes) {}

  const char** reached() { return &reached_; }
  JsonValue take_root() { return std::move(root_); }
  const Error& error() const { return error_; }

  bool null() { return add(JsonValue::Null{}); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(json::number_integer_t value) {  // only negative numbers
    return add(JsonValue::Number{static_cast<double>(value), value == 0 ? std::optional(0u) : std::nullopt});
  }
  bool number_unsigned(json::number_unsigned_t value) {
    return add(JsonValue::Number{static_cast<double>(value), value});
  }
  bool number_float(json::number_float_t value, const std::string&) {
    const bool whole = value >= 0 && value <= 9007199254740992.0 && std::floor(value) == value;
    return add(
        JsonValue::Number{value, whole ? std::optional(static_cast<std::uint64_t>(value)) : std::nullopt});
  }
  bool string(std::string& value) { return add(std::move(value)); }
  bool binary(json::binary_t&) { return false; }  // not in JSON text
  bool start_object(std::size_t) { return open(JsonValue::Object{}); }
  bool start_array(std::size_t) { return open(JsonValue::Array{}); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(std::string& key);
  bool parse_error(std::size_t position, const std::string& last_token, const json::exception& error);

 private:
  bool add(decltype(JsonValue::content) content);
  bool open(decltype(JsonValue::content) content);
  bool close();
  void report_repeated_keys(const JsonValue::Object& members);
  int current_line();

  std::string_view text_;
  const char* reached_;
  const char* counted_;  // line_ is counted up to here
  int line_ = 1;
  std::string file_;
  Mistakes& mistakes_;
  JsonValue root_;
  std::vector<JsonValue*> open_;  // from the root to the innermost; their parents do not reallocate meanwhile
  Error error_;
};

// The line of the last non-blank character read: after a number, nlohmann has read one character too many.
int TreeBuilder::current_line() {
  const char* last = reached_;
  while (last > counted_ && is_blank(last[-1])) --last;
  line_ += static_cast<int>(std::count(counted_, last, '\n'));
  counted_ = last;
  return line_;
}

bool TreeBuilder::add(decltype(JsonValue::content) content) {
  JsonValue value{std::move(content), current_line()};
  if (open_.empty()) {
    root_ = std::move(value);
  } else if (auto* array = std::get_if<JsonValue::Array>(&open_.back()->content)) {
    array->push_back(std::move(value));
  } else {
    std::get_if<JsonValue::Object>(&open_.back()->content)->back().value = std::move(value);
  }
  return true;
}

bool TreeBuilder::open(decltype(JsonValue::content) content) {
  if (open_.size() >= static_cast<std::size_t>(kMaxJsonDepth)) {
    error_ = Error{ErrorCode::kInvalidArgument,
                   fmt::format("{}:{}: lists and objects are nested more than {} deep", file_, current_line(),
                               kMaxJsonDepth)};
    return false;
  }
  add(std::move(content));
  if (open_.empty()) {
    open_.push_back(&root_);
  } else if (auto* array = std::get_if<JsonValue::Array>(&open_.back()->content)) {
    open_.push_back(&array->back());
  } else {
    open_.push_back(&std::get_if<JsonValue::Object>(&open_.back()->content)->back().value);
  }
  return true;
}

bool TreeBuilder::close() {
  if (const auto* members = open_.back()->get_if<JsonValue::Object>()) report_repeated_keys(*members);
  open_.pop_back();
  return true;
}

void TreeBuilder::report_repeated_keys(const JsonValue::Object& members) {
  std::map<std::string_view, int> first_lines;
  for (const auto& member : members) {
    const auto [earlier, is_new] = first_lines.emplace(member.key, member.key_line);
    if (!is_new)
      mistakes_.add({member.key_line, ""}, fmt::format("the key {} is already there in line {}",
                                                       in_quotes(member.key), earlier->second));
  }
}

bool TreeBuilder::key(std::string& key) {
  std::get_if<JsonValue::Object>(&open_.back()->content)->push_back({std::move(key), current_line(), {}});
  return true;
}

bool TreeBuilder::parse_error(std::size_t position, const std::string& last_token,
                              const json::exception& error) {
  error_ = explain_json_error(text_, file_, {position, last_token, error.what()});
  return false;
}

}  // namespace

std::string JsonValue::describe() const {
  if (const auto* number = get_if<Number>())
    return number->whole ? fmt::to_string(*number->whole) : fmt::format("{}", number->value);
  if (const auto* text = get_if<std::string>()) return fmt::format("the text {}", in_quotes(*text));
  if (const auto* truth = get_if<bool>()) return *truth ? "true" : "false";
  if (const auto* array = get_if<Array>()) return fmt::format("a list of {}", array->size());
  return get_if<Object>() ? "an object" : "null";
}

Result<JsonValue> parse_json(std::string_view text, const std::string& file, Mistakes& mistakes) {
  // nlohmann treats NUL as the end of the text.
  if (const std::size_t nul = text.find('\0'); nul != std::string_view::npos)
    return fail(explain_nul(text, file, nul));
  TreeBuilder builder(text, file, mistakes);
  const TrackingIterator begin(text.data(), builder.reached()),
      end(text.data() + text.size(), builder.reached());
  constexpr bool kStrict = true, kIgnoreComments = true;
  if (!json::sax_parse(begin, end, &builder, json::input_format_t::json, kStrict, kIgnoreComments))
    return fail(builder.error());
  return builder.take_root();
}

}  // namespace tessera::core
