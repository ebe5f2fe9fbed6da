// SPDX-License-Identifier: Apache-2.0
// Reflection and refraction at smooth boundaries. Cosines are of the angle between the normal and the
// incident direction, in [0, 1].
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// The model of a dielectric boundary's reflectance. Total internal reflection applies to all models.
enum class DielectricFresnel {
  kExact,    // Fresnel's equations
  kSchlick,  // their approximation by Schlick 1994
  kNone,     // no reflection
};

// Unpolarised reflectance of a dielectric boundary (Born and Wolf 1999, section 1.5.2). eta is the index on
// the far side over the near side. 1 for total internal reflection.
template <typename T = float>
T fresnel_dielectric(std::type_identity_t<T> cos_i, std::type_identity_t<T> eta) {
  using std::sqrt;
  const T sin2_t = (1 - cos_i * cos_i) / (eta * eta);
  const T cos_t = sqrt(1 - sin2_t);
  const T parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const T perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return select(sin2_t >= 1, T(1.0f), (parallel * parallel + perpendicular * perpendicular) / 2);
}

// Reflectance of a dielectric boundary at normal incidence, from either side.
template <typename T>
T normal_reflectance(T eta) {
  const T r = (eta - 1) / (eta + 1);
  return r * r;
}

// The inverse: the index, from 1 to `largest`, whose reflectance at normal incidence is f0.
inline float index_of_reflectance(float f0, float largest) {
  const float root = std::sqrt(std::max(f0, 0.0f));
  if (root >= 1) return largest;
  return std::min((1 + root) / (1 - root), largest);
}

template <typename T>
T fifth_power(T x) {
  const T x2 = x * x;
  return x2 * x2 * x;
}

// Schlick 1994, using the angle in the thinner medium, which handles total internal reflection.
template <typename T = float>
T fresnel_dielectric_schlick(std::type_identity_t<T> cos_i, std::type_identity_t<T> eta) {
  using std::sqrt;
  const T sin2_t = (1 - cos_i * cos_i) / (eta * eta);
  const T f0 = normal_reflectance(eta);
  const T thinner_cos = select(eta < 1, sqrt(1 - sin2_t), cos_i);
  return select(sin2_t >= 1, T(1.0f), f0 + (1 - f0) * fifth_power(1 - thinner_cos));
}

// The reflectance by the model in each lane; exact where neither is set.
template <typename T>
struct DielectricFresnelOf {
  T operator()(T cos_i, T eta) const {
    T reflected = fresnel_dielectric<T>(cos_i, eta);
    if (any(schlick)) reflected = select(schlick, fresnel_dielectric_schlick<T>(cos_i, eta), reflected);
    if (any(none))
      reflected = select(none, select(1 - cos_i * cos_i >= eta * eta, T(1.0f), T(0.0f)), reflected);
    return reflected;
  }

  MaskOf<T> schlick{}, none{};
};
inline DielectricFresnelOf<float> fresnel_of(DielectricFresnel model) {
  return {model == DielectricFresnel::kSchlick, model == DielectricFresnel::kNone};
}
inline float dielectric_reflectance(DielectricFresnel model, float cos_i, float eta) {
  return fresnel_of(model)(cos_i, eta);
}

// Schlick 1994, from the reflectance at normal incidence.
template <typename T>
RgbOf<T> fresnel_schlick(std::type_identity_t<T> cos_i, RgbOf<T> f0) {
  return f0 + (RgbOf<T>::gray(1) - f0) * fifth_power(1 - smaller(cos_i, T(1.0f)));
}

// |r|^2 of both polarisations from eta^2 - k^2 - sin^2 and 2 eta k, the real and imaginary parts of the
// squared normal component of the wave vector in the metal.
template <typename T>
T conductor_reflectance(T cos_i, T eta, T k) {
  using std::sqrt;
  const T cos2 = cos_i * cos_i, sin2 = 1 - cos2;
  const T real = eta * eta - k * k - sin2, imaginary = 2 * eta * k;
  const T magnitude = sqrt(real * real + imaginary * imaginary);
  const T a = sqrt(larger(T(0.0f), (magnitude + real) / 2));
  const T across = 2 * a * cos_i, along = across * sin2;
  const T perpendicular = (magnitude + cos2 - across) / (magnitude + cos2 + across);
  const T sum = cos2 * magnitude + sin2 * sin2;
  return perpendicular * (1 + (sum - along) / (sum + along)) / 2;
}

// Unpolarised reflectance of a metal with the complex index eta + i k, seen from air (Born and Wolf 1999,
// section 14.2), for each channel.
template <typename T>
RgbOf<T> fresnel_conductor(std::type_identity_t<T> cos_i, RgbOf<T> eta, RgbOf<T> k) {
  return {conductor_reflectance(cos_i, eta.r, k.r), conductor_reflectance(cos_i, eta.g, k.g),
          conductor_reflectance(cos_i, eta.b, k.b)};
}

// `w` and the result point away from the surface; `normal` has unit length.
template <typename T = float>
Vec3Of<T> reflect(Vec3Of<T> w, Vec3Of<T> normal) {
  return normal * (2 * dot(w, normal)) - w;
}

// Snell's law. `normal` is on the side of `w`; eta as above. Not found for total internal reflection.
template <typename T>
struct RefractedOf {
  MaskOf<T> found;
  Vec3Of<T> wi;
};
template <typename T>
RefractedOf<T> refracted(Vec3Of<T> w, Vec3Of<T> normal, T eta) {
  using std::sqrt;
  const T cos_i = dot(w, normal);
  const T sin2_t = (1 - cos_i * cos_i) / (eta * eta);
  const T cos_t = sqrt(1 - sin2_t);
  return {!(sin2_t >= 1), -w / eta + normal * (cos_i / eta - cos_t)};
}
std::optional<Vec3> refract(Vec3 w, Vec3 normal, float eta);

}  // namespace tessera::core
