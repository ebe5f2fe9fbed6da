// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/scene_defaults.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/lights/equirectangular.hpp"
#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

// The axes of a studio in world space: to the right as seen from the front, up, and toward the viewer.
struct StudioAxes {
  Vec3 right, up, front;

  Vec3 direction(float x, float y, float z) const { return normalize(right * x + up * y + front * z); }
};

StudioAxes studio_axes(const SceneDefaults& axes) {
  return {cross(axes.up, axes.front), axes.up, axes.front};
}

// A lobe of 1 around `axis`; the cosine to the power of 2^`doublings`.
float soft_light(Vec3 direction, Vec3 axis, int doublings) {
  float value = std::max(dot(direction, axis), 0.0f);
  for (int i = 0; i < doublings; ++i) value *= value;
  return value;
}

float studio_radiance(Vec3 direction, const StudioAxes& axes) {
  const float height = 0.5f + 0.5f * dot(direction, axes.up);
  const float gradient = 0.25f + 0.5f * height * height;
  return gradient + 6 * soft_light(direction, axes.direction(-1, 1.2f, 1.2f), 4) +
         1.5f * soft_light(direction, axes.direction(1.5f, 0.5f, 0.5f), 3);
}

}  // namespace

CameraDescription default_camera(const Aabb& bounds, float aspect, const SceneDefaults& axes) {
  CameraDescription camera;
  const Vec3 center = bounds.lower + (bounds.upper - bounds.lower) * 0.5f;
  const float radius = std::max(0.5f * length(bounds.upper - bounds.lower), 1e-6f);
  // The bounding sphere fits into the narrower of the two angles of view.
  const SinCos half = sin_cos_turns(camera.vertical_fov_degrees / 720);
  const float narrow = std::min(aspect, 1.0f) * half.sin / half.cos;
  const float sine = narrow / std::sqrt(1 + narrow * narrow);
  camera.look_at = center;
  camera.up = axes.up;
  camera.position = center + studio_axes(axes).direction(0.45f, 0.35f, 1) * (1.02f * radius / sine);
  return camera;
}

TextureImage studio_environment(const SceneDefaults& axes) {
  constexpr int kWidth = 128, kHeight = 64;
  const StudioAxes studio = studio_axes(axes);
  const lights::EquirectangularMap map(0);
  std::vector<float> values;
  values.reserve(std::size_t{3} * kWidth * kHeight);
  for (int y = 0; y < kHeight; ++y) {
    // The angle from the upper pole, in turns.
    const SinCos polar = sin_cos_turns((static_cast<float>(y) + 0.5f) / (2 * kHeight));
    for (int x = 0; x < kWidth; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / kWidth;
      const Vec3 direction = map.direction(u, 1 - polar.cos, 1.0f);
      values.insert(values.end(), 3, studio_radiance(direction, studio));
    }
  }
  return TextureImage(kWidth, kHeight, std::move(values));
}

}  // namespace tessera::core
