// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/printable.hpp"
#include "core/scene/gltf/document.hpp"

namespace tessera::core::gltf {
namespace {

std::string member_path(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

}  // namespace

void Value::refuse(std::string_view what, ErrorCode code) const {
  const std::string message = path_.empty() ? std::string(what) : fmt::format("{}: {}", path_, what);
  throw Refusal{line(), {code, printable_lines(message)}, false};
}

Value Value::operator[](std::string_view key) const {
  const auto* members = json_ == nullptr ? nullptr : json_->get_if<JsonValue::Object>();
  if (members == nullptr) return {nullptr, member_path(path_, key), document_};
  const auto found = std::find_if(members->begin(), members->end(),
                                  [&](const JsonValue::Member& member) { return member.key == key; });
  if (found != members->end()) found->value.is_used = true;
  const bool is_absent = found == members->end() || found->value.get_if<JsonValue::Null>() != nullptr;
  return {is_absent ? nullptr : &found->value, member_path(path_, key), document_};
}

std::size_t Value::size() const {
  const auto* list = json_ == nullptr ? nullptr : json_->get_if<JsonValue::Array>();
  return list == nullptr ? 0 : list->size();
}

Value Value::at(std::size_t i) const {
  const JsonValue& element = (*json_->get_if<JsonValue::Array>())[i];
  element.is_used = true;
  return {&element, fmt::format("{}[{}]", path_, i), document_};
}

Value Value::at_path(std::string_view path) const {
  if (path_ == path) return *this;
  const auto leads_on = [&](std::string_view step) {
    return path.starts_with(step) &&
           (path.size() == step.size() || path[step.size()] == '.' || path[step.size()] == '[');
  };
  const auto* members = json_ == nullptr ? nullptr : json_->get_if<JsonValue::Object>();
  for (std::size_t i = 0; members != nullptr && i < members->size(); ++i)
    if (std::string step = member_path(path_, (*members)[i].key); leads_on(step))
      return Value(&(*members)[i].value, std::move(step), document_).at_path(path);
  const auto* list = json_ == nullptr ? nullptr : json_->get_if<JsonValue::Array>();
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i)
    if (std::string step = fmt::format("{}[{}]", path_, i); leads_on(step))
      return Value(&(*list)[i], std::move(step), document_).at_path(path);
  return {nullptr, std::string(path), document_};
}

std::vector<std::string_view> Value::used_keys() const {
  std::vector<std::string_view> keys;
  const auto* members = json_ == nullptr ? nullptr : json_->get_if<JsonValue::Object>();
  for (std::size_t i = 0; members != nullptr && i < members->size(); ++i)
    if ((*members)[i].value.is_used) keys.push_back((*members)[i].key);
  return keys;
}

std::vector<std::string> Value::keys() const {
  constexpr std::size_t kMaxKeys = 1000;
  std::vector<std::string> keys;
  const auto* members = json_ == nullptr ? nullptr : json_->get_if<JsonValue::Object>();
  if (members == nullptr) return keys;
  if (members->size() > kMaxKeys) refuse(fmt::format("has more than {} keys", kMaxKeys));
  for (const auto& member : *members) keys.push_back(member.key);
  return keys;
}

float Value::number() const {
  if (!exists()) refuse("is missing");
  const auto* number = json_->get_if<JsonValue::Number>();
  if (number == nullptr) refuse(fmt::format("must be a number, got {}", json_->describe()));
  if (!(std::fabs(number->value) <= static_cast<double>(std::numeric_limits<float>::max())))
    refuse("is too large");
  return static_cast<float>(number->value);
}

std::uint64_t Value::whole() const {
  if (!exists()) refuse("is missing");
  const auto* number = json_->get_if<JsonValue::Number>();
  if (number == nullptr || !number->whole)
    refuse(fmt::format("must be a whole number from 0, got {}", json_->describe()));
  return *number->whole;
}

std::optional<std::uint64_t> Value::as_whole() const {
  const auto* number = json_ == nullptr ? nullptr : json_->get_if<JsonValue::Number>();
  return number != nullptr && number->whole ? std::optional<std::uint64_t>(*number->whole) : std::nullopt;
}

std::uint64_t Value::whole_or(std::string_view key, std::uint64_t otherwise) const {
  const Value member = (*this)[key];
  return member.exists() ? member.whole() : otherwise;
}

template <typename T, typename Get>
T Value::value_or(T otherwise, const Get& get) const {
  const std::string key = path_.substr(path_.rfind('.') + 1);
  document_->try_to(*this, key.substr(0, key.find('[')), "it is ignored", [&] { otherwise = get(*this); });
  return otherwise;
}

template <typename T, typename Get>
T Value::member_or(std::string_view key, T otherwise, const Get& get) const {
  const Value member = (*this)[key];
  return member.exists() ? member.value_or(std::move(otherwise), get) : otherwise;
}

float Value::number_or(std::string_view key, float otherwise) const {
  return member_or(key, otherwise, [](const Value& member) { return member.number(); });
}

bool Value::is_true(std::string_view key, bool otherwise) const {
  return member_or(key, otherwise, [](const Value& member) {
    const bool* truth = member.json_->get_if<bool>();
    if (truth == nullptr)
      member.refuse(fmt::format("must be true or false, got {}", member.json_->describe()));
    return *truth;
  });
}

Rgb Value::color_or(std::string_view key, Rgb otherwise) const {
  const auto values = numbers(key, 3);
  return values.empty() ? otherwise : Rgb{values[0], values[1], values[2]};
}

Vec3 Value::vector_or(std::string_view key, Vec3 otherwise) const {
  const auto values = numbers(key, 3);
  return values.empty() ? otherwise : Vec3{values[0], values[1], values[2]};
}

std::vector<float> Value::numbers(std::string_view key, std::size_t count) const {
  return member_or(key, std::vector<float>(), [count](const Value& member) {
    if (member.size() != count)
      member.refuse(fmt::format("must be a list of {} numbers, got {}", count, member.json_->describe()));
    std::vector<float> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(member.at(i).number());
    return values;
  });
}

std::vector<float> Value::numbers(std::string_view key) const {
  const Value list = (*this)[key];
  std::vector<float> values;
  for (std::size_t i = 0; i < list.size(); ++i)
    values.push_back(list.at(i).value_or(0.0f, [](const Value& element) { return element.number(); }));
  return values;
}

std::string Value::text(std::string_view key) const {
  const Value member = (*this)[key];
  const auto* text = member.exists() ? member.json_->get_if<std::string>() : nullptr;
  return text == nullptr ? std::string() : *text;
}

}  // namespace tessera::core::gltf
