// SPDX-License-Identifier: Apache-2.0
// Access to a plugin's properties while a Mitsuba scene is converted. Not thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/import/scene_builder.hpp"
#include "core/scene/mitsuba/scene_graph.hpp"

namespace tessera::core::mitsuba {

// What converters share: the scene as written, and as it becomes. Both must outlive this object.
struct Conversion {
  SceneBuilder& builder;
  SceneGraph& graph;
  Status status{};  // the first error that makes the whole scene fail: it exceeds a limit
  // Whether Mitsuba's integrator counts surfaces that light passes straight through for a limited depth.
  bool counts_passing = false;
  bool hides_emitters = false;  // from the camera
  bool emission_only = false;   // nothing that is scattered is seen
  float near_clip = 0;          // distances between which Mitsuba's camera sees
  float far_clip = std::numeric_limits<float>::infinity();
  float shutter_open = 0;    // the time of frame 0; each unit of time has a frame
  float shutter_frames = 0;  // how long the shutter is open
  // Parameters that plugins of a type could have, but lack.
  std::map<std::string, std::set<std::string, std::less<>>, std::less<>> missing{};

  void check(const Status& done) {
    if (!done && status) status = done;
  }

  // The path of a file that the scene names; nullopt if there is none.
  std::optional<std::string> find_file(const std::string& written) const;
  // Keyframes by frame instead of time.
  KeyedTransforms in_frames(KeyedTransforms keys) const;
};

// A node, whose properties are marked as used when they are asked for. A property of a wrong type counts as
// missing, with a warning. A handle; cheap to copy.
class Plugin {
 public:
  Plugin(Conversion& conversion, NodeId id) : conversion_(&conversion), id_(id) {}

  NodeId id() const { return id_; }
  Kind kind() const { return node().kind; }
  const std::string& type() const { return node().type; }
  const std::string& name() const { return node().id; }  // its id
  bool in_emitter() const { return node().in_emitter; }
  const Location& where() const { return node().where; }
  const std::string& file() const { return conversion_->graph.files[where().file]; }
  // For messages: "<bsdf type="plastic">".
  std::string shown() const;

  bool has(std::string_view name) const;
  double number(std::string_view name, double otherwise) const;
  float real(std::string_view name, float otherwise) const {
    return static_cast<float>(number(name, static_cast<double>(otherwise)));
  }
  // The same within limits; a value outside becomes the nearer limit, with a warning.
  float real_in(std::string_view name, float otherwise, float least, float most) const;
  std::int64_t integer(std::string_view name, std::int64_t otherwise) const;
  std::int64_t integer_in(std::string_view name, std::int64_t otherwise, std::int64_t least,
                          std::int64_t most) const;
  bool flag(std::string_view name, bool otherwise) const;
  // nullopt if there is none, or it is no string.
  std::optional<std::string> text(std::string_view name) const;
  std::optional<Vec3> vector(std::string_view name) const;
  // The identity if there is none. Of an animation, the first keyframe, with a warning.
  Transform transform(std::string_view name) const;
  // The keyframes of an animation; null if the parameter is none.
  const KeyedTransforms* animation(std::string_view name) const;
  std::optional<Plugin> child(std::string_view name) const;
  // The objects of a kind, under any name.
  std::vector<Plugin> children(Kind kind) const;
  std::optional<Plugin> first_child(Kind kind) const;
  // The value of any type; null if there is none.
  const Property* property(std::string_view name) const;

  // Marks properties as used that have no effect on the expected image.
  void ignore(std::initializer_list<std::string_view> names) const;
  // Marks the objects of a kind as used, without looking at them.
  void ignore(Kind kind) const;
  // Marks everything as used, of a plugin that is left out as a whole.
  void ignore_all() const;
  // Says at the plugin what is approximated or left out, and what is done instead. `what` continues
  // "<bsdf type="...">: ". Equal warnings about a type are counted.
  void warn(std::string_view what) const { warn(what, what); }
  // Warnings of equal kind are counted.
  void warn(std::string_view kind, std::string_view what) const;
  FilePlace place() const { return {file(), where().line}; }

 private:
  Node& node() const { return conversion_->graph.nodes[id_]; }
  // The value if there is one of this type; a warning if it has another.
  template <typename T>
  const T* value(std::string_view name, std::string_view type_name) const;

  Conversion* conversion_;
  NodeId id_;
};

// The colour of a number, whole or not, or of a colour; nullopt for other values.
std::optional<Rgb> constant_color(const Property& property);

// The emitters of a shape: of its surface, and of the medium inside.
std::optional<Plugin> area_light_of(const Plugin& shape);
std::optional<Plugin> volume_light_of(const Plugin& shape);

// Warns of all properties of converted plugins that no converter has asked for.
void warn_of_unused(Conversion& conversion);

}  // namespace tessera::core::mitsuba
