// SPDX-License-Identifier: Apache-2.0
// A scene ready to be rendered: immutable, flat arrays, shared by all threads. Building it validates
// everything, so that rendering cannot fail.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/accel/bvh.hpp"
#include "core/base/error.hpp"
#include "core/base/lazy.hpp"
#include "core/camera/camera.hpp"
#include "core/geometry/primitives.hpp"
#include "core/guiding/light_guide.hpp"
#include "core/lights/light.hpp"
#include "core/lights/light_sampler.hpp"
#include "core/scene/area_lights.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

class Scene {
 public:
  // Errors name the shape or material at fault. `threads` may be used for building; the result does not
  // depend on it, nor on whether `bvh` is given: the tree that was built before of the same description.
  static Result<Scene> build(SceneDescription description, int threads, std::optional<Bvh> bvh = {});

  const RenderSettings& settings() const { return settings_; }
  const Camera& camera() const { return camera_; }
  const Primitives& primitives() const { return primitives_; }
  const Bvh& bvh() const { return bvh_; }
  const std::vector<Texture>& textures() const { return textures_; }
  const std::vector<Material>& materials() const { return materials_; }
  // Those that have power: emissive shapes, then lights without extent, then the environment.
  const std::vector<Light>& lights() const { return lights_; }
  const LightSampler& light_sampler() const { return light_sampler_; }
  // Chooses only among the lights that no ray can meet.
  const LightSampler& delta_light_sampler() const { return delta_light_sampler_; }

  // Whether no material lets rays pass by its opacity.
  bool is_opaque() const { return is_opaque_; }
  const Material& material_of(const Hit& hit) const { return materials_[primitives_.material(hit)]; }
  // The light that what was hit belongs to, an AreaLight, or kNoLight.
  std::uint32_t light_of(const Hit& hit) const { return light_map_.light_of(hit); }
  const AreaLight& area_light(std::uint32_t light) const { return *std::get_if<AreaLight>(&lights_[light]); }
  // The light that rays see which meet nothing, an Environment, or kNoLight.
  std::uint32_t environment_light() const { return environment_light_; }
  const Environment& environment() const { return *std::get_if<Environment>(&lights_[environment_light_]); }

  // What integrators learn of the light before they first use it (caustic_guide.hpp).
  const Lazy<LightGuide>& light_guide() const { return light_guide_; }

 private:
  void add_materials(SceneDescription& description);
  void add_shapes(SceneDescription& description);
  void add_lights(const SceneDescription& description, int threads);

  RenderSettings settings_;
  Camera camera_;
  Primitives primitives_;
  Bvh bvh_;
  std::vector<Texture> textures_;
  std::vector<Material> materials_;
  bool is_opaque_ = true;
  std::vector<Light> lights_;
  LightMap light_map_;
  std::uint32_t environment_light_ = kNoLight;
  LightSampler light_sampler_, delta_light_sampler_;
  Lazy<LightGuide> light_guide_;
};

}  // namespace tessera::core
