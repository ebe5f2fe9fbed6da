// SPDX-License-Identifier: Apache-2.0
// Learns where the environment is seen from in scenes that it lights through openings: most light samples of
// it would meet walls. Immutable, shared by all threads.
#pragma once

#include <cstdint>
#include <utility>

#include "core/guiding/light_guide.hpp"
#include "core/lights/light_sample_context.hpp"
#include "core/lights/light_sampler.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core::integrators {

// A second technique of light sampling: at a vertex, a share of the light samples go to the environment, in
// directions that have been seen to be open from places around; all others are those of the light sampler.
class EnvironmentGuide {
 public:
  EnvironmentGuide() = default;  // an empty guide
  explicit EnvironmentGuide(guiding::LightGuide guide) : guide_(std::move(guide)) {}

  bool empty() const { return guide_.guides_nothing(); }

  // The guide's data at a point; its share is 0 where too little is known, where samples of the light sampler
  // find the environment well, and where light counts from all sides.
  template <typename T>
  using GuidanceOf = guiding::LightGuide::GuidanceOf<T>;
  template <typename T>
  GuidanceOf<T> at(const lights::LightSampleContextOf<T>& point) const {
    GuidanceOf<T> guidance = guide_.at(point.position, point.normal);
    guidance.share = select(length_squared(point.normal) > 0, guidance.share, T(0.0f));
    return guidance;
  }
  // LightGuide::sample_or(). `other` is not zero in any lane.
  template <typename T>
  guiding::DirectionTrees::DirectionOf<T> sample_or(const GuidanceOf<T>& from, MaskOf<T> sampled, Vec2Of<T> u,
                                                    Vec3Of<T> other) const {
    return guide_.sample_or(from, sampled, u, other);
  }

 private:
  guiding::LightGuide guide_;
};

// The number of camera paths of every render's learning.
inline constexpr std::uint32_t kCameraPaths = 3u << 13;

// Light samples from vertices of camera paths find out what is open. Empty unless the environment lights the
// scene, and most of that light does not arrive. `lights` samples all lights, with `compensation`;
// `through_panes`: RenderPlan::samples_through_panes(). For scenes without media. Takes some tenths of a
// second with one thread, where it is not empty; the result does not depend on `threads`.
EnvironmentGuide build_environment_guide(const Scene& scene, const lights::LightSampler& lights,
                                         lights::MisCompensation compensation, bool through_panes,
                                         int threads, std::uint32_t camera_paths = kCameraPaths);

}  // namespace tessera::core::integrators
