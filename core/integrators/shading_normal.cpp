#include "core/integrators/shading_normal.hpp"

#include <algorithm>

#include "core/materials/fresnel.hpp"

namespace tessera::core {
namespace {

constexpr float kMinCos = 1e-4f;

Vec3 lifted(Vec3 w, Vec3 normal, float min_cos) {
  const float cos_w = dot(w, normal);
  return cos_w >= min_cos ? w : normalize(w + normal * (min_cos - cos_w));
}

}  // namespace

Vec3 bend_toward_viewer(Vec3 normal, Vec3 wo) {
  return lifted(normal, wo, kMinCos);
}

Vec3 bend_for_reflection(Vec3 normal, Vec3 side, Vec3 wo) {
  const Vec3 mirrored = reflect(wo, normal);
  // A viewer who grazes the surface sees what grazes it.
  const float min_cos = std::min(0.01f, 0.9f * dot(wo, side));
  return dot(mirrored, side) >= min_cos ? normal : normalize(wo + lifted(mirrored, side, min_cos));
}

Vec3 bend_above(Vec3 wi, Vec3 side) {
  return lifted(wi, side, kMinCos);
}

float smooth_terminator(Vec3 normal, Vec3 side, Vec3 wi) {
  const float true_cos = dot(wi, side), shading_cos = dot(wi, normal) * dot(normal, side);
  if (true_cos <= 0 || shading_cos <= 0) return 0;
  if (true_cos >= shading_cos) return 1;
  const float g = true_cos / shading_cos;
  return g * (1 + g * (1 - g));
}

}  // namespace tessera::core
