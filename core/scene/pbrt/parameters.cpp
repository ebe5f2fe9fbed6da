// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/base/letter_case.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core::pbrt {
namespace {

// How the values of a type are written.
enum class ValueKind { kFloat, kInteger, kBoolean, kString, kNumberOrString };

struct TypeEntry {
  std::string_view name;
  ValueKind kind;
};

// The types of pbrt-v4, and those that only earlier versions had: point, vector, color, xyz.
constexpr TypeEntry kTypes[] = {{"float", ValueKind::kFloat},     {"integer", ValueKind::kInteger},
                                {"bool", ValueKind::kBoolean},    {"string", ValueKind::kString},
                                {"texture", ValueKind::kString},  {"point2", ValueKind::kFloat},
                                {"vector2", ValueKind::kFloat},   {"point3", ValueKind::kFloat},
                                {"vector3", ValueKind::kFloat},   {"normal", ValueKind::kFloat},
                                {"normal3", ValueKind::kFloat},   {"point", ValueKind::kFloat},
                                {"vector", ValueKind::kFloat},    {"rgb", ValueKind::kFloat},
                                {"color", ValueKind::kFloat},     {"xyz", ValueKind::kFloat},
                                {"blackbody", ValueKind::kFloat}, {"spectrum", ValueKind::kNumberOrString}};

std::optional<ValueKind> kind_of(std::string_view type) {
  for (const TypeEntry& entry : kTypes)
    if (entry.name == type) return entry.kind;
  return std::nullopt;
}

std::vector<std::string_view> type_names() {
  std::vector<std::string_view> names;
  for (const TypeEntry& entry : kTypes) names.push_back(entry.name);
  return names;
}

std::string_view next_word(std::string_view& text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  std::size_t length = 0;
  while (length < text.size() && !is_space(text[length])) ++length;
  const std::string_view word = text.substr(0, length);
  text.remove_prefix(length);
  return word;
}

std::optional<std::int32_t> parse_integer(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  std::int32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size()) return value;
  // Other programs write whole numbers as 3.0.
  const auto number = parse_number(text);
  if (number && *number == std::floor(*number) && std::fabs(*number) < 2e9f)
    return static_cast<std::int32_t>(*number);
  return std::nullopt;
}

Status add_word(std::string_view text, ValueKind kind, Parameter& parameter) {
  const auto wrong = [&](std::string_view wanted) {
    return mistake(fmt::format("the parameter {} must be {}, got {}", in_quotes(parameter.name), wanted,
                               in_quotes(text)));
  };
  if (kind == ValueKind::kInteger) {
    const auto value = parse_integer(text);
    if (!value) return wrong("a whole number");
    parameter.integers.push_back(*value);
  } else if (kind == ValueKind::kBoolean) {
    if (text != "true" && text != "false") return wrong("true or false");
    parameter.booleans.push_back(text == "true");
  } else if (kind == ValueKind::kString) {
    return wrong("in double quotes");
  } else {
    const auto value = parse_number(text);
    if (!value) return wrong("a number");
    parameter.floats.push_back(*value);
  }
  return {};
}

// Version 3 wrote booleans in quotes.
Status add_value(const Token& token, ValueKind kind, Parameter& parameter) {
  if (!token.is(Token::Kind::kString)) return add_word(token.text, kind, parameter);
  if (kind == ValueKind::kBoolean) return add_word(token.text, kind, parameter);
  if (kind != ValueKind::kString && kind != ValueKind::kNumberOrString)
    return mistake(fmt::format("the parameter {} must be a number, got the text {}",
                               in_quotes(parameter.name), in_quotes(token.text)));
  parameter.strings.push_back(token.value());
  parameter.written.emplace_back(token.text);
  return {};
}

bool is_value(const Token& token) {
  return token.is(Token::Kind::kWord) || token.is(Token::Kind::kString);
}

Status parse_values(TokenStream& tokens, ValueKind kind, Parameter& parameter) {
  auto token = tokens.next();
  if (!token) return fail(token.error());
  if (is_value(*token)) return add_value(*token, kind, parameter);
  if (!token->is(Token::Kind::kOpen))
    return mistake(fmt::format("the parameter {} has no value", in_quotes(parameter.name)));
  for (token = tokens.next(); token && is_value(*token); token = tokens.next())
    if (auto added = add_value(*token, kind, parameter); !added) return added;
  if (!token) return fail(token.error());
  if (!token->is(Token::Kind::kClose))
    return mistake(
        fmt::format("the values of the parameter {} have no closing bracket", in_quotes(parameter.name)));
  return {};
}

Result<Parameter> parse_parameter(TokenStream& tokens, const Token& declaration) {
  std::string_view words = declaration.text;
  const std::string_view type = next_word(words), name = next_word(words);
  if (name.empty() || !next_word(words).empty())
    return mistake(
        fmt::format("a parameter is declared as \"type name\", got {}", in_quotes(declaration.text)));
  const auto kind = kind_of(type);
  if (!kind)
    return mistake(fmt::format("the type {} of the parameter {} is not known{}", in_quotes(type),
                               in_quotes(name), suggestion(type, type_names())));
  Parameter parameter{std::string(type), std::string(name), tokens.place()};
  if (auto parsed = parse_values(tokens, *kind, parameter); !parsed) return fail(parsed.error());
  return parameter;
}

// "nan", "-nan(ind)", "NaN", "1.#QNAN"
bool is_written_nan(std::string_view text) {
  const std::size_t sign = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
  const std::string_view word = text.substr(sign, 3);
  return word == "1.#" || equal_ignoring_case(word, "nan");
}

}  // namespace

std::optional<float> parse_number(std::string_view text) {
  if (is_written_nan(text)) return std::numeric_limits<float>::quiet_NaN();
  if (text.starts_with('+')) text.remove_prefix(1);
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || text.empty()) return std::nullopt;
  constexpr float kMax = std::numeric_limits<float>::max();
  if (error == std::errc::result_out_of_range) {
    // Too large, or too close to 0.
    double wide = 0;
    const auto wide_result = std::from_chars(text.data(), text.data() + text.size(), wide);
    const bool is_tiny = wide_result.ec == std::errc() ? std::fabs(wide) < 1
                                                       : text.find_first_of("eE") + 1 == text.find('-', 1);
    if (is_tiny) return 0.0f;
    return text.starts_with('-') ? -kMax : kMax;
  }
  if (error != std::errc() || std::isnan(value)) return std::nullopt;
  return std::clamp(value, -kMax, kMax);
}

Place Parameters::place_of(const Parameter* parameter) const {
  const bool is_own = parameter != nullptr && !list_.empty() && parameter >= list_.data() &&
                      parameter < list_.data() + list_.size();
  return is_own ? parameter->place : place_;
}

const Parameter* Parameters::last(std::string_view name) const {
  const auto found =
      std::find_if(list_.rbegin(), list_.rend(), [&](const Parameter& p) { return p.name == name; });
  return found == list_.rend() ? nullptr : &*found;
}

const Parameter* Parameters::find(std::string_view name) const {
  const Parameter* found = last(name);
  if (found == nullptr) return defaults_ ? defaults_->find(name) : nullptr;
  found->is_used = true;
  if (found->is_used_anywhere) *found->is_used_anywhere = true;
  return found;
}

void Parameters::share_use() {
  for (Parameter& parameter : list_) parameter.is_used_anywhere = std::make_shared<bool>(false);
}

void Parameters::remark(std::string_view name, std::string_view kind, std::string text) const {
  const auto is_same = [&](const Remark& known) { return known.name == name && known.text == text; };
  if (std::any_of(remarks_.begin(), remarks_.end(), is_same)) return;
  remarks_.push_back({std::string(name), place_of(find(name)), std::string(kind), std::move(text)});
}

void Parameters::expect_multiple(const Parameter& parameter, std::size_t values, std::size_t of) const {
  if (values == 0)
    remark(parameter.name, "has no values of its kind; it is ignored");
  else if (values % of != 0)
    remark(parameter.name, fmt::format("does not have {} values each; the last ones are ignored", of));
}

std::optional<float> Parameters::number(std::string_view name) const {
  const Parameter* p = find(name);
  if (p == nullptr) return std::nullopt;
  if (p->size() > 1) remark(name, "has several values; the first one is used");
  if (!p->floats.empty() && !std::isnan(p->floats.front())) return p->floats.front();
  if (!p->integers.empty()) {
    remark(name, "is an integer, and a float is expected; it is used as one");
    return static_cast<float>(p->integers.front());
  }
  remark(name, "is no number; its default is used");
  return std::nullopt;
}

float Parameters::number_in(std::string_view name, float otherwise, float min, float max) const {
  const float value = number(name, otherwise), limited = std::clamp(value, min, max);
  if (limited != value)
    remark(name, "range",
           fmt::format("must be from {:g} to {:g}, got {:g}; {:g} is used", min, max, value, limited));
  return limited;
}

std::optional<float> Parameters::positive(std::string_view name) const {
  const auto value = number(name);
  if (!value || *value > 0) return value;
  remark(name, "positive", fmt::format("must be above 0, got {:g}; it is ignored", *value));
  return std::nullopt;
}

std::optional<int> Parameters::integer(std::string_view name) const {
  const Parameter* p = find(name);
  if (p == nullptr) return std::nullopt;
  if (p->size() > 1) remark(name, "has several values; the first one is used");
  if (!p->integers.empty()) return p->integers.front();
  if (!p->floats.empty() && std::fabs(p->floats.front()) < 2e9f) {
    const int whole = static_cast<int>(p->floats.front());
    if (static_cast<float>(whole) != p->floats.front())
      remark(name, "fraction",
             fmt::format("must be a whole number, got {:g}; {} is used", p->floats.front(), whole));
    return whole;
  }
  remark(name, "is no whole number; its default is used");
  return std::nullopt;
}

int Parameters::integer_in(std::string_view name, int otherwise, int min, int max) const {
  const int value = integer(name, otherwise), limited = std::clamp(value, min, max);
  if (limited != value)
    remark(name, "range", fmt::format("must be from {} to {}, got {}; {} is used", min, max, value, limited));
  return limited;
}

bool Parameters::boolean(std::string_view name, bool otherwise) const {
  const Parameter* p = find(name);
  if (p == nullptr) return otherwise;
  if (!p->booleans.empty()) return p->booleans.front();
  remark(name, "is neither true nor false; its default is used");
  return otherwise;
}

std::string Parameters::text(std::string_view name, std::string_view otherwise) const {
  const Parameter* p = find(name);
  if (p != nullptr && !p->strings.empty()) return p->strings.front();
  if (p != nullptr) remark(name, "is no text; its default is used");
  return std::string(otherwise);
}

std::string Parameters::file_name(std::string_view name) const {
  return text(name).empty() ? "" : find(name)->written.front();
}

std::string Parameters::choice(std::string_view name, std::string_view otherwise,
                               std::initializer_list<std::string_view> known) const {
  std::string given = text(name, otherwise);
  if (std::find(known.begin(), known.end(), given) != known.end()) return given;
  remark(name, "choice",
         fmt::format("is {}, which is not known; {} is used", in_quotes(given), in_quotes(otherwise)));
  return std::string(otherwise);
}

std::vector<std::string> Parameters::texts(std::string_view name) const {
  const Parameter* p = find(name);
  return p == nullptr ? std::vector<std::string>() : p->strings;
}

std::vector<float> Parameters::numbers(std::string_view name) const {
  const Parameter* p = find(name);
  if (p == nullptr) return {};
  if (p->floats.empty()) return {p->integers.begin(), p->integers.end()};
  return p->floats;
}

std::vector<float> Parameters::four_numbers(std::string_view name) const {
  std::vector<float> values = numbers(name);
  const bool are_numbers =
      std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
  if (values.size() == 4 && are_numbers) return values;
  if (find(name) != nullptr) remark(name, "is not four numbers; it is ignored");
  return {};
}

std::vector<std::int32_t> Parameters::integers(std::string_view name, std::size_t each) const {
  const Parameter* p = find(name);
  if (p == nullptr) return {};
  expect_multiple(*p, p->integers.size(), each);
  return p->integers;
}

std::optional<Vec3> Parameters::vector(std::string_view name) const {
  const std::vector<Vec3> all = vectors(name);
  return all.empty() ? std::nullopt : std::optional(all.front());
}

std::vector<Vec3> Parameters::vectors(std::string_view name) const {
  const Parameter* p = find(name);
  std::vector<Vec3> result;
  if (p == nullptr) return result;
  expect_multiple(*p, p->floats.size(), 3);
  result.reserve(p->floats.size() / 3);
  for (std::size_t i = 0; i + 3 <= p->floats.size(); i += 3)
    result.push_back({p->floats[i], p->floats[i + 1], p->floats[i + 2]});
  return result;
}

std::vector<Vec2> Parameters::points2(std::string_view name) const {
  const Parameter* p = find(name);
  std::vector<Vec2> result;
  if (p == nullptr) return result;
  expect_multiple(*p, p->floats.size(), 2);
  result.reserve(p->floats.size() / 2);
  for (std::size_t i = 0; i + 2 <= p->floats.size(); i += 2)
    result.push_back({p->floats[i], p->floats[i + 1]});
  return result;
}

std::vector<const Parameter*> Parameters::unused() const {
  std::vector<const Parameter*> result;
  for (const Parameter& parameter : list_)
    if (!parameter.is_used) result.push_back(&parameter);
  return result;
}

Result<Parameters> parse_parameters(TokenStream& tokens, Place place, const std::string& color_space) {
  Parameters parameters(std::move(place));
  while (true) {
    const auto token = tokens.peek();
    if (!token) return fail(token.error());
    if (!token->is(Token::Kind::kString)) return parameters;
    if (auto taken = tokens.next(); !taken) return fail(taken.error());
    auto parameter = parse_parameter(tokens, *token);
    if (!parameter) return fail(parameter.error());
    parameter->color_space = color_space;
    parameters.add(std::move(*parameter));
  }
}

}  // namespace tessera::core::pbrt
