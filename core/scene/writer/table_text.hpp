// SPDX-License-Identifier: Apache-2.0
// Writes members by their tables of keys, as scene files give them. Values that are the default are left out.
// Not thread-safe.
#pragma once

#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/scene/description.hpp"
#include "core/scene/tables/table.hpp"
#include "core/scene/writer/json_text.hpp"
#include "core/scene/writer/motion_text.hpp"

namespace tessera::core {

// The names by which parts of a scene refer to others; each is unique among its kind.
struct SceneNames {
  std::vector<std::string> textures, media, grids, materials, objects;
};

// The text of a value; empty if there is none to write.
std::string value_text(bool value, const Domain& domain, const SceneNames& names);
std::string value_text(int value, const Domain& domain, const SceneNames& names);
std::string value_text(float value, const Domain& domain, const SceneNames& names);
std::string value_text(Vec2 value, const Domain& domain, const SceneNames& names);
std::string value_text(Vec3 value, const Domain& domain, const SceneNames& names);
std::string value_text(Rgb value, const Domain& domain, const SceneNames& names);
std::string value_text(const std::string& value, const Domain& domain, const SceneNames& names);
template <typename Enum>
requires std::is_enum_v<Enum> std::string value_text(Enum value, const Domain& domain, const SceneNames&) {
  return json_text::text(domain.words[static_cast<std::size_t>(value)]);
}
template <typename T>
std::string value_text(const std::optional<T>& value, const Domain& domain, const SceneNames& names) {
  return value ? value_text(*value, domain, names) : std::string();
}

// An object of a texture and its factor; the factor alone if there is none.
std::string parameter_text(const ColorParameter& parameter, const SceneNames& names, const Track<Rgb>& track);
std::string parameter_text(const ScalarParameter& parameter, const SceneNames& names,
                           const Track<float>& track);

// The keyframes of a key, as the reader stores them.
template <std::same_as<float> Value, typename KeyType>
const Track<float>& track_of(const ParameterTracks& tracks, const KeyType& key) {
  return number_track(tracks, key.name);
}
template <std::same_as<Rgb> Value, typename KeyType>
const Track<Rgb>& track_of(const ParameterTracks& tracks, const KeyType& key) {
  return color_track(tracks, key.name);
}
template <typename Value, typename Owner, typename Tracks>
const Track<Value>& track_of(const Tracks& tracks, const TrackedKey<Owner, Value, Tracks>& key) {
  return tracks.*key.track;
}

class TableWriter {
 public:
  TableWriter(const SceneNames& names, json_text::Object& object) : names_(names), object_(object) {}

  // Adds the keys of the table that must be written, or whose values are not the defaults of an Owner. Those
  // for which is_written(key) does not hold are left out.
  template <typename Owner, typename Tracks, typename IsWritten, typename... Entries>
  void write(const Table<Entries...>& table, const Owner& owner, const Tracks& tracks,
             const IsWritten& is_written) {
    visit_members(table, owner, [&](const auto& key, const auto& value) {
      if (!is_written(key.name)) return;
      const std::string text = text_of(key, value, tracks);
      const bool has_default = !key.traits.required && key.traits.otherwise.empty();
      const std::string otherwise = has_default ? text_of(key, key.of(Owner{}), Tracks()) : "";
      object_.add_unless(otherwise, key.name, text);
    });
  }
  template <typename Owner, typename Tracks, typename... Entries>
  void write(const Table<Entries...>& table, const Owner& owner, const Tracks& tracks) {
    write(table, owner, tracks, [](std::string_view) { return true; });
  }

 private:
  template <typename KeyType, typename Value, typename Tracks>
  std::string text_of(const KeyType& key, const Value& value, const Tracks& tracks) const {
    if constexpr (HasTable<Value>) {
      return object_text(key, value, tracks);
    } else if constexpr (std::same_as<Value, ColorParameter> || std::same_as<Value, ScalarParameter>) {
      return parameter_text(value, names_, track_of<std::remove_const_t<decltype(value.value)>>(tracks, key));
    } else if constexpr (requires { track_of<Value>(tracks, key); }) {
      const auto text = [&](const Value& each) { return value_text(each, key.domain, names_); };
      return key.traits.has_keyframes ? animated_text(value, track_of<Value>(tracks, key), text)
                                      : text(value);
    } else {
      return value_text(value, key.domain, names_);
    }
  }

  // An object with a texture, and the keyframes of its key; nothing without texture.
  template <typename KeyType, typename Value, typename Tracks>
  std::string object_text(const KeyType& key, const Value& value, const Tracks& tracks) const {
    if (value.texture < 0) return {};
    json_text::Object object;
    ParameterTracks own;
    if constexpr (std::same_as<Tracks, ParameterTracks>)
      visit_members(kKeys<Value>, value, [&]<typename Member>(const auto& member, const Member&) {
        if constexpr (std::same_as<Member, float>) own.add(member.name, number_track(tracks, key.name));
      });
    TableWriter(names_, object).write(kKeys<Value>, value, own);
    return object.on_one_line();
  }

  const SceneNames& names_;
  json_text::Object& object_;
};

}  // namespace tessera::core
