// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "core/base/printable.hpp"
#include "core/scene/import/emission_only.hpp"
#include "core/scene/import/front_ends.hpp"
#include "core/scene/import/scene_bounds.hpp"
#include "core/scene/import/scene_builder.hpp"
#include "core/scene/import/selection.hpp"
#include "core/scene/mitsuba/emitters.hpp"
#include "core/scene/mitsuba/materials.hpp"
#include "core/scene/mitsuba/media.hpp"
#include "core/scene/mitsuba/plugin.hpp"
#include "core/scene/mitsuba/sensor.hpp"
#include "core/scene/mitsuba/shapes.hpp"
#include "core/scene/mitsuba/textures.hpp"
#include "core/scene/mitsuba/xml_reader.hpp"

namespace tessera::core {
namespace mitsuba {
namespace {

void set_chosen_sensor(Conversion& conversion, MediumConverter& media, const Plugin& scene) {
  const std::vector<Plugin> sensors = scene.children(Kind::kSensor);
  std::vector<std::string>& names = conversion.builder.scene().contents.cameras;
  for (const Plugin& sensor : sensors) names.push_back(printable(sensor.name()));
  const std::string& wanted = conversion.graph.camera;
  const auto chosen = wanted.empty() ? Result<std::size_t>(0) : find_selected(kSelectCamera, wanted, names);
  if (!chosen) return conversion.check(fail(chosen.error()));
  if (sensors.empty()) return;
  set_sensor(conversion, sensors[*chosen]);
  conversion.builder.scene().camera_medium = media.medium_around(sensors[*chosen]);
  if (wanted.empty() && sensors.size() > 1)
    scene.warn("has several sensors; the first one is used, and another one can be chosen (--camera)");
}

// Planes in front of the camera that cut nothing are common, as are near ones amid a room.
void warn_of_clipping(const Conversion& conversion, const Plugin& scene) {
  if (!conversion.builder.has_camera()) return;
  constexpr float kNear = 0.01f;  // of the depth of the scene
  const auto& camera = conversion.builder.scene().camera;
  const Aabb bounds = scene_bounds(conversion.builder.scene());
  const Vec3 direction = normalize(camera.look_at - camera.position);
  float nearest = std::numeric_limits<float>::infinity(), farthest = -nearest;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p{(corner & 1) != 0 ? bounds.upper.x : bounds.lower.x,
                 (corner & 2) != 0 ? bounds.upper.y : bounds.lower.y,
                 (corner & 4) != 0 ? bounds.upper.z : bounds.lower.z};
    const float depth = dot(p - camera.position, direction);
    nearest = std::min(nearest, depth), farthest = std::max(farthest, depth);
  }
  if ((nearest < conversion.near_clip && conversion.near_clip >= kNear * farthest) ||
      farthest > conversion.far_clip)
    scene.warn("what lies in front of 'near_clip' or beyond 'far_clip' is seen");
}

std::set<NodeId> children_of_shapes(const SceneGraph& graph) {
  std::set<NodeId> found;
  for (const Node& node : graph.nodes) {
    if (node.kind != Kind::kShape) continue;
    for (const Property& property : node.properties)
      if (const auto* child = std::get_if<Child>(&property.value)) found.insert(child->node);
  }
  return found;
}

void convert_scene(Conversion& conversion) {
  const Plugin scene(conversion, 0);
  for (const Plugin& integrator : scene.children(Kind::kIntegrator)) set_integrator(conversion, integrator);
  MediumConverter media(conversion);
  set_chosen_sensor(conversion, media, scene);
  TextureConverter textures(conversion);
  MaterialConverter materials(conversion, textures);
  ShapeConverter shapes(conversion, materials, media);
  EmitterConverter emitters(conversion, textures);
  const std::set<NodeId> of_shapes = children_of_shapes(conversion.graph);
  for (const Plugin& emitter : scene.children(Kind::kEmitter))
    if (!of_shapes.contains(emitter.id())) emitters.add(emitter);
  for (const Plugin& shape : scene.children(Kind::kShape)) {
    if (!conversion.status) return;
    shapes.add(shape);
  }
  warn_of_clipping(conversion, scene);
  if (conversion.emission_only && !show_emission_only(conversion.builder.scene()))
    scene.warn(
        "has media whose scattering has a grid of its own, which does not weaken light at 'max_depth' 1");
  // Those that shapes refer to.
  for (const Kind kind : {Kind::kBsdf, Kind::kTexture, Kind::kMedium, Kind::kVolume, Kind::kPhase})
    scene.ignore(kind);
}

}  // namespace
}  // namespace mitsuba

Result<SceneDescription> read_mitsuba_scene(AssetSource& assets, const std::string& scene_path,
                                            const std::string& display_path, const SceneLimits& limits) {
  SceneBuilder builder(assets, scene_path, display_path, limits);
  auto graph = mitsuba::read_scene_graph(builder);
  if (!graph) return fail(graph.error());
  mitsuba::Conversion conversion{builder, *graph};
  mitsuba::convert_scene(conversion);
  if (!conversion.status) return fail(conversion.status.error().within(display_path));
  mitsuba::warn_of_unused(conversion);
  return builder.finish({.camera = true, .studio_light = false});
}

}  // namespace tessera::core
