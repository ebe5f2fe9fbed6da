// SPDX-License-Identifier: Apache-2.0
// The surfaces that camera rays hit first, for the layers that describe them. They are traced apart from the
// paths, with the random numbers with which these pass through surfaces, so that both see the same, and no
// integrator needs to know layers. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/film/layers.hpp"
#include "core/geometry/ray.hpp"
#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"
#include "core/sampling/sampler.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core::integrators {

// The layers that need first hits.
inline const LayerSet kSurfaceLayers = LayerSet{}
                                           .with(Layer::kAlbedo)
                                           .with(Layer::kNormal)
                                           .with(Layer::kDepth)
                                           .with(Layer::kPosition)
                                           .with(Layer::kUv)
                                           .with(Layer::kObjectIndex)
                                           .with(Layer::kMaterialIndex)
                                           .with(Layer::kInstanceIndex)
                                           .with(Layer::kCryptoObject)
                                           .with(Layer::kCryptoMaterial)
                                           .with(Layer::kCryptoAsset);

// As the layers of these names. All 0 if nothing was hit.
struct FirstHit {
  bool found = false;
  Rgb albedo{};
  Vec3 normal{}, position{};
  Vec2 uv{};
  float depth = 0;
  std::uint32_t object = 0, material = 0, instance = 0;  // from 1
  std::uint32_t crypto_object = 0, crypto_material = 0, crypto_asset = 0;
};

// The first hit of each camera ray, which belongs to the sample of the same place. Returns the number of rays
// traced.
std::uint64_t find_first_hits(const Scene& scene, std::span<const Ray> rays,
                              std::span<const sampling::Sampler* const> samplers, std::span<FirstHit> hits);

}  // namespace tessera::core::integrators
