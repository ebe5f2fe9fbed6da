// SPDX-License-Identifier: Apache-2.0
// The closures of layered materials at a point, with their textures evaluated. T is float for one point, or
// FloatN for one in each lane.
#pragma once

#include "core/materials/model_at.hpp"
#include "core/shading/closure.hpp"

namespace tessera::core::shading {

template <typename T>
ClosureOf<T> closure_at(const ModelAt<T, Principled>& model);
// Of the same kind of microfacets in all lanes.
template <typename T>
ClosureOf<T> closure_at(const ModelAt<T, Plastic>& model);
template <typename T>
ClosureOf<T> closure_at(const ModelAt<T, ConductorMaterial>& model);
template <typename T>
ClosureOf<T> closure_at(const ModelAt<T, DiffuseTransmission>& model);
template <typename T>
ClosureOf<T> closure_at(const ModelAt<T, ThinDielectric>& model);

}  // namespace tessera::core::shading
