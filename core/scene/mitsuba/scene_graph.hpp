// SPDX-License-Identifier: Apache-2.0
// The objects of a Mitsuba scene, as its XML files write them: plugins with their properties, with parameters
// substituted, files included and references resolved. What plugins mean is the converters' business.
// Not thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/math/rgb.hpp"
#include "core/math/transform.hpp"
#include "core/math/vec3.hpp"
#include "core/scene/import/keyed_transforms.hpp"
#include "core/spectra/color_matching.hpp"

namespace tessera::core::mitsuba {

// A line of a file.
struct Location {
  std::uint32_t file = 0;  // index in SceneGraph::files
  int line = 0;            // from 1
};

enum class Kind {
  kScene,
  kShape,
  kBsdf,
  kTexture,  // also <spectrum type="...">
  kEmitter,
  kSensor,
  kFilm,
  kSampler,
  kFilter,
  kIntegrator,
  kMedium,
  kPhase,
  kVolume,
};
std::string_view tag_of(Kind kind);  // "bsdf"

// Of elements in files, and of chains of references.
inline constexpr int kMaxNesting = 100;

using NodeId = std::uint32_t;  // index in SceneGraph::nodes

// An object that is a property. `node` may be shared by several owners.
struct Child {
  NodeId node = 0;
};
// A spectrum given by samples. In properties it is the colour that it has there.
using Samples = std::vector<spectra::SpectralSample>;

struct Property {
  using Value =
      std::variant<bool, std::int64_t, double, std::string, Vec3, Rgb, Transform, KeyedTransforms, Child>;

  std::string name;  // empty for objects without a name
  Location where;
  Value value;
  bool used = false;  // whether a converter has asked for it
};

struct Node {
  Kind kind = Kind::kScene;
  std::string type;  // the plugin: "diffuse"
  std::string id;    // empty without
  Location where;
  std::vector<Property> properties;
  bool in_emitter = false;  // it is an emitter, or written inside of one
  bool visited = false;     // whether a converter has asked for a property
};

struct SceneGraph {
  std::vector<std::string> files;    // paths for SceneBuilder; the first is the scene file
  std::vector<Node> nodes;           // the first is the scene
  std::string camera;                // the chosen sensor: a name or a number; empty: the first
  std::vector<std::string> folders;  // files whose folders are searched for other files, in this order
};

}  // namespace tessera::core::mitsuba
