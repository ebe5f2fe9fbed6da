// SPDX-License-Identifier: Apache-2.0
#include "core/materials/fresnel.hpp"

#include <cmath>

namespace tessera::core {
namespace {

float squared(float x) {
  return x * x;
}

}  // namespace

float fresnel_dielectric(float cos_i, float eta) {
  const float sin2_t = (1 - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1) return 1;
  const float cos_t = std::sqrt(1 - sin2_t);
  const float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return (parallel * parallel + perpendicular * perpendicular) / 2;
}

float fresnel_dielectric_schlick(float cos_i, float eta) {
  const float sin2_t = (1 - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1) return 1;
  const float f0 = squared((eta - 1) / (eta + 1));
  return f0 + (1 - f0) * fifth_power(1 - (eta < 1 ? std::sqrt(1 - sin2_t) : cos_i));
}

float dielectric_reflectance(DielectricFresnel fresnel, float cos_i, float eta) {
  if (fresnel == DielectricFresnel::kExact) return fresnel_dielectric(cos_i, eta);
  if (fresnel == DielectricFresnel::kSchlick) return fresnel_dielectric_schlick(cos_i, eta);
  return 1 - cos_i * cos_i >= eta * eta ? 1.0f : 0.0f;
}

std::optional<Vec3> refract(Vec3 w, Vec3 normal, float eta) {
  const float cos_i = dot(w, normal);
  const float sin2_t = (1 - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1) return std::nullopt;
  const float cos_t = std::sqrt(1 - sin2_t);
  return -w / eta + normal * (cos_i / eta - cos_t);
}

}  // namespace tessera::core
