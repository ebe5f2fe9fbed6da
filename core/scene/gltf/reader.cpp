// SPDX-License-Identifier: Apache-2.0
// The front end for glTF 2.0 (core/scene/import/front_ends.hpp).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/geometry/placement.hpp"
#include "core/scene/gltf/accessor.hpp"
#include "core/scene/gltf/buffers.hpp"
#include "core/scene/gltf/document.hpp"
#include "core/scene/gltf/materials.hpp"
#include "core/scene/gltf/mesh.hpp"
#include "core/scene/gltf/nodes.hpp"
#include "core/scene/gltf/placements.hpp"
#include "core/scene/gltf/selection.hpp"
#include "core/scene/gltf/textures.hpp"
#include "core/scene/import/front_ends.hpp"
#include "core/scene/import/mesh_repair.hpp"
#include "core/scene/import/scene_builder.hpp"

namespace tessera::core {
namespace gltf {
namespace {

// Instances of all nodes together.
constexpr std::uint64_t kMaxInstances = std::uint64_t{1} << 22;

// The attributes of EXT_mesh_gpu_instancing.
struct InstanceAttributes {
  std::optional<Accessor> translation, rotation, scale;
  std::size_t count = 0;

  Transform transform(std::size_t i) const {
    std::vector<float> quaternion{0, 0, 0, 1};
    for (std::size_t c = 0; rotation && c < 4; ++c) quaternion[c] = rotation->number(i, c);
    return placed(translation ? translation->vec3(i) : Vec3{0, 0, 0}, quaternion,
                  scale ? scale->vec3(i) : Vec3{1, 1, 1});
  }
};

// Adds what the nodes of the chosen scene hold.
class SceneReader {
 public:
  explicit SceneReader(const Document& document) : document_(document) {}

  void read();

 private:
  void set_camera(const std::vector<std::uint32_t>& order);
  void add_light(const Node& node);
  void add_mesh(const Node& node);
  // Where EXT_mesh_gpu_instancing places a node's mesh, or the node's own placement.
  std::vector<Transform> placements_of(const Node& node);
  InstanceAttributes instance_attributes(const Value& list);
  void count_instances(const Node& node, std::uint64_t more);
  // In the space of the mesh, or of the world with `joints` or `to_world`, which else are null.
  void add_meshes(const Value& mesh, const std::vector<float>& weights, const JointMaps* joints,
                  const std::string& name, const Transform* to_world, std::optional<std::uint32_t> object);
  // The object of a mesh that several nodes show as it is; nullopt if it has no triangles.
  std::optional<std::uint32_t> object_of(const Value& index);
  void add_part(Part part, const std::string& name, const Transform* to_world,
                std::optional<std::uint32_t> object);
  bool is_shared(const Node& node) const;
  std::vector<float> weights_of(const Node& node, const Value& mesh) const;
  void set_image_size(float aspect_ratio);
  // The index of a primitive's material in the chosen variant (KHR_materials_variants); may be absent.
  Value material_index_of(const Value& primitive) const;
  void tell_variants() const;

  const Document& document_;
  const Selection selection_{document_};
  SceneBuilder& builder_ = document_.builder();
  Buffers buffers_{document_};
  Accessors accessors_{document_, buffers_};
  Textures textures_{document_, buffers_};
  Materials materials_{document_, textures_};
  MeshReader meshes_{document_, buffers_, accessors_};
  std::vector<Node> nodes_;
  std::map<std::uint64_t, std::uint64_t> users_;                   // of each mesh, as it is
  std::map<std::uint64_t, std::optional<std::uint32_t>> objects_;  // of meshes
  std::uint64_t instances_ = 0;
};

void SceneReader::read() {
  nodes_ = read_nodes(document_, accessors_, selection_);
  const auto order = nodes_of_scene(document_, nodes_, selection_);
  for (const std::uint32_t i : order)
    if (nodes_[i].value["mesh"].exists()) ++users_[nodes_[i].value["mesh"].whole()];
  set_camera(order);
  for (const std::uint32_t i : order) {
    add_light(nodes_[i]);
    add_mesh(nodes_[i]);
  }
  tell_variants();
}

// A camera has its own name, or else that of its node.
void SceneReader::set_camera(const std::vector<std::uint32_t>& order) {
  std::vector<std::pair<Value, Transform>> cameras;
  std::vector<std::string>& names = builder_.scene().contents.cameras;
  for (const std::uint32_t i : order) {
    const Value index = nodes_[i].value["camera"];
    if (!index.exists()) continue;
    cameras.emplace_back(document_.element("cameras", index), nodes_[i].to_world);
    const std::string name = cameras.back().first.text("name");
    names.push_back(printable(name.empty() ? nodes_[i].value.text("name") : name));
  }
  const std::size_t chosen = selected_camera(selection_, names);
  if (cameras.empty()) return;
  if (selection_.camera.empty() && cameras.size() > 1)
    document_.warn(cameras[1].first, "more cameras",
                   "the scene is seen by its first camera; another one can be chosen (--camera)");
  const PlacedCamera placed = read_camera(cameras[chosen].first, cameras[chosen].second);
  builder_.set_camera(placed.description);
  if (placed.aspect_ratio > 0) set_image_size(placed.aspect_ratio);
}

// Keeps the height.
void SceneReader::set_image_size(float aspect_ratio) {
  RenderSettings& settings = builder_.scene().settings;
  constexpr float kMaxRatio = 16;
  const float ratio = std::clamp(aspect_ratio, 1 / kMaxRatio, kMaxRatio);
  settings.width_px = static_cast<int>(std::lround(ratio * static_cast<float>(settings.height_px)));
}

void SceneReader::add_light(const Node& node) {
  const Value index = node.value.extension("KHR_lights_punctual")["light"];
  if (!index.exists()) return;
  const Value lights = document_.root().extension("KHR_lights_punctual")["lights"];
  if (index.whole() >= lights.size()) index.refuse("there is no such light");
  builder_.add_light(
      read_light(lights.at(static_cast<std::size_t>(index.whole())), node.to_world, document_));
}

std::vector<float> SceneReader::weights_of(const Node& node, const Value& mesh) const {
  if (!node.weights.empty()) return node.weights;
  std::vector<float> weights;
  const Value list = mesh["weights"];
  for (std::size_t i = 0; i < list.size(); ++i) weights.push_back(list.at(i).number());
  return weights;
}

// Whether the node shows its mesh as others do, so that all can be instances of one object.
bool SceneReader::is_shared(const Node& node) const {
  if (node.value["skin"].exists() || !node.weights.empty()) return false;
  return users_.at(node.value["mesh"].whole()) > 1 ||
         node.value.extension("EXT_mesh_gpu_instancing").exists();
}

void SceneReader::add_mesh(const Node& node) {
  const Value index = node.value["mesh"];
  if (!index.exists()) return;
  const Value mesh = document_.element("meshes", index);
  const std::string name = name_of(node.value);
  const Value skin = node.value["skin"];
  if (skin.exists()) {
    const JointMaps joints = read_skin(document_.element("skins", skin), document_, accessors_, nodes_);
    return add_meshes(mesh, weights_of(node, mesh), &joints, name, nullptr, std::nullopt);
  }
  const bool shared = is_shared(node);
  for (const Transform& to_world : placements_of(node)) {
    if (!shared || !Placement::can_place(to_world)) {
      add_meshes(mesh, weights_of(node, mesh), nullptr, name, &to_world, std::nullopt);
    } else if (const auto object = object_of(index)) {
      builder_.add_instance(*object, to_world, name);
    }
  }
}

std::vector<Transform> SceneReader::placements_of(const Node& node) {
  const Value extension = node.value.extension("EXT_mesh_gpu_instancing");
  if (!extension.exists()) {
    count_instances(node, 1);
    return {node.to_world};
  }
  const InstanceAttributes attributes = instance_attributes(extension["attributes"]);
  count_instances(node, attributes.count);
  std::vector<Transform> placements;
  for (std::size_t i = 0; i < attributes.count; ++i)
    placements.push_back(compose(node.to_world, attributes.transform(i)));
  return placements;
}

InstanceAttributes SceneReader::instance_attributes(const Value& list) {
  InstanceAttributes attributes;
  bool is_first = true;
  const auto read = [&](std::string_view name, std::size_t components, std::optional<Accessor>& values) {
    if (!list[name].exists()) return;
    values = accessors_.read(list[name], components);
    if (!is_first && values->count() != attributes.count)
      list[name].refuse("has another count than the other attributes");
    attributes.count = values->count();
    is_first = false;
  };
  read("TRANSLATION", 3, attributes.translation);
  read("ROTATION", 4, attributes.rotation);
  read("SCALE", 3, attributes.scale);
  return attributes;
}

void SceneReader::count_instances(const Node& node, std::uint64_t more) {
  instances_ += more;
  if (instances_ > kMaxInstances)
    node.value.refuse(fmt::format("the scene has more than {} instances", kMaxInstances),
                      ErrorCode::kResourceExhausted);
}

std::optional<std::uint32_t> SceneReader::object_of(const Value& index) {
  const Value mesh = document_.element("meshes", index);
  const std::uint64_t key = index.whole();
  const auto known = objects_.find(key);
  if (known != objects_.end()) return known->second;
  const std::uint32_t object = builder_.add_object(name_of(mesh));
  add_meshes(mesh, weights_of(Node{}, mesh), nullptr, name_of(mesh), nullptr, object);
  const bool is_empty = builder_.scene().objects[object].shapes.empty();
  return objects_[key] = is_empty ? std::nullopt : std::optional(object);
}

void SceneReader::add_meshes(const Value& mesh, const std::vector<float>& weights, const JointMaps* joints,
                             const std::string& name, const Transform* to_world,
                             std::optional<std::uint32_t> object) {
  const Value primitives = mesh["primitives"];
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const Value primitive = primitives.at(i);
    const Materials::Use use = materials_.use(material_index_of(primitive));
    auto part = meshes_.read(primitive, use.uv_set, weights, joints);
    if (!part) continue;
    part->mesh.triangle_materials = {use.material};
    add_part(std::move(*part), name, to_world, object);
  }
}

void SceneReader::add_part(Part part, const std::string& name, const Transform* to_world,
                           std::optional<std::uint32_t> object) {
  const Value material = material_index_of(part.primitive);
  if (part.has_transparent_colors && material.exists() &&
      is_transparent(document_.element("materials", material)))
    document_.warn(part.primitive, "alpha of colours", "the alpha of vertex colours is ignored");
  if (!part.mesh.colors.empty() && material.exists() && is_unlit(document_.element("materials", material)))
    document_.warn(part.primitive, "colours of unlit",
                   "vertex colours of an unlit surface are ignored: they change no emission");
  if (to_world != nullptr) transform_mesh(part.mesh, *to_world);
  const auto added = builder_.add_mesh(std::move(part.mesh), name, object, builder_.scene_path(),
                                       document_.line_of(part.primitive));
  if (!added) part.primitive.refuse(added.error().message, added.error().code);
}

Value SceneReader::material_index_of(const Value& primitive) const {
  const Value mappings = primitive.extension("KHR_materials_variants")["mappings"];
  for (std::size_t i = 0; selection_.variant && i < mappings.size(); ++i) {
    const Value variants = mappings.at(i)["variants"];
    for (std::size_t k = 0; k < variants.size(); ++k)
      if (variants.at(k).whole() == *selection_.variant) return mappings.at(i)["material"];
  }
  return primitive["material"];
}

void SceneReader::tell_variants() const {
  if (selection_.variant) return;
  const Value variants = document_.root().extension("KHR_materials_variants")["variants"];
  if (variants.size() > 0)
    document_.warn(variants, "variants",
                   fmt::format("has {} variants of materials; the materials without variant are used; one "
                               "can be chosen (--variant)",
                               variants.size()));
}

Result<SceneDescription> read_scene(SceneBuilder& builder) {
  auto bytes = builder.read(builder.scene_path());
  const std::string shown = builder.shown(builder.scene_path());
  if (!bytes) return fail(bytes.error().within(shown));
  const bool has_lines = !bytes->starts_with("glTF");
  try {
    const Document document(std::move(*bytes), builder);
    SceneReader(document).read();
  } catch (const Refusal& refusal) {
    if (refusal.names_file) return fail(refusal.error);
    return fail(refusal.error.within(has_lines && refusal.line > 0 ? fmt::format("{}:{}", shown, refusal.line)
                                                                   : shown));
  }
  return builder.finish({});
}

}  // namespace
}  // namespace gltf

Result<SceneDescription> read_gltf_scene(AssetSource& assets, const std::string& scene_path,
                                         const std::string& display_path, const SceneLimits& limits) {
  SceneBuilder builder(assets, scene_path, display_path, limits);
  return gltf::read_scene(builder);
}

}  // namespace tessera::core
