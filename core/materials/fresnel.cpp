// SPDX-License-Identifier: Apache-2.0
#include "core/materials/fresnel.hpp"

namespace tessera::core {

std::optional<Vec3> refract(Vec3 w, Vec3 normal, float eta) {
  const auto [found, wi] = refracted(w, normal, eta);
  return found ? std::optional(wi) : std::nullopt;
}

}  // namespace tessera::core
