// SPDX-License-Identifier: Apache-2.0
// The closures of layered materials at a point, with their textures evaluated.
#pragma once

#include <array>
#include <vector>

#include "core/materials/material.hpp"
#include "core/math/lane_array.hpp"
#include "core/shading/closure.hpp"

namespace tessera::core {

// Where a material is seen; in each lane for T = Float8.
template <typename T>
struct MaterialPointOf {
  const std::vector<Texture>& textures;
  UvSetsOf<T> uv;
  MaskOf<T> outside;  // the viewer is on the side that the outward geometric normal points to
  RgbOf<T> tint;      // multiplies the base colour
};
using MaterialPoint = MaterialPointOf<float>;

// Whether the model is one of these.
bool is_layered(const MaterialModel& model);
// Whether it is, and of microfacets that have a vector form.
bool has_vector_form(const MaterialModel& model);

// `model` must be layered.
ClosureOf<float> closure_of(const MaterialModel& model, const MaterialPoint& at);

// All models must be of the same type, and have a vector form. Each lane is bit-identical to closure_of().
using ModelPointers = std::array<const MaterialModel*, kLaneCount>;
ClosureOf<Float8> closures_of(const ModelPointers& models, const MaterialPointOf<Float8>& at);

}  // namespace tessera::core
