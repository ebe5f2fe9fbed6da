// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

std::string with_article(std::string_view noun) {
  const bool vowel = std::string_view("aeiou").find(noun.front()) != std::string_view::npos;
  return fmt::format("{} {}", vowel ? "an" : "a", noun);
}

constexpr double kLargestFloat = std::numeric_limits<float>::max();

// The `count` numbers of a list; nullopt after a mistake.
template <std::size_t count>
std::optional<std::array<float, count>> field_numbers(const Field& field, const Range& range) {
  const auto* items = field.value().get_if<JsonValue::Array>();
  if (items == nullptr || items->size() != count) {
    field.must_be(fmt::format("a list of {} numbers", count));
    return std::nullopt;
  }
  std::array<float, count> numbers{};
  for (std::size_t i = 0; i < count; ++i) numbers[i] = read_float(field.element(i), range);
  return numbers;
}

}  // namespace

void Field::must_be(std::string_view expected) const {
  mistake(fmt::format("must be {}, got {}", expected, value_->describe()));
}

Field Field::element(std::size_t index) const {
  return {(*value_->get_if<JsonValue::Array>())[index], fmt::format("{}[{}]", path_, index), *mistakes_};
}

Field Field::member(const JsonValue::Member& member) const {
  // Keys may contain any bytes; in_quotes() escapes them for messages.
  const std::string shown = in_quotes(member.key);
  const std::string name = shown == "'" + member.key + "'" ? member.key : shown;
  return {member.value, path_.empty() ? name : path_ + "." + name, *mistakes_};
}

ObjectReader::ObjectReader(const Field& field, const ObjectRules& rules) : field_(field) {
  const auto* members = field.value().get_if<JsonValue::Object>();
  if (members == nullptr) {
    field.must_be("an object in braces");
    return;
  }
  std::vector<std::string_view> known;
  for (const auto& rule : rules.keys) known.push_back(rule.name);
  for (const auto& member : *members)
    if (std::find(known.begin(), known.end(), member.key) == known.end())
      field.mistakes().add(
          {member.key_line, field.path()},
          fmt::format("unknown key {}{}", in_quotes(member.key), suggestion(member.key, known)));
  for (const auto& rule : rules.keys)
    if (rule.required && !find(rule.name))
      field.mistake(fmt::format("{} needs the key '{}'", with_article(rules.kind), rule.name));
}

std::optional<Field> ObjectReader::find(std::string_view key) const {
  return find_member_field(field_, key);
}

std::string unquoted_number(const Range& range) {
  constexpr std::string_view kNumber = "a number";
  const std::string phrase = phrase_of(range);
  std::string_view limits = phrase;
  if (limits.starts_with(kNumber)) limits.remove_prefix(std::min(kNumber.size() + 1, limits.size()));
  return fmt::format("a number without quotes{}{}", limits.empty() ? "" : ", ", limits);
}

float read_float(const Field& field, const Range& range) {
  const auto* number = field.value().get_if<JsonValue::Number>();
  if (number == nullptr) {
    field.must_be(field.value().get_if<std::string>() ? unquoted_number(range) : phrase_of(range));
    return 1;
  }
  // Ranges are checked before and after rounding to float: 1e-50 is greater than 0, but its float is not.
  const auto rounded = static_cast<float>(std::clamp(number->value, -kLargestFloat, kLargestFloat));
  if (std::fabs(number->value) > kLargestFloat) {
    field.must_be("between -3.4e38 and 3.4e38");
  } else if (!range.contains(number->value) || !range.contains(double{rounded})) {
    field.must_be(phrase_of(range));
  }
  return rounded;
}

std::uint64_t read_whole_number(const Field& field, std::uint64_t min, std::uint64_t max) {
  const auto* number = field.value().get_if<JsonValue::Number>();
  if (number != nullptr && number->whole && *number->whole >= min && *number->whole <= max)
    return *number->whole;
  field.must_be(fmt::format("a whole number between {} and {}", min, max));
  return min;
}

std::string read_text(const Field& field) {
  const auto* text = field.value().get_if<std::string>();
  if (text != nullptr && !text->empty()) return *text;
  field.must_be("a text in double quotes");
  return {};
}

std::size_t read_choice(const Field& field, std::span<const std::string_view> words) {
  const auto* text = field.value().get_if<std::string>();
  const std::vector<std::string_view> known(words.begin(), words.end());
  if (text == nullptr) {
    field.must_be(fmt::format("one of \"{}\"", fmt::join(known, "\", \"")));
    return 0;
  }
  const auto found = std::find(known.begin(), known.end(), *text);
  if (found != known.end()) return static_cast<std::size_t>(found - known.begin());
  field.mistake(fmt::format("unknown value {}{}", in_quotes(*text), suggestion(*text, known)));
  return 0;
}

bool read_bool(const Field& field) {
  if (const auto* value = field.value().get_if<bool>()) return *value;
  field.must_be("true or false");
  return false;
}

Vec2 read_vec2(const Field& field, const Range& range) {
  const auto numbers = field_numbers<2>(field, range);
  return numbers ? Vec2{(*numbers)[0], (*numbers)[1]} : Vec2{1, 1};
}

Vec3 read_vec3(const Field& field, const Range& range) {
  const auto numbers = field_numbers<3>(field, range);
  return numbers ? Vec3{(*numbers)[0], (*numbers)[1], (*numbers)[2]} : Vec3{1, 1, 1};
}

Rgb read_color(const Field& field, const Range& range) {
  if (field.value().get_if<JsonValue::Number>()) return Rgb::gray(read_float(field, range));
  if (!field.value().get_if<JsonValue::Array>()) {
    field.must_be("a number or a list of 3 numbers");
    return {};
  }
  const Vec3 numbers = read_vec3(field, range);
  return {numbers.x, numbers.y, numbers.z};
}

std::optional<Field> find_member_field(const Field& field, std::string_view key) {
  const auto* members = field.value().get_if<JsonValue::Object>();
  if (members == nullptr) return std::nullopt;
  const auto found =
      std::find_if(members->begin(), members->end(), [&](const auto& m) { return m.key == key; });
  return found == members->end() ? std::nullopt : std::optional(field.member(*found));
}

std::optional<std::size_t> read_type(const Field& field, std::span<const std::string_view> types,
                                     std::string_view kind) {
  if (!field.value().get_if<JsonValue::Object>()) {
    field.must_be("an object in braces");
    return std::nullopt;
  }
  const auto type = find_member_field(field, "type");
  if (!type) {
    field.mistake(fmt::format("{} needs the key 'type', one of \"{}\"", with_article(kind),
                              fmt::join(types, "\", \"")));
    return std::nullopt;
  }
  const std::size_t mistakes_before = field.mistakes().count();
  const std::size_t index = read_choice(*type, types);
  return field.mistakes().count() == mistakes_before ? std::optional(index) : std::nullopt;
}

bool has_keyframes(const Field& field) {
  return find_member_field(field, "keyframes").has_value();
}

std::vector<KeyframeField> read_keyframes(const Field& field) {
  const ObjectReader animated(field, scene_keys::kAnimated);
  const auto list = animated.find("keyframes");
  const auto* items = list ? list->value().get_if<JsonValue::Array>() : nullptr;
  if (items == nullptr || items->empty()) {
    if (list) list->must_be("a list of at least one keyframe such as {\"frame\": 1, \"value\": 0}");
    return {};
  }
  std::vector<KeyframeField> keyframes;
  for (std::size_t i = 0; i < items->size(); ++i) {
    const Field entry = list->element(i);
    const ObjectReader keyframe(entry, scene_keys::kKeyframe);
    const auto frame = keyframe.find("frame"), value = keyframe.find("value");
    if (!frame || !value) continue;
    const float number = read_float(*frame, ranges::kFrame);
    if (!keyframes.empty() && !(number > keyframes.back().frame)) {
      frame->mistake(fmt::format("keyframes must be in the order of their frames: {} follows {}", number,
                                 keyframes.back().frame));
      continue;
    }
    keyframes.push_back({number, *value});
  }
  return keyframes;
}

std::vector<std::pair<std::string, Field>> read_named(const Field& field) {
  const auto* members = field.value().get_if<JsonValue::Object>();
  if (members == nullptr) {
    field.must_be("an object in braces, from names to what they stand for");
    return {};
  }
  std::vector<std::pair<std::string, Field>> named;
  for (const auto& member : *members) {
    if (member.key.empty()) field.mistakes().add({member.key_line, field.path()}, "a name must not be empty");
    named.emplace_back(member.key, field.member(member));
  }
  return named;
}

}  // namespace tessera::core
