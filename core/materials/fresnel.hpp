// Reflection and refraction at smooth boundaries. Cosines are of the angle between the normal and the
// incident direction, in [0, 1].
#pragma once

#include <optional>

#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// Which share of the light a dielectric boundary reflects. Light that cannot pass it is always reflected.
enum class DielectricFresnel {
  kExact,    // Fresnel's equations
  kSchlick,  // their approximation by Schlick 1994
  kNone,     // none of it
};

// Unpolarised reflectance of a dielectric boundary (Born and Wolf 1999, section 1.5.2). eta is the index on
// the far side over that on the near side. 1 for total reflection.
float fresnel_dielectric(float cos_i, float eta);

// Schlick 1994. The angle is that in the thinner medium, so that total reflection is met.
float fresnel_dielectric_schlick(float cos_i, float eta);

float dielectric_reflectance(DielectricFresnel fresnel, float cos_i, float eta);

// Schlick 1994, from the reflectance at normal incidence.
Rgb fresnel_schlick(float cos_i, Rgb f0);

// Unpolarised reflectance of a metal with the complex index eta + i k, seen from air (Born and Wolf 1999,
// section 14.2), for each channel.
Rgb fresnel_conductor(float cos_i, Rgb eta, Rgb k);

// `w` and the result point away from the surface; `normal` is of unit length.
inline Vec3 reflect(Vec3 w, Vec3 normal) {
  return normal * (2 * dot(w, normal)) - w;
}

// Snell's law. `normal` is on the side of `w`; eta as above. Nothing for total reflection.
std::optional<Vec3> refract(Vec3 w, Vec3 normal, float eta);

}  // namespace tessera::core
