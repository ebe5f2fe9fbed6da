// Reflection and refraction at smooth boundaries.
#pragma once

#include <optional>

#include "core/math/vec3.hpp"

namespace tessera::core {

// Unpolarised reflectance of a dielectric boundary (Born and Wolf 1999, section 1.5.2).
// cos_i in [0, 1]; eta is the index on the far side over that on the near side. 1 for total reflection.
float fresnel_dielectric(float cos_i, float eta);

// `w` and the result point away from the surface; `normal` is of unit length.
inline Vec3 reflect(Vec3 w, Vec3 normal) {
  return normal * (2 * dot(w, normal)) - w;
}

// Snell's law. `normal` is on the side of `w`; eta as above. Nothing for total reflection.
std::optional<Vec3> refract(Vec3 w, Vec3 normal, float eta);

}  // namespace tessera::core
