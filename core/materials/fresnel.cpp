#include "core/materials/fresnel.hpp"

#include <algorithm>
#include <cmath>

namespace tessera::core {
namespace {

float fifth_power(float x) {
  const float x2 = x * x;
  return x2 * x2 * x;
}

float squared(float x) {
  return x * x;
}

// |r|^2 of both polarisations from eta^2 - k^2 - sin^2 and 2 eta k, the parts of the squared normal component
// of the wave vector in the metal.
float conductor_reflectance(float cos_i, float eta, float k) {
  const float cos2 = cos_i * cos_i, sin2 = 1 - cos2;
  const float real = eta * eta - k * k - sin2;
  const float magnitude = std::sqrt(real * real + squared(2 * eta * k));
  const float a = std::sqrt(std::max(0.0f, (magnitude + real) / 2));
  const float across = 2 * a * cos_i, along = across * sin2;
  const float perpendicular = (magnitude + cos2 - across) / (magnitude + cos2 + across);
  const float sum = cos2 * magnitude + sin2 * sin2;
  return perpendicular * (1 + (sum - along) / (sum + along)) / 2;
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

Rgb fresnel_schlick(float cos_i, Rgb f0) {
  return f0 + (Rgb::gray(1) - f0) * fifth_power(1 - std::min(cos_i, 1.0f));
}

Rgb fresnel_conductor(float cos_i, Rgb eta, Rgb k) {
  return {conductor_reflectance(cos_i, eta.r, k.r), conductor_reflectance(cos_i, eta.g, k.g),
          conductor_reflectance(cos_i, eta.b, k.b)};
}

std::optional<Vec3> refract(Vec3 w, Vec3 normal, float eta) {
  const float cos_i = dot(w, normal);
  const float sin2_t = (1 - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1) return std::nullopt;
  const float cos_t = std::sqrt(1 - sin2_t);
  return -w / eta + normal * (cos_i / eta - cos_t);
}

}  // namespace tessera::core
