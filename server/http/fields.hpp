// SPDX-License-Identifier: Apache-2.0
// The fields of a JSON object, each of which must be known and have its type.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include "core/base/error.hpp"
#include "proto/text.hpp"
#include "server/http/answers.hpp"

namespace tessera::http_api {

// Takes the value of a field.
using TakeField = std::function<core::Status(const std::string& field, const Json& value)>;

// Fields that are null count as absent. `within`: what the object is in, for messages.
inline core::Status read_fields(const Json& object, const std::string& within,
                                std::initializer_list<std::pair<const char*, TakeField>> known) {
  if (!object.is_object()) return core::fail(proto::invalid_field(within, "must be an object"));
  for (const auto& [name, value] : object.items()) {
    const std::string field = within.empty() ? name : within + "." + name;
    const TakeField* take = nullptr;
    for (const auto& [known_name, known_take] : known)
      if (name == known_name) take = &known_take;
    if (take == nullptr) return core::fail(proto::invalid_field(field, "is unknown"));
    if (value.is_null()) continue;
    if (auto taken = (*take)(field, value); !taken) return taken;
  }
  return {};
}

// Fields of one type, whose value is passed to `set`.
template <typename Set>
TakeField text(Set set) {
  return [set](const std::string& field, const Json& value) -> core::Status {
    if (!value.is_string()) return core::fail(proto::invalid_field(field, "must be a string"));
    set(value.get<std::string>());
    return {};
  };
}

template <typename Integer, typename Set>
TakeField integer(Set set) {
  return [set](const std::string& field, const Json& value) -> core::Status {
    using Limits = std::numeric_limits<Integer>;
    const bool fits = value.is_number_unsigned()
                          ? value.get<std::uint64_t>() <= static_cast<std::uint64_t>(Limits::max())
                          : value.is_number_integer() && std::is_signed_v<Integer> &&
                                value.get<std::int64_t>() >= static_cast<std::int64_t>(Limits::min());
    if (!fits)
      return core::fail(proto::invalid_field(field, "must be an integer from " +
                                                        std::to_string(Limits::min()) + " to " +
                                                        std::to_string(Limits::max())));
    set(value.get<Integer>());
    return {};
  };
}

template <typename Set>
TakeField number(Set set) {
  return [set](const std::string& field, const Json& value) -> core::Status {
    if (!value.is_number()) return core::fail(proto::invalid_field(field, "must be a number"));
    set(value.get<float>());
    return {};
  };
}

template <typename Set>
TakeField boolean(Set set) {
  return [set](const std::string& field, const Json& value) -> core::Status {
    if (!value.is_boolean()) return core::fail(proto::invalid_field(field, "must be true or false"));
    set(value.get<bool>());
    return {};
  };
}

}  // namespace tessera::http_api
