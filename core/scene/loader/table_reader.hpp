// SPDX-License-Identifier: Apache-2.0
// Reads objects of a scene file by their tables of keys. Not thread-safe.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/scene/loader/field.hpp"
#include "core/scene/loader/scene_file.hpp"
#include "core/scene/tables/domains.hpp"

namespace tessera::core {

// What names refer to; null where a kind of names cannot occur.
struct KnownNames {
  const std::vector<TextureEntry>* textures = nullptr;
  const std::vector<MediumDescription>* media = nullptr;
  const std::vector<GridEntry>* grids = nullptr;
};

// The keys of tables.
template <typename... Tables>
std::vector<KeyRule> rules_of(const Tables&... tables) {
  std::vector<KeyRule> rules;
  const auto add = [&]<typename Entry>(const Entry& entry) {
    if constexpr (Named<Entry>) rules.push_back({entry.name, entry.traits.required});
  };
  (for_each(tables, add), ...);
  return rules;
}

// Of objects whose type decides their keys.
inline constexpr Table kTypeKey{OtherKey{"type", domains::kTruth, "", {.required = true}}};

// The alternative of this index, with its defaults.
template <typename Variant>
Variant alternative(std::size_t index) {
  Variant variant;
  [&]<std::size_t... each>(std::index_sequence<each...>) {
    ((index == each ? void(variant.template emplace<each>()) : void()), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>());
  return variant;
}

// The index of the name, which may also stand for a number from the domain's range; -1 after a mistake.
int read_index(const Field& field, const Domain& domain, const KnownNames& names);
// A text that the domain accepts; empty after a mistake.
std::string read_name(const Field& field, const Domain& domain);
// A number or [r, g, b].
Rgb read_plain_color(const Field& field, const Domain& domain);
// A number, [r, g, b], or {"texture": NAME, "tint": ...}; keyframes of the factor go to `track`.
ColorParameter read_parameter(const Field& field, const Domain& domain, const KnownNames& names,
                              Track<Rgb>& track);
// A number, or {"texture": NAME, "scale": ...}, which uses the red channel.
ScalarParameter read_parameter(const Field& field, const Domain& domain, const KnownNames& names,
                               Track<float>& track);

template <typename T>
inline constexpr bool kIsOptional = false;
template <typename T>
inline constexpr bool kIsOptional<std::optional<T>> = true;

// A value without keyframes.
template <typename Value>
Value read_still(const Field& field, const Domain& domain, const KnownNames& names) {
  if constexpr (std::same_as<Value, bool>) {
    return domain.words.empty() ? read_bool(field) : read_choice(field, domain.words) == 0;
  } else if constexpr (std::same_as<Value, int>) {
    return read_index(field, domain, names);
  } else if constexpr (std::same_as<Value, float>) {
    return read_float(field, domain.range);
  } else if constexpr (std::same_as<Value, std::string>) {
    return read_name(field, domain);
  } else if constexpr (std::same_as<Value, Vec2>) {
    return read_vec2(field, domain.range);
  } else if constexpr (std::same_as<Value, Vec3>) {
    return read_vec3(field, domain.range);
  } else if constexpr (std::same_as<Value, Rgb>) {
    return read_plain_color(field, domain);
  } else if constexpr (kIsOptional<Value>) {
    return read_still<typename Value::value_type>(field, domain, names);
  } else {
    static_assert(std::is_enum_v<Value>, "values of this type need a reader");
    return static_cast<Value>(read_choice(field, domain.words));
  }
}

// Where the keyframes of a key go: by its name, or to its own track.
template <typename KeyType, typename Value>
requires std::same_as<Value, float> || std::same_as<Value, Rgb>
void add_track(ParameterTracks& tracks, const KeyType& key, Track<Value> track) {
  tracks.add(key.name, std::move(track));
}
template <typename Owner, typename Value, typename Tracks>
void add_track(Tracks& tracks, const TrackedKey<Owner, Value, Tracks>& key, Track<Value> track) {
  tracks.*key.track = std::move(track);
}

class TableReader {
 public:
  // Reports keys that are unknown and those that are missing.
  TableReader(const Field& field, std::string_view kind, const std::vector<KeyRule>& rules,
              const KnownNames& names)
      : field_(field), object_(field, {kind, {}, rules}), names_(names) {}

  const Field& field() const { return field_; }
  std::optional<Field> find(std::string_view key) const { return object_.find(key); }

  // Sets the members of `owner` whose keys are given, and adds their keyframes to `tracks`.
  template <typename Owner, typename Tracks, typename... Entries>
  void read(const Table<Entries...>& table, Owner& owner, Tracks& tracks) const {
    visit_members(table, owner, [&](const auto& key, auto& value) {
      if (const auto field = find(key.name)) read_member(*field, key, value, tracks);
    });
  }

 private:
  template <typename KeyType, typename Value, typename Tracks>
  void read_member(const Field& field, const KeyType& key, Value& value, Tracks& tracks) const {
    if constexpr (HasTable<Value>) {
      read_object(field, key, value, tracks);
    } else if constexpr (std::same_as<Value, ColorParameter> || std::same_as<Value, ScalarParameter>) {
      Track<decltype(value.value)> track;
      value = read_parameter(field, key.domain, names_, track);
      add_track(tracks, key, std::move(track));
    } else if (!key.traits.has_keyframes) {
      value = read_still<Value>(field, key.domain, names_);
    } else if constexpr (requires(Track<Value> track) { add_track(tracks, key, track); }) {
      Track<Value> track;
      value = read_animated(field, track, read_still<Value>, key.domain, names_);
      add_track(tracks, key, std::move(track));
    }
  }

  // An object with a table of its own; its keyframes are those of its key.
  template <typename KeyType, typename Value, typename Tracks>
  void read_object(const Field& field, const KeyType& key, Value& value, Tracks& tracks) const {
    if (!key.domain.instead_of_text.empty() && field.value().get_if<std::string>())
      return field.must_be(key.domain.instead_of_text);
    ParameterTracks own;
    TableReader(field, key.domain.kind, rules_of(kKeys<Value>), names_).read(kKeys<Value>, value, own);
    if constexpr (std::same_as<Tracks, ParameterTracks>)
      for (KeyedTrack<float>& each : own.numbers) add_track(tracks, key, std::move(each.track));
  }

  Field field_;
  ObjectReader object_;
  KnownNames names_;
};

}  // namespace tessera::core
