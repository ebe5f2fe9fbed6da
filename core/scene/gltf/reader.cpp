// SPDX-License-Identifier: Apache-2.0
// The front end for glTF 2.0 (core/scene/import/front_ends.hpp).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "core/base/printable.hpp"
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
#include "core/scene/import/keyed_transforms.hpp"
#include "core/scene/import/mesh_repair.hpp"
#include "core/scene/import/scene_builder.hpp"
#include "core/scene/import/selection.hpp"

namespace tessera::core {
namespace gltf {
namespace {

// Instances of all nodes together.
constexpr std::uint64_t kMaxInstances = std::uint64_t{1} << 22;

// The axes of a node of a camera, which looks along -z, as animate_camera() expects them.
Transform turned_around(const Transform& t) {
  return {t.x_axis * -1.0f, t.y_axis, t.z_axis * -1.0f, t.origin};
}

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

// Where a node shows its mesh: where it is itself, or where EXT_mesh_gpu_instancing places it.
struct Placements {
  const Node& node;
  std::optional<InstanceAttributes> attributes{};

  std::size_t count() const { return attributes ? attributes->count : 1; }
  Transform at(std::size_t i, std::size_t moment) const {
    const Transform& to_world = node.to_world[moment];
    return attributes ? compose(to_world, attributes->transform(i)) : to_world;
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
  FilePlace place_of(const Value& value) const { return {builder_.scene_path(), document_.line_of(value)}; }
  void add_mesh(const Node& node);
  void animate_camera(const Node& node);
  Placements placements_of(const Node& node);
  InstanceAttributes instance_attributes(const Value& list);
  void count_instances(const Node& node, std::uint64_t more);
  // One, or those at all moments if the node deforms the mesh.
  std::vector<MeshPose> poses_of(const Node& node, const Value& mesh);
  // In the space of the mesh, or of the world with joints or `to_world`, which else is null.
  void add_meshes(const Value& mesh, const std::vector<MeshPose>& poses, const std::string& name,
                  const Transform* to_world, std::optional<std::uint32_t> object);
  // nullopt if the mesh has no triangles.
  std::optional<std::uint32_t> add_object(const Value& mesh, const std::vector<MeshPose>& poses,
                                          const std::string& name);
  // The object of a mesh that several nodes show as it is.
  std::optional<std::uint32_t> shared_object(const Value& index);
  // An instance, which moves with its node.
  void place(std::uint32_t object, const Placements& placements, std::size_t i, const std::string& name);
  void rest_if_emissive(Part& part);
  void tell_other_uvs(const Value& primitive, const Materials::Use& use) const;
  // nullopt after a warning if the primitive cannot be read. A file that is missing, or too large, is refused
  // as a whole.
  std::optional<Part> read_part(const Value& primitive, std::uint32_t uv_set,
                                const std::vector<MeshPose>& poses);
  void add_part(Part part, const std::string& name, const Transform* to_world,
                std::optional<std::uint32_t> object);
  bool is_shared(const Node& node) const;
  std::vector<float> weights_of(const std::vector<float>& of_node, const Value& mesh) const;
  void set_image_size(float aspect_ratio);
  // The index of a primitive's material in the chosen variant (KHR_materials_variants); may be absent.
  Value material_index_of(const Value& primitive) const;
  void tell_variants() const;
  void check_replaced_parameters() const;

  const Document& document_;
  const Selection selection_{document_};
  SceneBuilder& builder_ = document_.builder();
  Buffers buffers_{document_};
  Accessors accessors_{document_, buffers_};
  Textures textures_{document_, buffers_};
  Materials materials_{document_, textures_};
  MeshReader meshes_{document_, buffers_, accessors_};
  const std::vector<float> moments_ = selection_.moments();
  std::vector<Node> nodes_;
  std::map<std::uint64_t, std::uint64_t> users_;                   // of each mesh, as it is
  std::map<std::uint64_t, std::optional<std::uint32_t>> objects_;  // of meshes
  std::set<std::string> broken_;                                   // paths of primitives
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
  check_replaced_parameters();
}

// A camera has its own name, or else that of its node.
void SceneReader::set_camera(const std::vector<std::uint32_t>& order) {
  builder_.scene().camera.shutter_close = selection_.shutter_seconds;
  std::vector<std::pair<Value, const Node*>> cameras;
  std::vector<std::string>& names = builder_.scene().contents.cameras;
  for (const std::uint32_t i : order) {
    const Value index = nodes_[i].value["camera"];
    if (!index.exists()) continue;
    cameras.emplace_back(document_.element("cameras", index), &nodes_[i]);
    const std::string name = cameras.back().first.text("name");
    names.push_back(printable(name.empty() ? nodes_[i].value.text("name") : name));
  }
  const std::size_t chosen = selected_camera(selection_, names);
  if (cameras.empty()) return;
  if (selection_.camera.empty() && cameras.size() > 1)
    document_.warn(cameras[1].first, "more cameras",
                   "the scene is seen by its first camera; another one can be chosen (--camera)");
  const auto& [camera, node] = cameras[chosen];
  try {
    PlacedCamera placed = read_camera(camera, node->to_world.front());
    placed.description.shutter_close = selection_.shutter_seconds;
    builder_.set_camera(placed.description);
    if (node->moves()) animate_camera(*node);
    if (placed.aspect_ratio > 0) set_image_size(placed.aspect_ratio);
  } catch (const Refusal& refusal) {
    document_.warn(camera, "broken camera",
                   fmt::format("a camera that sees the whole scene replaces it: {}", refusal.error.message));
  }
}

void SceneReader::animate_camera(const Node& node) {
  KeyedTransforms keys;
  for (std::size_t m = 0; m < moments_.size(); ++m)
    keys.push_back({moments_[m], turned_around(node.to_world[m])});
  SceneDescription& scene = builder_.scene();
  if (!core::animate_camera(keys, scene.camera, scene.animation.camera))
    document_.warn(node.value, "motion of cameras",
                   "a camera whose node is mirrored or flattened on its way does not move");
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
  if (index.whole() >= lights.size())
    return document_.warn(index, "no light", "there is no such light; it is left out");
  const Value light = lights.at(static_cast<std::size_t>(index.whole()));
  if (auto description = read_light(light, node.to_world.front(), document_))
    builder_.add_light(*std::move(description), place_of(light));
}

std::vector<float> SceneReader::weights_of(const std::vector<float>& of_node, const Value& mesh) const {
  if (!of_node.empty()) return of_node;
  std::vector<float> weights;
  const Value list = mesh["weights"];
  for (std::size_t i = 0; i < list.size(); ++i) weights.push_back(list.at(i).number());
  return weights;
}

// Whether the node shows its mesh as others do, so that all can be instances of one object.
bool SceneReader::is_shared(const Node& node) const {
  if (node.value["skin"].exists() || !node.weights.front().empty()) return false;
  return users_.at(node.value["mesh"].whole()) > 1 || node.moves() ||
         node.value.extension("EXT_mesh_gpu_instancing").exists();
}

std::vector<MeshPose> SceneReader::poses_of(const Node& node, const Value& mesh) {
  const Value skin = node.value["skin"];
  const std::size_t count = skin.exists() || node.changes_weights() ? moments_.size() : 1;
  std::vector<MeshPose> poses;
  for (std::size_t m = 0; m < count; ++m) {
    MeshPose pose{moments_[m], weights_of(node.weights[m], mesh), std::nullopt};
    if (skin.exists())
      pose.joints = read_skin(document_.element("skins", skin), document_, accessors_, nodes_, m);
    poses.push_back(std::move(pose));
  }
  return poses;
}

// A node that moves shows an instance of an object, of which only the placement changes.
void SceneReader::add_mesh(const Node& node) {
  const Value index = node.value["mesh"];
  if (!index.exists()) return;
  const Value mesh = document_.element("meshes", index);
  const std::string name = name_of(node.value);
  if (node.value["skin"].exists()) return add_meshes(mesh, poses_of(node, mesh), name, nullptr, std::nullopt);
  const bool shared = is_shared(node);
  const Placements placements = placements_of(node);
  for (std::size_t i = 0; i < placements.count(); ++i) {
    const Transform to_world = placements.at(i, 0);
    if (!(shared || node.moves()) || !Placement::can_place(to_world)) {
      add_meshes(mesh, poses_of(node, mesh), name, &to_world, std::nullopt);
    } else if (const auto object =
                   shared ? shared_object(index) : add_object(mesh, poses_of(node, mesh), name)) {
      place(*object, placements, i, name);
    }
  }
}

void SceneReader::place(std::uint32_t object, const Placements& placements, std::size_t i,
                        const std::string& name) {
  if (!builder_.add_instance(object, placements.at(i, 0), name, place_of(placements.node.value))) return;
  if (!placements.node.moves()) return;
  KeyedTransforms keys;
  for (std::size_t m = 0; m < moments_.size(); ++m) keys.push_back({moments_[m], placements.at(i, m)});
  auto motion = motion_through(keys);
  if (!motion || !motion->is_exact)
    document_.warn(placements.node.value, "motion of nodes",
                   motion ? "a node that is stretched obliquely while it moves keeps the stretch of its start"
                          : "a node that is mirrored or flattened on its way does not move");
  if (!motion) return;
  SceneDescription& scene = builder_.scene();
  std::get<InstanceDescription>(scene.shapes.back()).to_world = transform_at(motion->steps, 0);
  scene.animation.instances.push_back(
      {static_cast<std::uint32_t>(scene.shapes.size()) - 1, std::move(motion->steps)});
}

Placements SceneReader::placements_of(const Node& node) {
  const Value extension = node.value.extension("EXT_mesh_gpu_instancing");
  Placements placements{node};
  if (extension.exists()) placements.attributes = instance_attributes(extension["attributes"]);
  count_instances(node, placements.count());
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

std::optional<std::uint32_t> SceneReader::shared_object(const Value& index) {
  const Value mesh = document_.element("meshes", index);
  const std::uint64_t key = index.whole();
  const auto known = objects_.find(key);
  if (known != objects_.end()) return known->second;
  return objects_[key] = add_object(mesh, {{0, weights_of({}, mesh), std::nullopt}}, name_of(mesh));
}

std::optional<std::uint32_t> SceneReader::add_object(const Value& mesh, const std::vector<MeshPose>& poses,
                                                     const std::string& name) {
  const std::uint32_t object = builder_.add_object(name);
  add_meshes(mesh, poses, name, nullptr, object);
  const bool is_empty = builder_.scene().objects[object].shapes.empty();
  return is_empty ? std::nullopt : std::optional(object);
}

void SceneReader::add_meshes(const Value& mesh, const std::vector<MeshPose>& poses, const std::string& name,
                             const Transform* to_world, std::optional<std::uint32_t> object) {
  const Value primitives = mesh["primitives"];
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const Value primitive = primitives.at(i);
    const Materials::Use use = materials_.use(material_index_of(primitive));
    auto part = read_part(primitive, use.uv_set, poses);
    if (!part) continue;
    tell_other_uvs(primitive, use);
    part->mesh.triangle_materials = {use.material};
    rest_if_emissive(*part);
    add_part(std::move(*part), name, to_world, object);
  }
}

std::optional<Part> SceneReader::read_part(const Value& primitive, std::uint32_t uv_set,
                                           const std::vector<MeshPose>& poses) {
  if (broken_.contains(primitive.path())) return std::nullopt;
  try {
    return meshes_.read(primitive, uv_set, poses);
  } catch (const Refusal& refusal) {
    if (refusal.error.code != ErrorCode::kInvalidArgument) throw;
    broken_.insert(primitive.path());
    document_.warn(primitive, "broken primitive",
                   fmt::format("it cannot be read and is left out: {}", refusal.error.message));
    return std::nullopt;
  }
}

// Exporters write one accessor under several names.
void SceneReader::tell_other_uvs(const Value& primitive, const Materials::Use& use) const {
  const auto accessor_of = [&](std::uint32_t set) {
    const Value index = primitive["attributes"][fmt::format("TEXCOORD_{}", set)];
    return index.exists() ? std::optional(index.whole()) : std::nullopt;
  };
  for (const Value& info : use.other_uvs)
    if (accessor_of(Textures::uv_set(info)) != accessor_of(use.uv_set))
      document_.warn(
          info, "second uv",
          fmt::format("a material has one set of texture coordinates; TEXCOORD_{} is used for this "
                      "texture, too",
                      use.uv_set));
}

void SceneReader::rest_if_emissive(Part& part) {
  const Material& material = builder_.material(part.mesh.triangle_materials.front());
  if (part.mesh.steps.empty() || is_black(material.emission.value)) return;
  part.mesh.steps = {};
  document_.warn(part.primitive, "emission of deforming meshes",
                 "a mesh that emits light does not deform: it stays as it is when the shutter opens");
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

// The paths stand in the extension that with_overrides() writes, one a line.
void SceneReader::check_replaced_parameters() const {
  std::istringstream paths(document_.root().extension(kGltfSelection).text(kReplacedParameters));
  for (std::string path; std::getline(paths, path);) {
    if (document_.root().at_path(path).is_used()) continue;
    const std::string owner = path.substr(0, std::min(path.rfind('.'), path.size()));
    const bool is_of_root = owner == path;
    std::vector<std::string> used;
    for (const std::string_view key : document_.root().at_path(is_of_root ? "" : owner).used_keys())
      used.push_back(is_of_root ? std::string(key) : fmt::format("{}.{}", owner, key));
    throw Refusal{0, unused_parameter(path, {used.begin(), used.end()}), false};
  }
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
