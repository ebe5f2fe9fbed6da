// SPDX-License-Identifier: Apache-2.0
// A scene ready to render: flat arrays, shared by all threads. Building it validates everything, so rendering
// cannot fail. It shows one frame at a time: set_frame() moves what is animated, and keeps all geometry.
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
#include "core/media/medium.hpp"
#include "core/scene/area_lights.hpp"
#include "core/scene/description.hpp"
#include "core/scene/pose.hpp"

namespace tessera::core {

class Scene {
 public:
  // Errors name the invalid shape or material. The result does not depend on `threads`, nor on `bvh`, which
  // may be a tree built earlier from the same description.
  static Result<Scene> build(SceneDescription description, int threads, std::optional<Bvh> bvh = {});

  // Shows another frame; a scene that was built shows frame 0. The result is that of a scene that was never
  // at another frame, bit for bit. Nothing else may use the scene meanwhile. Geometry, textures and the trees
  // of objects stay; the scene's own tree is built again if instances move. INVALID_ARGUMENT, and no change,
  // if the scene cannot be rendered at the frame. Unspecified after std::bad_alloc.
  Status set_frame(std::int32_t frame, int threads);
  std::int32_t frame() const { return frame_; }
  const Animation& animation() const { return poses_.animation(); }

  const RenderSettings& settings() const { return settings_; }
  const Camera& camera() const { return camera_; }
  const Primitives& primitives() const { return primitives_; }
  const Bvh& bvh() const { return bvh_; }
  const std::vector<Texture>& textures() const { return textures_; }
  const std::vector<Material>& materials() const { return materials_; }
  // All lights with power: area lights, then delta lights, then the environment.
  const std::vector<Light>& lights() const { return lights_; }
  const LightSampler& light_sampler() const { return light_sampler_; }
  // Samples only delta lights.
  const LightSampler& delta_light_sampler() const { return delta_light_sampler_; }

  // Indices as in MediumInterface.
  const std::vector<Medium>& media() const { return media_; }
  // The medium around the camera, or kNoMedium.
  int camera_medium() const { return camera_medium_; }
  // Whether rays can be in a medium.
  bool has_media() const { return has_media_; }
  // Whether it has a light or a medium that emits.
  bool gives_light() const;

  // Whether no surface lets light pass through but by its model's transmission.
  bool is_opaque() const { return is_opaque_; }
  const Material& material_of(const Hit& hit) const { return materials_[primitives_.material(hit)]; }
  // The index of the AreaLight at the hit, or kNoLight.
  std::uint32_t light_of(const Hit& hit) const { return light_map_.light_of(hit); }
  const AreaLight& area_light(std::uint32_t light) const { return *std::get_if<AreaLight>(&lights_[light]); }
  // The index of the Environment that escaped rays see, or kNoLight.
  std::uint32_t environment_light() const { return environment_light_; }
  const Environment& environment() const { return *std::get_if<Environment>(&lights_[environment_light_]); }

  // The guide that integrators build on first use (caustic_guide.hpp).
  const Lazy<LightGuide>& light_guide() const { return light_guide_; }

 private:
  void add_materials(SceneDescription& description);
  void add_media(SceneDescription& description);
  void add_shapes(SceneDescription& description);
  // All lights, for the present placements of instances.
  void find_lights(const std::vector<LightDescription>& lights, std::optional<Light> environment,
                   int threads);

  RenderSettings settings_;
  PoseMaker poses_;
  std::int32_t frame_ = 0;
  Camera camera_;
  Primitives primitives_;
  AreaLightFinder::Quads quads_;
  Bvh bvh_;
  std::vector<Texture> textures_;
  std::vector<Material> materials_;
  bool is_opaque_ = true;
  std::vector<Medium> media_;
  int camera_medium_ = kNoMedium;
  bool has_media_ = false;
  std::vector<Light> lights_;
  LightMap light_map_;
  std::uint32_t environment_light_ = kNoLight;
  LightSampler light_sampler_, delta_light_sampler_;
  Lazy<LightGuide> light_guide_;
};

}  // namespace tessera::core
