// SPDX-License-Identifier: Apache-2.0
// Reads typed values from a located JSON tree. Every reader reports errors to Mistakes and then returns a
// valid placeholder, so that reading continues and finds further mistakes. Not thread-safe.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/geometry/primitives.hpp"
#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"
#include "core/scene/animation.hpp"
#include "core/scene/loader/json_document.hpp"
#include "core/scene/loader/mistakes.hpp"
#include "core/scene/loader/scene_keys.hpp"
#include "core/scene/tables/range.hpp"

namespace tessera::core {

// A value with its location in the file. Refers to the tree and the Mistakes, which must outlive it.
class Field {
 public:
  Field(const JsonValue& value, std::string path, Mistakes& mistakes)
      : value_(&value), path_(std::move(path)), mistakes_(&mistakes) {}

  const JsonValue& value() const { return *value_; }
  const std::string& path() const { return path_; }
  Place place() const { return {value_->line, path_}; }
  Mistakes& mistakes() const { return *mistakes_; }

  void mistake(std::string_view what) const { mistakes_->add(place(), what); }
  // "must be EXPECTED, got 3".
  void must_be(std::string_view expected) const;

  // The field for an element or member `value`.
  Field element(std::size_t index) const;
  Field member(const JsonValue::Member& member) const;

 private:
  const JsonValue* value_;
  std::string path_;
  Mistakes* mistakes_;
};

// An object with known keys. The constructor reports unknown and missing keys.
class ObjectReader {
 public:
  ObjectReader(const Field& field, const ObjectRules& rules);

  std::optional<Field> find(std::string_view key) const;

 private:
  Field field_;
};

// Numbers that do not fit a float are always rejected.

// "a number without quotes, between 0 and 1": the message for a string in place of a number.
std::string unquoted_number(const Range& range);
float read_float(const Field& field, const Range& range);
std::uint64_t read_whole_number(const Field& field, std::uint64_t min, std::uint64_t max);
std::string read_text(const Field& field);  // not empty
bool read_bool(const Field& field);
// The index of the word among `words`.
std::size_t read_choice(const Field& field, std::span<const std::string_view> words);
Vec2 read_vec2(const Field& field, const Range& range);
Vec3 read_vec3(const Field& field, const Range& range);
// A single number for gray, or [r, g, b].
Rgb read_color(const Field& field, const Range& range);

// The member of an object, or nullopt.
std::optional<Field> find_member_field(const Field& field, std::string_view key);
// The index in `types` of the object's "type"; nullopt after a mistake. `kind` is as in "a shape needs the
// key 'type'".
std::optional<std::size_t> read_type(const Field& field, std::span<const std::string_view> types,
                                     std::string_view kind);

// The members of an object whose keys are user-defined names; empty names are mistakes.
std::vector<std::pair<std::string, Field>> read_named(const Field& field);

// A keyframe of a value that is written as {"keyframes": [{"frame": 1, "value": ...}, ...]}.
struct KeyframeField {
  float frame;
  Field value;
};

// Whether the value is written as keyframes.
bool has_keyframes(const Field& field);
// The keyframes, whose frames increase.
std::vector<KeyframeField> read_keyframes(const Field& field);

// The value of `key`, read by `read` (one of the above) with the remaining arguments, or `otherwise`.
template <typename T, typename Read, typename... Args>
T read_or(const ObjectReader& object, std::string_view key, T otherwise, Read read, const Args&... args) {
  const auto field = object.find(key);
  return field ? static_cast<T>(read(*field, args...)) : otherwise;
}

// The same for a value that may be animated: fills `track`, and returns the value at frame 0.
template <typename T, typename Read, typename... Args>
T read_animated(const Field& field, Track<T>& track, Read read, const Args&... args) {
  if (!has_keyframes(field)) return read(field, args...);
  for (const KeyframeField& keyframe : read_keyframes(field)) {
    track.frames.push_back(keyframe.frame);
    track.values.push_back(read(keyframe.value, args...));
  }
  return value_at(track, 0, T{});
}
template <typename T, typename Read, typename... Args>
T read_animated_or(const ObjectReader& object, std::string_view key, T otherwise, Track<T>& track, Read read,
                   const Args&... args) {
  const auto field = object.find(key);
  return field ? read_animated(*field, track, read, args...) : otherwise;
}

}  // namespace tessera::core
