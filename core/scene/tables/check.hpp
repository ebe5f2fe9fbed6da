// SPDX-License-Identifier: Apache-2.0
// Checks descriptions against their tables, wherever they come from. Stateless; thread-safe.
#pragma once

#include <concepts>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "core/scene/description.hpp"
#include "core/scene/tables/table.hpp"

namespace tessera::core {

// How many there are of what members refer to by index.
struct NameCounts {
  std::size_t textures = 0, media = 0, grids = 0;
};
inline constexpr std::size_t kUnknownCount = std::numeric_limits<int>::max();

// A value that its key does not accept.
struct KeyMistake {
  std::string_view key;
  std::string what;  // "must be between 0 and 1, got 2", or "there is no such texture"

  // "roughness must be between 0 and 1, got 2", or "albedo: there is no such texture".
  std::string text() const;
};

// Why a value is not accepted; empty if it is. The factors of textures are only to be finite and not
// negative: their products are clamped where they are evaluated.
std::string why_refused(float value, const Domain& domain, const NameCounts& counts);
std::string why_refused(int value, const Domain& domain, const NameCounts& counts);
std::string why_refused(Vec2 value, const Domain& domain, const NameCounts& counts);
std::string why_refused(Vec3 value, const Domain& domain, const NameCounts& counts);
std::string why_refused(Rgb value, const Domain& domain, const NameCounts& counts);
std::string why_refused(const std::string& value, const Domain& domain, const NameCounts& counts);
std::string why_refused(const ColorParameter& value, const Domain& domain, const NameCounts& counts);
std::string why_refused(const ScalarParameter& value, const Domain& domain, const NameCounts& counts);

// The first mistake among the members of `owner` that the table names. A number that is the default is
// accepted where that stands for something else.
template <typename Owner, typename... Entries>
std::optional<KeyMistake> find_mistake(const Table<Entries...>& table, const Owner& owner,
                                       const NameCounts& counts) {
  std::optional<KeyMistake> mistake;
  visit_members(table, owner, [&]<typename KeyType, typename Value>(const KeyType& key, const Value& value) {
    if (mistake) return;
    if constexpr (HasTable<Value>) {
      mistake = find_mistake(kKeys<Value>, value, counts);
    } else if constexpr (!std::same_as<Value, bool> && requires { why_refused(value, key.domain, counts); }) {
      if constexpr (std::same_as<Value, float>)
        if (!key.traits.otherwise.empty() && value == key.of(Owner{})) return;
      if (std::string why = why_refused(value, key.domain, counts); !why.empty())
        mistake = KeyMistake{key.name, std::move(why)};
    }
  });
  return mistake;
}

}  // namespace tessera::core
