// SPDX-License-Identifier: Apache-2.0
// A scene ready to render: flat arrays, shared by all threads. Building it validates everything, so rendering
// cannot fail. It shows one frame at a time: set_frame() moves what is animated, and keeps all else.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/accel/bvh.hpp"
#include "core/base/error.hpp"
#include "core/camera/camera.hpp"
#include "core/geometry/primitives.hpp"
#include "core/lights/light.hpp"
#include "core/media/medium.hpp"
#include "core/scene/area_lights.hpp"
#include "core/scene/description.hpp"
#include "core/scene/light_groups.hpp"
#include "core/scene/nested_dielectrics.hpp"
#include "core/scene/pose.hpp"
#include "core/scene/scene_ids.hpp"
#include "core/scene/surface_opacity.hpp"

namespace tessera::core {

class Scene {
 public:
  // Errors name the invalid shape or material. The result does not depend on `threads`, nor on `bvh`, which
  // may be a tree built earlier from the same description.
  static Result<Scene> build(SceneDescription description, int threads, std::optional<accel::Bvh> bvh = {});

  // Shows another frame; a scene that was built shows frame 0. The result is that of a scene that was never
  // at another frame, bit for bit. Nothing else may use the scene meanwhile. Other geometry, textures and the
  // trees of objects stay; the scene's own tree is built again if instances move or meshes deform.
  // INVALID_ARGUMENT, and no change, if the scene cannot be rendered at the frame. Unspecified after
  // std::bad_alloc.
  Status set_frame(std::int32_t frame, int threads);
  std::int32_t frame() const { return frame_; }
  // Another number after each change of what the scene shows.
  std::uint64_t revision() const { return revision_; }
  const Animation& animation() const { return poses_.animation(); }

  const RenderSettings& settings() const { return settings_; }
  // The camera at the frame, or when a shutter opens that takes no time; while one is open, camera_ray()
  // counts.
  const Camera& camera() const { return camera_; }
  // Calls what(camera) with the camera at a time from 0, when the shutter opens, to 1, when it closes.
  template <typename What>
  auto with_camera(float time, const What& what) const {
    return camera_moves_ ? what(moving_camera(time)) : what(camera_);
  }
  // Camera::ray() at such times.
  RayOf<FloatN> camera_rays(Vec2Of<FloatN> raster, int width_px, int height_px, Vec2Of<FloatN> u_lens,
                            FloatN time) const {
    RayOf<FloatN> rays = camera_moves_ ? moving_camera_rays(raster, width_px, height_px, u_lens, time)
                                       : camera_.ray(raster, width_px, height_px, u_lens);
    rays.time = time;
    return rays;
  }
  // Camera::depth() at the same time.
  float camera_depth(Vec3 origin, Vec3 point, float time) const {
    return with_camera(time, [&](const Camera& camera) { return camera.depth(origin, point); });
  }
  // Whether the image depends on the times of rays: something moves while the shutter is open.
  bool has_motion() const { return camera_moves_ || primitives_.has_motion(); }
  const Primitives& primitives() const { return primitives_; }
  // Knows the geometry alone; rays of light use these queries, which pass where surfaces are transparent.
  const accel::Bvh& bvh() const { return bvh_; }
  Hit closest_hit(const Ray& ray) const { return bvh_.closest_hit(primitives_, ray, TracedOpacity(*this)); }
  void closest_hits(ColumnsView<const Ray> rays, ColumnsView<Hit> hits) const {
    bvh_.closest_hits(primitives_, rays, hits, TracedOpacity(*this));
  }
  accel::Occlusion occlusion(const Ray& ray) const {
    return bvh_.occlusion(primitives_, ray, TracedOpacity(*this));
  }
  void occlusions(ColumnsView<const Ray> rays, std::span<accel::Occlusion> occluded) const {
    bvh_.occlusions(primitives_, rays, occluded, TracedOpacity(*this));
  }
  const std::vector<Texture>& textures() const { return textures_; }
  const std::vector<Material>& materials() const { return materials_; }
  // All lights with power: area lights, then delta lights, then the environment.
  const std::vector<lights::Light>& lights() const { return lights_; }
  // Those that lights, materials and the environment name, sorted.
  const std::vector<std::string>& light_groups() const { return light_groups_; }
  // The index of the light's group among these, or kNoLightGroup.
  std::uint32_t light_group(std::uint32_t light) const {
    return light < groups_of_lights_.size() ? groups_of_lights_[light] : kNoLightGroup;
  }

  // Indices as in MediumInterface.
  const std::vector<Medium>& media() const { return media_; }
  // The medium around the camera, or kNoMedium.
  int camera_medium() const { return camera_medium_; }
  // Whether rays can be in a medium.
  bool has_media() const { return has_media_; }
  // Whether it has a light or a medium that emits.
  bool gives_light() const;

  // Whether no surface lets light pass through but by its model's transmission. Nested dielectrics may, and
  // what is hidden from the camera.
  bool is_opaque() const { return is_opaque_; }
  // Whether some material refracts light by its wavelength.
  bool has_dispersion() const { return has_dispersion_; }
  // Whether some are hidden from the camera.
  bool hides_surfaces() const { return hides_surfaces_; }
  // Of a surface where it is hit, without regard to the camera.
  accel::Opacity opacity_of(const Hit& hit) const { return surface_opacity().at(hit); }
  const Material& material_of(const Hit& hit) const { return materials_[primitives_.material(hit)]; }
  // Their boundaries stand behind the described materials.
  const NestedDielectrics& nested_dielectrics() const { return nested_dielectrics_; }
  const SceneIds& ids() const { return ids_; }
  // The index of the area light at the hit, or kNoLight.
  std::uint32_t light_of(const Hit& hit) const { return light_map_.light_of(hit); }
  // Calls what(area_light) with the light of this index, which light_of() returned, at the time of the hit.
  template <typename What>
  auto with_area_light(std::uint32_t light, float time, const What& what) const {
    const auto* still = std::get_if<lights::AreaLight>(&lights_[light]);
    return still ? what(*still) : what(std::get_if<lights::MovingAreaLight>(&lights_[light])->at(time));
  }
  // The index of the Environment that escaped rays see, or kNoLight.
  std::uint32_t environment_light() const { return environment_light_; }
  const lights::Environment& environment() const {
    return *std::get_if<lights::Environment>(&lights_[environment_light_]);
  }

 private:
  // What traversal is given: nothing if all is opaque.
  class TracedOpacity {
   public:
    explicit TracedOpacity(const Scene& scene)
        : of_hits_(scene.surface_opacity()), asked_(scene.has_opacities_) {}
    operator const accel::HitOpacity*() const { return asked_ ? &of_hits_ : nullptr; }

   private:
    SurfaceOpacity of_hits_;
    bool asked_;
  };
  SurfaceOpacity surface_opacity() const { return {primitives_, materials_, textures_, opacities_}; }
  // Marks the tree by the opacities of materials, which set_materials() has set.
  void mark_opacities(int threads);

  // Sets materials and media as they are described, with the media that materials add.
  void set_materials(std::vector<Material> materials, std::vector<MediumDescription> media);
  void drop_unused_attributes(SceneDescription& description) const;
  void add_shapes(SceneDescription& description);
  Camera moving_camera(float time) const;
  RayOf<FloatN> moving_camera_rays(Vec2Of<FloatN> raster, int width_px, int height_px, Vec2Of<FloatN> u_lens,
                                   FloatN time) const;
  // The environment at a pose: that of the present frame, which is moved from, if it has no keyframes.
  std::optional<lights::Light> environment_at(const Pose& pose);
  // Lets move at the present frame what moves while the shutter is open, and places what stands still
  // meanwhile, but not between the frame and that time. Sets the camera.
  void open_shutter();
  // All lights, for the present placements of instances.
  void find_lights(const std::vector<LightDescription>& lights, std::optional<lights::Light> environment);
  void add_group(const std::string& name) {
    if (!light_groups_.empty()) groups_of_lights_.push_back(index_of_group(light_groups_, name));
  }

  RenderSettings settings_;
  PoseMaker poses_;
  std::int32_t frame_ = 0;
  std::uint64_t revision_ = 0;
  FrameInterval shutter_;
  Camera camera_;
  bool camera_moves_ = false;
  Primitives primitives_;
  SceneIds ids_;
  AreaLightFinder::Quads quads_;
  accel::Bvh bvh_;
  std::vector<Texture> textures_;
  std::vector<Material> materials_;
  NestedDielectrics nested_dielectrics_;
  bool is_opaque_ = true, hides_surfaces_ = false, has_dispersion_ = false;
  std::vector<accel::MaterialOpacity> opacities_;  // of the materials
  bool has_opacities_ = false;                     // whether any of them is not opaque
  std::shared_ptr<const std::vector<VoxelGrid>> grids_;
  std::vector<Medium> media_;
  int camera_medium_ = kNoMedium;
  bool has_media_ = false;
  std::vector<lights::Light> lights_;
  std::vector<std::string> light_groups_;
  std::vector<std::uint32_t> groups_of_lights_;  // empty without groups
  LightMap light_map_;
  std::uint32_t environment_light_ = lights::kNoLight;
  std::string environment_group_;
};

}  // namespace tessera::core
