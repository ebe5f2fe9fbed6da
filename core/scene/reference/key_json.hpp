// SPDX-License-Identifier: Apache-2.0
// Values as JSON documents have them. Stateless; thread-safe.
#pragma once

#include <fmt/format.h>

#include <concepts>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>

#include "core/scene/description.hpp"
#include "core/scene/tables/table.hpp"

namespace tessera::core {

using OrderedJson = nlohmann::ordered_json;

// The shortest decimal that reads as the float.
inline OrderedJson number_json(float value) {
  return OrderedJson::parse(fmt::format("{}", value));
}

// A value as scene files write it; null if it has no text of its own.
template <typename Value>
OrderedJson value_json(const Value& value, const Domain& domain) {
  if constexpr (std::same_as<Value, bool>) {
    return domain.words.empty() ? OrderedJson(value) : OrderedJson(domain.words[value ? 0 : 1]);
  } else if constexpr (std::same_as<Value, int>) {
    return domain.names == NamesOf::kNothing ? OrderedJson(value) : OrderedJson();
  } else if constexpr (std::same_as<Value, float>) {
    return number_json(value);
  } else if constexpr (std::same_as<Value, Vec2>) {
    return {number_json(value.x), number_json(value.y)};
  } else if constexpr (std::same_as<Value, Vec3>) {
    return {number_json(value.x), number_json(value.y), number_json(value.z)};
  } else if constexpr (std::same_as<Value, Rgb>) {
    return number_json(value.r);  // defaults are gray
  } else if constexpr (std::same_as<Value, ColorParameter> || std::same_as<Value, ScalarParameter>) {
    return value_json(value.value, domain);
  } else if constexpr (std::is_enum_v<Value>) {
    return OrderedJson(domain.words[static_cast<std::size_t>(value)]);
  } else {
    return {};
  }
}

// The default of a key; null if it has none.
template <typename Owner, typename Entry>
OrderedJson default_json(const Entry& entry) {
  if constexpr (MemberOf<Entry, Owner>)
    if (!entry.traits.required && entry.traits.otherwise.empty())
      return value_json(entry.of(Owner{}), entry.domain);
  return {};
}

}  // namespace tessera::core
