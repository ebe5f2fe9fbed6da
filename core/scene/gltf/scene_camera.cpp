// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/scene_camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <utility>

#include "core/base/printable.hpp"
#include "core/scene/gltf/placements.hpp"
#include "core/scene/import/keyed_transforms.hpp"

namespace tessera::core::gltf {
namespace {

// The axes of a node of a camera, which looks along -z, as animate_camera() expects them.
Transform turned_around(const Transform& t) {
  return {t.x_axis * -1.0f, t.y_axis, t.z_axis * -1.0f, t.origin};
}

void animate(const Node& node, const std::vector<float>& moments, const Document& document) {
  KeyedTransforms keys;
  for (std::size_t m = 0; m < moments.size(); ++m)
    keys.push_back({moments[m], turned_around(node.to_world[m])});
  SceneDescription& scene = document.builder().scene();
  if (!core::animate_camera(keys, scene.camera, scene.animation.camera))
    document.warn(node.value, "motion of cameras",
                  "a camera whose node is mirrored or flattened on its way does not move");
}

// Keeps the height.
void set_image_size(float aspect_ratio, RenderSettings& settings) {
  constexpr float kMaxRatio = 16;
  const float ratio = std::clamp(aspect_ratio, 1 / kMaxRatio, kMaxRatio);
  settings.width_px = static_cast<int>(std::lround(ratio * static_cast<float>(settings.height_px)));
}

void tell_stretching(const Document& document, const Node& node) {
  const Transform& t = node.to_world.front();
  const Vec3 scales = t.scales();
  constexpr float kVisible = 1e-3f;
  const float largest = std::max({scales.x, scales.y, scales.z}),
              smallest = std::min({scales.x, scales.y, scales.z});
  const auto lean = [](Vec3 a, Vec3 b) { return std::fabs(dot(a, b)) / (length(a) * length(b)); };
  const bool leans = lean(t.x_axis, t.y_axis) > kVisible || lean(t.y_axis, t.z_axis) > kVisible ||
                     lean(t.z_axis, t.x_axis) > kVisible;
  if (leans || largest - smallest > kVisible * largest)
    document.warn(node.value, "stretched camera",
                  "its camera is turned, moved and mirrored, but not stretched or sheared with the node");
}

void tell_unused_cameras(const Document& document, const std::vector<Node>& nodes) {
  std::set<std::uint64_t> used;
  for (const Node& node : nodes)
    if (const auto index = node.value["camera"].as_whole()) used.insert(*index);
  const Value cameras = document.root()["cameras"];
  for (std::size_t i = 0; i < cameras.size(); ++i)
    if (!used.contains(i))
      document.warn(cameras.at(i), "unused cameras", "the camera is left out: no node uses it");
}

}  // namespace

// A camera has its own name, or else that of its node.
void set_camera(const Document& document, const Selection& selection, const std::vector<Node>& nodes,
                const std::vector<std::uint32_t>& order) {
  SceneDescription& scene = document.builder().scene();
  scene.camera.shutter_close = selection.shutter_seconds;
  std::vector<std::pair<Value, const Node*>> cameras;
  std::vector<std::string>& names = scene.contents.cameras;
  for (const std::uint32_t i : order) {
    const Value index = nodes[i].value["camera"];
    if (!index.exists()) continue;
    const Value camera = document.element_or_none("cameras", index, "it is left out");
    if (!camera.exists()) continue;
    cameras.emplace_back(camera, &nodes[i]);
    const std::string name = camera.text("name");
    names.push_back(printable(name.empty() ? nodes[i].value.text("name") : name));
  }
  tell_unused_cameras(document, nodes);
  const std::size_t chosen = selected_camera(selection, names);
  if (cameras.empty()) return;
  if (selection.camera.empty() && cameras.size() > 1)
    document.warn(cameras[1].first, "more cameras",
                  "the scene is seen by its first camera; another one can be chosen (--camera)");
  const Value camera = cameras[chosen].first;
  const Node& node = *cameras[chosen].second;
  document.try_to(camera, "broken camera", "a camera that sees the whole scene replaces it", [&] {
    PlacedCamera placed = read_camera(camera, node.to_world.front());
    placed.description.shutter_close = selection.shutter_seconds;
    document.builder().set_camera(placed.description);
    tell_stretching(document, node);
    if (node.moves()) animate(node, selection.moments(), document);
    if (placed.aspect_ratio > 0) set_image_size(placed.aspect_ratio, scene.settings);
  });
}

}  // namespace tessera::core::gltf
