// SPDX-License-Identifier: Apache-2.0
// The keys of each object of a scene file: the loader accepts them and suggests them for misspelt keys, and
// a test compares them with scenes/scene.schema.json.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "core/scene/tables/words.hpp"

namespace tessera::core {

struct KeyRule {
  std::string_view name;
  bool required = false;
};

// The keys of one type of object.
struct ObjectRules {
  std::string_view kind;            // as in "a sphere needs the key 'radius'"
  std::string_view schema_pointer;  // the location of its description in the schema
  std::span<const KeyRule> keys;
};

namespace scene_keys {

inline constexpr bool kRequired = true;

inline constexpr std::array kSceneKeys{KeyRule{"$schema"},
                                       KeyRule{"render"},
                                       KeyRule{"camera", kRequired},
                                       KeyRule{"output"},
                                       KeyRule{"textures"},
                                       KeyRule{"materials"},
                                       KeyRule{"objects"},
                                       KeyRule{"shapes", kRequired},
                                       KeyRule{"lights"},
                                       KeyRule{"environment"},
                                       KeyRule{"grids"},
                                       KeyRule{"media"}};
inline constexpr std::array kRenderKeys{
    KeyRule{"width"},     KeyRule{"height"},         KeyRule{"spp"},
    KeyRule{"seed"},      KeyRule{"integrator"},     KeyRule{"heuristic"},
    KeyRule{"max_depth"}, KeyRule{"filter"},         KeyRule{"filter_radius"},
    KeyRule{"crop"},      KeyRule{"clamp_indirect"}, KeyRule{"layers"}};
inline constexpr std::array kOutputKeys{KeyRule{"exposure"}, KeyRule{"tone_curve"}};
inline constexpr std::array kTextureKeys{
    KeyRule{"file", kRequired}, KeyRule{"color_space"}, KeyRule{"channel"},
    KeyRule{"layer"},           KeyRule{"wrap"},        KeyRule{"scale"},
    KeyRule{"offset"},          KeyRule{"wrap_v"},      KeyRule{"shear"},
    KeyRule{"uv_set"},          KeyRule{"filter"}};
inline constexpr std::array kGridKeys{KeyRule{"file", kRequired}, KeyRule{"filter"}, KeyRule{"border"}};
inline constexpr std::array kObjectKeys{KeyRule{"shapes", kRequired}};
inline constexpr std::array kTransformStepKeys{KeyRule{"scale"}, KeyRule{"rotate"}, KeyRule{"translate"},
                                               KeyRule{"matrix"}};
inline constexpr std::array kAnimatedKeys{KeyRule{"keyframes", kRequired}};
inline constexpr std::array kKeyframeKeys{KeyRule{"frame", kRequired}, KeyRule{"value", kRequired}};
inline constexpr std::array kRotationKeys{KeyRule{"axis", kRequired}, KeyRule{"degrees", kRequired}};
inline constexpr std::array kQuaternionKeys{KeyRule{"quaternion", kRequired}};

inline constexpr ObjectRules kScene{"scene", "", kSceneKeys};
inline constexpr ObjectRules kRender{"render", "/properties/render", kRenderKeys};
inline constexpr ObjectRules kOutput{"output", "/properties/output", kOutputKeys};
inline constexpr ObjectRules kTexture{"texture", "/$defs/texture", kTextureKeys};
inline constexpr ObjectRules kGrid{"grid", "/$defs/grid", kGridKeys};
inline constexpr ObjectRules kObject{"object", "/$defs/object", kObjectKeys};
inline constexpr ObjectRules kTransformStep{"transform step", "/$defs/transform_step", kTransformStepKeys};
inline constexpr ObjectRules kRotation{"rotation", "/$defs/rotation", kRotationKeys};
inline constexpr ObjectRules kQuaternion{"quaternion", "/$defs/quaternion", kQuaternionKeys};
inline constexpr ObjectRules kAnimated{"animated value", "/$defs/animated", kAnimatedKeys};
inline constexpr ObjectRules kKeyframe{"keyframe", "/$defs/keyframe", kKeyframeKeys};

inline constexpr std::array kAllObjects{kScene,         kRender,   kOutput,     kTexture,  kGrid,    kObject,
                                        kTransformStep, kRotation, kQuaternion, kAnimated, kKeyframe};

}  // namespace scene_keys
}  // namespace tessera::core
