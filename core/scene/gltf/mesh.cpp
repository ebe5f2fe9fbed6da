// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "core/scene/loader/vertex_normals.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

// The values of "mode".
enum Mode : std::uint64_t { kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };

// The triangles of so many corners in a row (glTF 2.0 specification, section 3.7.2.1).
std::uint64_t triangle_count(std::uint64_t mode, std::uint64_t corners) {
  if (mode == kTriangles) return corners / 3;
  return corners < 3 ? 0 : corners - 2;
}

// The corners of triangle `i`, in counter-clockwise order.
std::array<std::size_t, 3> corners_of(std::uint64_t mode, std::size_t i) {
  if (mode == kTriangleStrip) return {i, i + 1 + i % 2, i + 2 - i % 2};
  if (mode == kTriangleFan) return {i + 1, i + 2, 0};
  return {3 * i, 3 * i + 1, 3 * i + 2};
}

// Numbers the vertices that triangles use anew, so that primitives that share long arrays do not each keep
// all of them. Returns their old numbers, in increasing order.
std::vector<std::uint32_t> renumber(std::vector<std::array<std::uint32_t, 3>>& triangles,
                                    std::size_t vertices) {
  std::vector<std::uint32_t> used;
  if (3 * triangles.size() < vertices / 8) {
    for (const auto& triangle : triangles) used.insert(used.end(), triangle.begin(), triangle.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (auto& triangle : triangles)
      for (std::uint32_t& corner : triangle)
        corner =
            static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), corner) - used.begin());
    return used;
  }
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> numbers(vertices, kUnused);
  for (const auto& triangle : triangles)
    for (const std::uint32_t corner : triangle) numbers[corner] = 0;
  for (std::size_t i = 0; i < vertices; ++i)
    if (numbers[i] != kUnused) {
      numbers[i] = static_cast<std::uint32_t>(used.size());
      used.push_back(static_cast<std::uint32_t>(i));
    }
  for (auto& triangle : triangles)
    for (std::uint32_t& corner : triangle) corner = numbers[corner];
  return used;
}

std::vector<Vec3> vectors_of(const Accessor& values, const std::vector<std::uint32_t>& used) {
  std::vector<Vec3> vectors;
  vectors.reserve(used.size());
  for (const std::uint32_t i : used) vectors.push_back(values.vec3(i));
  return vectors;
}

// glTF's v points downwards.
std::vector<Vec2> uvs_of(const Accessor& values, const std::vector<std::uint32_t>& used) {
  std::vector<Vec2> uvs;
  uvs.reserve(used.size());
  for (const std::uint32_t i : used) uvs.push_back({values.number(i, 0), 1 - values.number(i, 1)});
  return uvs;
}

void add_scaled(std::vector<Vec3>& vectors, const Accessor& deltas, const std::vector<std::uint32_t>& used,
                float weight) {
  for (std::size_t k = 0; k < used.size(); ++k) vectors[k] += deltas.vec3(used[k]) * weight;
}

void add_scaled(std::vector<VertexTangent>& tangents, const Accessor& deltas,
                const std::vector<std::uint32_t>& used, float weight) {
  for (std::size_t k = 0; k < used.size(); ++k) tangents[k].direction += deltas.vec3(used[k]) * weight;
}

Transform weighted(const Transform& map, float weight) {
  return {map.x_axis * weight, map.y_axis * weight, map.z_axis * weight, map.origin * weight};
}

void add(Transform& sum, const Transform& map) {
  sum.x_axis += map.x_axis, sum.y_axis += map.y_axis, sum.z_axis += map.z_axis, sum.origin += map.origin;
}

}  // namespace

JointMaps read_skin(const Value& skin, const Document& document, Accessors& accessors,
                    const std::vector<Node>& nodes, std::size_t moment) {
  const Value joints = skin["joints"], inverse_bind = skin["inverseBindMatrices"];
  if (joints.size() == 0) skin.refuse("has no joints");
  Accessor to_joint;
  if (inverse_bind.exists()) {
    to_joint = accessors.read(inverse_bind, 16);
    if (to_joint.count() < joints.size()) inverse_bind.refuse("has fewer matrices than the skin has joints");
  }
  JointMaps maps;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    document.element("nodes", joints.at(i));
    const Transform& to_world = nodes[static_cast<std::size_t>(joints.at(i).whole())].to_world[moment];
    maps.push_back(inverse_bind.exists() ? compose(to_world, to_joint.matrix(i)) : to_world);
  }
  return maps;
}

MeshReader::Source MeshReader::open(const Value& primitive) const {
  Source source;
  source.primitive = primitive;
  const Value draco = primitive.extension("KHR_draco_mesh_compression");
  if (!draco.exists()) return source;
  std::vector<DracoAttribute> attributes;
  for (const std::string& name : draco["attributes"].keys()) {
    const Value index = primitive["attributes"][name];
    if (!index.exists()) continue;
    attributes.push_back({name, static_cast<std::uint32_t>(draco["attributes"][name].whole()),
                          Accessors::layout_of(document_.element("accessors", index))});
  }
  source.draco = decode_draco(draco, buffers_.view(draco["bufferView"]).bytes, attributes,
                              document_.builder().limits().triangles.most);
  return source;
}

std::optional<Accessor> MeshReader::attribute(const Source& source, const std::string& name,
                                              std::size_t components, bool or_four) const {
  const Value index = source.primitive["attributes"][name];
  std::optional<Accessor> values;
  if (source.draco) {
    const auto found = source.draco->attributes.find(name);
    if (found != source.draco->attributes.end()) values = found->second;
  }
  if (!values && index.exists()) values = accessors_.read(index, components, or_four);
  if (!values) return std::nullopt;
  if (values->components() < components) index.refuse("has too few components");
  if (values->count() < source.vertices)
    index.refuse(fmt::format("has {} elements for {} vertices", values->count(), source.vertices));
  return values;
}

void MeshReader::check_triangles(const Value& primitive, std::uint64_t count) const {
  const auto& builder = document_.builder();
  if (auto fits = builder.check_triangles(builder.shown(builder.scene_path()), count); !fits)
    primitive.refuse(fits.error().message, fits.error().code);
}

MeshReader::Triangles MeshReader::triangles_of(Source& source) const {
  const Value& primitive = source.primitive;
  if (!source.draco) return stored_triangles(source);
  check_triangles(primitive, source.draco->triangles.size());
  for (const auto& triangle : source.draco->triangles)
    for (const std::uint32_t vertex : triangle)
      if (vertex >= source.vertices) primitive.refuse("the compressed mesh has more vertices than POSITION");
  return std::move(source.draco->triangles);
}

MeshReader::Triangles MeshReader::stored_triangles(const Source& source) const {
  const Value& primitive = source.primitive;
  const Value index = primitive["indices"];
  const std::uint64_t mode = primitive.whole_or("mode", kTriangles);
  std::optional<Accessor> indices;
  if (index.exists()) indices = accessors_.read(index, 1);
  if (indices && indices->component() == Component::kFloat) index.refuse("must be integers");
  const std::size_t corners = indices ? indices->count() : source.vertices;
  if (mode == kTriangles && corners % 3 != 0)
    document_.warn(primitive, "incomplete triangle", "its last triangle is incomplete and is left out");
  const std::uint64_t count = triangle_count(mode, corners);
  check_triangles(primitive, count);
  Triangles triangles;
  triangles.reserve(static_cast<std::size_t>(count));
  for (std::uint64_t i = 0; i < count; ++i) {
    std::array<std::uint32_t, 3> triangle{};
    const auto corner = corners_of(mode, static_cast<std::size_t>(i));
    for (std::size_t k = 0; k < 3; ++k)
      triangle[k] = indices ? indices->whole(corner[k]) : static_cast<std::uint32_t>(corner[k]);
    if (std::ranges::all_of(triangle, [&](std::uint32_t vertex) { return vertex < source.vertices; }))
      triangles.push_back(triangle);
  }
  if (triangles.size() < count)
    document_.warn(
        index, "missing vertices",
        fmt::format("triangles left out because they name vertices beyond the {} that there are: {}",
                    source.vertices, count - triangles.size()));
  return triangles;
}

std::optional<Part> MeshReader::read(const Value& primitive, const UsedAttributes& used,
                                     const std::vector<MeshPose>& poses) {
  if (!has_area(primitive)) return std::nullopt;
  Source source = open(primitive);
  const auto positions = attribute(source, "POSITION", 3);
  if (!positions) {
    document_.warn(primitive, "no positions", "it has no POSITION; it is left out");
    return std::nullopt;
  }
  source.vertices = positions->count();
  Part part{primitive, {}};
  part.mesh.triangles = triangles_of(source);
  source.used = renumber(part.mesh.triangles, source.vertices);
  part.mesh.positions = vectors_of(*positions, source.used);
  read_attributes(part, source, used);
  shape(part.mesh, source, poses);
  return part;
}

void MeshReader::shape(MeshDescription& mesh, const Source& source,
                       const std::vector<MeshPose>& poses) const {
  const bool is_skinned = poses.front().joints.has_value();
  const std::vector<Influences> influences = is_skinned ? influences_of(source) : std::vector<Influences>();
  std::vector<MeshStep> steps;
  for (const MeshPose& pose : poses) {
    MeshStep step{pose.moment, mesh.positions, mesh.normals, mesh.tangents};
    apply_morph_targets(step, source, pose.weights);
    if (is_skinned) apply_skin(step, source, influences, *pose.joints);
    steps.push_back(std::move(step));
  }
  mesh.positions = steps.front().positions;
  mesh.normals = steps.front().normals;
  mesh.tangents = steps.front().tangents;
  // The first step differs from itself where it has numbers that are none.
  const bool deforms = std::any_of(steps.begin() + 1, steps.end(), [&](const MeshStep& step) {
    return step.positions != mesh.positions || step.normals != mesh.normals || step.tangents != mesh.tangents;
  });
  if (deforms) mesh.steps = std::move(steps);
}

bool MeshReader::has_area(const Value& primitive) const {
  const std::uint64_t mode = primitive.whole_or("mode", kTriangles);
  if (mode > kTriangleFan) primitive.refuse(fmt::format("there is no mode {}", mode));
  if (mode >= kTriangles) return true;
  document_.warn(primitive, "points and lines", "points and lines have no area; they are left out");
  return false;
}

std::optional<Accessor> MeshReader::optional_attribute(const Source& source, const std::string& name,
                                                       std::size_t components, bool or_four) const {
  std::optional<Accessor> values;
  document_.try_to(source.primitive["attributes"][name], "attribute " + name, "it is ignored",
                   [&] { values = attribute(source, name, components, or_four); });
  return values;
}

std::vector<Vec2> MeshReader::read_uvs(const Source& source, std::uint32_t set) const {
  const auto uvs = optional_attribute(source, fmt::format("TEXCOORD_{}", set), 2);
  return uvs ? uvs_of(*uvs, source.used) : std::vector<Vec2>();
}

// Exporters write one accessor under several names.
void MeshReader::read_second_uvs(MeshDescription& mesh, const Source& source, std::uint32_t first,
                                 std::uint32_t second) const {
  const Value attributes = source.primitive["attributes"];
  const auto name_of_set = [](std::uint32_t set) { return fmt::format("TEXCOORD_{}", set); };
  const auto accessor = attributes[name_of_set(second)].as_whole();
  if (accessor && accessor == attributes[name_of_set(first)].as_whole()) return;
  mesh.second_uvs = read_uvs(source, second);
  const bool lacks_first = mesh.uvs.empty(), lacks_second = mesh.second_uvs.empty();
  if (lacks_first == lacks_second) return;
  document_.warn(source.primitive, "missing uv",
                 fmt::format("it has no {0}; {1} replaces it", name_of_set(lacks_first ? first : second),
                             name_of_set(lacks_first ? second : first)));
  if (lacks_first) mesh.uvs = std::exchange(mesh.second_uvs, {});
}

void MeshReader::read_attributes(Part& part, const Source& source, const UsedAttributes& used) const {
  MeshDescription& mesh = part.mesh;
  const std::vector<std::uint32_t>& uv_sets = used.uv_sets;
  if (const auto normals = optional_attribute(source, "NORMAL", 3))
    mesh.normals = vectors_of(*normals, source.used);
  if (used.tangents && !mesh.normals.empty()) read_tangents(mesh, source);
  mesh.uvs = read_uvs(source, uv_sets.empty() ? 0 : uv_sets[0]);
  if (uv_sets.size() > 1) read_second_uvs(mesh, source, uv_sets[0], uv_sets[1]);
  if (!uv_sets.empty() && mesh.uvs.empty())
    document_.warn(source.primitive, "no uv",
                   fmt::format("it has no TEXCOORD_{}; its textures show a single texel", uv_sets[0]));
  read_colors(part, source);
}

void MeshReader::read_tangents(MeshDescription& mesh, const Source& source) const {
  const auto tangents = optional_attribute(source, "TANGENT", 4);
  if (!tangents) return;
  mesh.tangents.reserve(source.used.size());
  for (const std::uint32_t i : source.used)
    mesh.tangents.push_back({tangents->vec3(i), tangents->number(i, 3)});
}

void MeshReader::read_colors(Part& part, const Source& source) const {
  const auto colors = optional_attribute(source, "COLOR_0", 3, true);
  if (!colors) return;
  for (const std::uint32_t i : source.used) {
    const Vec3 color = colors->vec3(i);
    part.mesh.colors.push_back({color.x, color.y, color.z});
    if (colors->components() == 4) part.alphas.push_back(colors->number(i, 3));
  }
  if (std::ranges::all_of(part.alphas, [](float alpha) { return alpha >= 1; })) part.alphas.clear();
}

// Linear blend skinning (glTF 2.0 specification, section 3.7.3). A vertex without weights stays.
void MeshReader::apply_skin(MeshStep& step, const Source& source, const std::vector<Influences>& influences,
                            const JointMaps& maps) const {
  std::uint64_t missing = 0;
  for (std::size_t k = 0; k < source.used.size(); ++k) {
    Transform sum{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    float total = 0;
    for (const auto& [joints, weights] : influences)
      for (std::size_t c = 0; c < 4; ++c) {
        const float weight = weights.number(source.used[k], c);
        if (!(weight > 0)) continue;
        const std::uint32_t joint = joints.whole(source.used[k], c);
        if (joint >= maps.size()) {
          ++missing;
          continue;
        }
        add(sum, weighted(maps[joint], weight));
        total += weight;
      }
    if (!(total > 0)) continue;
    const Transform map = weighted(sum, 1 / total);
    step.positions[k] = map.point(step.positions[k]);
    if (!step.normals.empty())
      step.normals[k] = map.determinant() < 0 ? -map.normal(step.normals[k]) : map.normal(step.normals[k]);
    if (!step.tangents.empty()) step.tangents[k] = transformed(step.tangents[k], map);
  }
  if (missing > 0)
    document_.warn(source.primitive, "missing joints",
                   fmt::format("weights ignored because their joints are beyond the {} of the skin: {}",
                               maps.size(), missing));
}

std::vector<Influences> MeshReader::influences_of(const Source& source) const {
  std::vector<Influences> influences;
  for (int n = 0;; ++n) {
    auto joints = attribute(source, fmt::format("JOINTS_{}", n), 4);
    auto weights = attribute(source, fmt::format("WEIGHTS_{}", n), 4);
    if (!joints || !weights) return influences;
    influences.push_back({std::move(*joints), std::move(*weights)});
  }
}

void MeshReader::apply_morph_targets(MeshStep& step, const Source& source,
                                     const std::vector<float>& weights) const {
  const Value targets = source.primitive["targets"];
  for (std::size_t i = 0; i < std::min(targets.size(), weights.size()); ++i) {
    if (weights[i] == 0) continue;
    const Value target = targets.at(i);
    const auto add_deltas = [&](std::string_view name, auto& vectors) {
      if (!target[name].exists() || vectors.empty()) return;
      document_.try_to(target[name], "morph target", "it is ignored", [&] {
        const Accessor deltas = accessors_.read(target[name], 3);
        if (deltas.count() < source.vertices) target[name].refuse("has too few elements");
        add_scaled(vectors, deltas, source.used, weights[i]);
      });
    };
    add_deltas("POSITION", step.positions);
    add_deltas("NORMAL", step.normals);
    add_deltas("TANGENT", step.tangents);
    for (const std::string& name : target.keys())
      if (name.starts_with("TEXCOORD") || name.starts_with("COLOR"))
        document_.warn(target, "morphed attribute",
                       fmt::format("morphing of {} is ignored", in_quotes(name)));
  }
}

}  // namespace tessera::core::gltf
