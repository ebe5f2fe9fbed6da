// SPDX-License-Identifier: Apache-2.0
// The front end for glTF 2.0 (core/scene/import/front_ends.hpp).
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "core/base/printable.hpp"
#include "core/geometry/placement.hpp"
#include "core/scene/gltf/accessor.hpp"
#include "core/scene/gltf/animated_values.hpp"
#include "core/scene/gltf/buffers.hpp"
#include "core/scene/gltf/document.hpp"
#include "core/scene/gltf/ignored_attributes.hpp"
#include "core/scene/gltf/instances.hpp"
#include "core/scene/gltf/materials.hpp"
#include "core/scene/gltf/mesh.hpp"
#include "core/scene/gltf/node_mistakes.hpp"
#include "core/scene/gltf/nodes.hpp"
#include "core/scene/gltf/placements.hpp"
#include "core/scene/gltf/scene_camera.hpp"
#include "core/scene/gltf/selection.hpp"
#include "core/scene/gltf/textures.hpp"
#include "core/scene/gltf/vertex_tints.hpp"
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

// Adds what the nodes of the chosen scene hold.
class SceneReader {
 public:
  explicit SceneReader(const Document& document) : document_(document) {}

  void read();

 private:
  // Those of a mesh, or of a node that shows it.
  void tell_weights(const Value& owner, const Value& mesh) const;
  void add_light(const Node& node);
  FilePlace place_of(const Value& value) const { return {builder_.scene_path(), document_.line_of(value)}; }
  // The mesh of a node, which `index` names.
  void add_mesh(const Node& node, const Value& mesh);
  // The node's skin at all moments; empty if it has none, or after a warning a broken one.
  std::vector<JointMaps> joints_of(const Node& node);
  void count_instances(const Node& node, std::uint64_t more);
  // One, or those at all moments if the node or its joints deform the mesh.
  std::vector<MeshPose> poses_of(const Node& node, const Value& mesh, const std::vector<JointMaps>& joints);
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
  void tint_triangles(Part& part, const Materials::Use& use);
  void rest_if_emissive(Part& part);
  void tell_other_uvs(const Value& primitive, const Textures::Coordinates& coordinates) const;
  // nullopt after a warning if the primitive cannot be read.
  std::optional<Part> read_part(const Value& primitive, const UsedAttributes& used,
                                const std::vector<MeshPose>& poses);
  void add_part(Part part, const std::string& name, const Transform* to_world,
                std::optional<std::uint32_t> object);
  bool is_shared(const Node& node) const;
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
  std::vector<Value> meshes;  // of the nodes
  for (const std::uint32_t i : order) {
    const Value index = nodes_[i].value["mesh"];
    meshes.push_back(index.exists() ? document_.element_or_none("meshes", index, "the node shows no mesh")
                                    : Value());
    if (!meshes.back().exists()) continue;
    if (++users_[index.whole()] == 1) tell_weights(meshes.back(), meshes.back());
    tell_weights(nodes_[i].value, meshes.back());
  }
  set_camera(document_, selection_, nodes_, order);
  for (std::size_t i = 0; i < order.size(); ++i) {
    add_light(nodes_[order[i]]);
    if (meshes[i].exists()) add_mesh(nodes_[order[i]], meshes[i]);
  }
  tell_variants();
  check_replaced_parameters();
}

void SceneReader::tell_weights(const Value& owner, const Value& mesh) const {
  const Value weights = owner["weights"];
  if (weights.size() > 0) tell_odd_weights(document_, weights, weights.size(), mesh);
}

void SceneReader::add_light(const Node& node) {
  const Value index = node.value.extension("KHR_lights_punctual")["light"];
  if (!index.exists()) return;
  const Value lights = document_.root().extension("KHR_lights_punctual")["lights"];
  const Value light = document_.element_or_none(lights, index, "it is left out");
  if (!light.exists()) return;
  if (auto description = read_light(light, node.to_world.front(), document_))
    builder_.add_light(*std::move(description), place_of(light));
}

// Whether the node shows its mesh as others do, so that all can be instances of one object.
bool SceneReader::is_shared(const Node& node) const {
  if (!node.weights.front().empty()) return false;
  return users_.at(node.value["mesh"].whole()) > 1 || node.moves() ||
         node.value.extension("EXT_mesh_gpu_instancing").exists();
}

std::vector<JointMaps> SceneReader::joints_of(const Node& node) {
  std::vector<JointMaps> joints;
  const Value skin = node.value["skin"];
  if (skin.exists() && !document_.try_to(skin, "skin", "the mesh is shown without it", [&] {
        for (std::size_t m = 0; m < moments_.size(); ++m)
          joints.push_back(read_skin(document_.element("skins", skin), document_, accessors_, nodes_, m));
      }))
    joints.clear();
  return joints;
}

std::vector<MeshPose> SceneReader::poses_of(const Node& node, const Value& mesh,
                                            const std::vector<JointMaps>& joints) {
  const std::size_t count = !joints.empty() || node.changes_weights() ? moments_.size() : 1;
  std::vector<MeshPose> poses;
  for (std::size_t m = 0; m < count; ++m) {
    poses.push_back({moments_[m], node.weights[m].empty() ? mesh.numbers("weights") : node.weights[m], {}});
    if (!joints.empty()) poses.back().joints = joints[m];
  }
  return poses;
}

// A node that moves shows an instance of an object, of which only the placement changes.
void SceneReader::add_mesh(const Node& node, const Value& mesh) {
  const std::string name = name_of(node.value);
  const std::vector<JointMaps> joints = joints_of(node);
  if (!joints.empty()) {
    if (const Value instances = node.value.extension("EXT_mesh_gpu_instancing"); instances.exists())
      document_.warn(instances, "instances of skins", "a mesh with a skin is shown once, without instances");
    return add_meshes(mesh, poses_of(node, mesh, joints), name, nullptr, std::nullopt);
  }
  const bool shared = is_shared(node);
  const Placements placements = placements_of(node, document_, accessors_);
  count_instances(node, placements.count());
  for (std::size_t i = 0; i < placements.count(); ++i) {
    const Transform to_world = placements.at(i, 0);
    if (!(shared || node.moves()) || !Placement::can_place(to_world)) {
      add_meshes(mesh, poses_of(node, mesh, {}), name, &to_world, std::nullopt);
    } else if (const auto object = shared ? shared_object(node.value["mesh"])
                                          : add_object(mesh, poses_of(node, mesh, {}), name)) {
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
  return objects_[key] = add_object(mesh, {{0, mesh.numbers("weights"), std::nullopt}}, name_of(mesh));
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
    auto part = read_part(primitive, {use.coordinates.sets, follows_tangents(use.value)}, poses);
    if (!part) continue;
    tell_other_uvs(primitive, use.coordinates);
    part->mesh.triangle_materials = {use.material};
    tint_triangles(*part, use);
    rest_if_emissive(*part);
    add_part(std::move(*part), name, to_world, object);
  }
}

std::optional<Part> SceneReader::read_part(const Value& primitive, const UsedAttributes& used,
                                           const std::vector<MeshPose>& poses) {
  if (broken_.contains(primitive.path())) return std::nullopt;
  std::optional<Part> part;
  if (!document_.try_to(primitive, "broken primitive", "it cannot be read and is left out",
                        [&] { part = meshes_.read(primitive, used, poses); }))
    broken_.insert(primitive.path());
  return part;
}

// Exporters write one accessor under several names.
void SceneReader::tell_other_uvs(const Value& primitive, const Textures::Coordinates& coordinates) const {
  const std::uint32_t first = coordinates.sets.empty() ? 0 : coordinates.sets[0];
  const auto accessor_of = [&](std::uint32_t set) {
    return primitive["attributes"][fmt::format("TEXCOORD_{}", set)].as_whole();
  };
  for (const Value& info : coordinates.others) {
    const auto accessor = accessor_of(textures_.set_of(info));
    if (accessor && accessor == accessor_of(first)) continue;
    document_.warn(info, "third uv",
                   fmt::format("the textures of a material have two sets of texture coordinates at most; "
                               "TEXCOORD_{} is used for this one, too",
                               first));
  }
}

void SceneReader::rest_if_emissive(Part& part) {
  const auto emits = [this](std::uint32_t material) {
    return !is_black(builder_.material(material).emission.value);
  };
  if (part.mesh.steps.empty() || std::ranges::none_of(part.mesh.triangle_materials, emits)) return;
  part.mesh.steps = {};
  document_.warn(part.primitive, "emission of deforming meshes",
                 "a mesh that emits light does not deform: it stays as it is when the shutter opens");
}

// Gives triangles materials of their own where vertex colours change more than the base colour.
void SceneReader::tint_triangles(Part& part, const Materials::Use& use) {
  tell_ignored_attributes(document_, part.primitive, use.value, use.coordinate_names);
  std::vector<Rgb> colors;
  if (use.unlit)
    colors = std::exchange(part.mesh.colors, {});
  else if (use.transmits)
    colors = part.mesh.colors;
  const std::vector<float> alphas = use.transparent ? part.alphas : std::vector<float>();
  if (colors.empty() && alphas.empty()) return;
  const TriangleTints all = triangle_tints(part.mesh, colors, alphas);
  part.mesh.triangle_materials.clear();
  for (const VertexTint& tint : all.tints)
    part.mesh.triangle_materials.push_back(materials_.tinted(use, tint));
  if (all.varies_in_triangles || all.steps > 0)
    document_.warn(part.primitive, "vertex tints",
                   fmt::format("{} of vertex colours is that of the middle of each triangle{}",
                               use.unlit       ? "the emission"
                               : use.transmits ? "the transmission"
                                               : "the alpha",
                               all.steps > 0 ? fmt::format(", rounded to {} steps", all.steps) : ""));
}

void SceneReader::add_part(Part part, const std::string& name, const Transform* to_world,
                           std::optional<std::uint32_t> object) {
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
      if (variants.at(k).as_whole() == *selection_.variant) return mappings.at(i)["material"];
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
    Document document(std::move(*bytes), builder);
    apply_pointers(document);
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
