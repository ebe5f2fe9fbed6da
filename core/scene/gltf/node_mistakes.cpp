// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/node_mistakes.hpp"

#include <fmt/format.h>

#include <cmath>

namespace tessera::core::gltf {
namespace {

// That of Khronos' glTF-Validator, which allows for quaternions of four signed bytes.
constexpr float kUnitTolerance = 0.00769f;

// All primitives of a mesh must have the same number.
std::size_t morph_targets_of(const Value& mesh) {
  const Value primitives = mesh["primitives"];
  return primitives.size() == 0 ? 0 : primitives.at(0)["targets"].size();
}

}  // namespace

void tell_second_placement(const Document& document, const Value& node) {
  if (!node["matrix"].exists()) return;
  if (node["translation"].exists() || node["rotation"].exists() || node["scale"].exists())
    document.warn(node, "matrix and translation",
                  "has a matrix and a translation, rotation or scale; only the matrix is used");
}

void tell_odd_rotation(const Document& document, const Value& place, const std::vector<float>& quaternion) {
  float sum = 0;
  for (const float component : quaternion) sum += component * component;
  const float norm = std::sqrt(sum);
  if (!(norm > 0) || !std::isfinite(norm))
    document.warn(place, "rotation without length",
                  "a rotation must be a unit quaternion, got one without a finite length above 0; it turns "
                  "nothing");
  else if (std::fabs(norm - 1) > kUnitTolerance)
    document.warn(
        place, "rotation of another length",
        fmt::format("a rotation must be a unit quaternion, got one of length {:g}; it is normalised", norm));
}

void tell_odd_weights(const Document& document, const Value& place, std::size_t weights, const Value& mesh) {
  const std::size_t targets = morph_targets_of(mesh);
  if (weights == targets) return;
  document.warn(place, weights > targets ? "more weights" : "fewer weights",
                fmt::format("has {} weights for {} morph targets; {}", weights, targets,
                            weights > targets ? "the further ones are ignored" : "the missing ones are 0"));
}

}  // namespace tessera::core::gltf
