// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/scene/loader/wording.hpp"
#include "core/scene/mitsuba/curve_text.hpp"
#include "core/scene/mitsuba/mesh_attributes.hpp"

namespace tessera::core::mitsuba {
namespace {

constexpr std::uint64_t kMaxMerged = std::uint64_t{1} << 22;

// Whether the map keeps shapes similar: all lengths grow by the same factor.
bool is_similarity(const Transform& t) {
  constexpr float kTolerance = 1e-3f;
  const Vec3 scales = t.scales();
  const float least = std::min({scales.x, scales.y, scales.z}),
              most = std::max({scales.x, scales.y, scales.z});
  const auto orthogonal = [&](Vec3 a, Vec3 b) { return std::fabs(dot(a, b)) <= kTolerance * most * most; };
  return most > 0 && most - least <= kTolerance * most && orthogonal(t.x_axis, t.y_axis) &&
         orthogonal(t.y_axis, t.z_axis) && orthogonal(t.z_axis, t.x_axis);
}

// Two directions that form a right-handed frame with a unit direction (Duff et al. 2017).
std::pair<Vec3, Vec3> frame_around(Vec3 n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {{1 + sign * (n.x * n.x * a), sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

}  // namespace

void ShapeConverter::add(const Plugin& shape, std::optional<std::uint32_t> object) {
  const std::string& type = shape.type();
  if (shape.children(Kind::kBsdf).size() > 1)
    shape.warn("has several BSDFs, which Mitsuba refuses; the first one is used");
  if (is_mesh(shape)) return add_mesh(shape, object);
  if (type == "sphere") return add_sphere(shape, object);
  if (type == "disk") return add_disk(shape, object);
  if (type == "cylinder") return add_cylinder(shape, object);
  if (type == "bsplinecurve") return add_curves(shape, CurveBasis::kBSpline, object);
  if (type == "linearcurve") return add_curves(shape, CurveBasis::kLinear, object);
  if (type == "instance") return add_instance(shape, object);
  if (type == "shapegroup") return static_cast<void>(group(shape));
  if (type == "merge") {
    for (const Plugin& part : shape.children(Kind::kShape)) {
      if (!conversion_.status) return;
      if (++merged_ > kMaxMerged)
        return conversion_.check(
            fail(ErrorCode::kResourceExhausted, fmt::format("merges hold more than {} shapes", kMaxMerged)));
      add(part, object);
    }
    return;
  }
  shape.warn("this shape is not supported; it is left out");
  shape.ignore_all();
}

std::string ShapeConverter::name_of(const Plugin& shape) const {
  return shape.name().empty() ? fmt::format("{} at {}:{}", shape.type(), shape.file(), shape.where().line)
                              : shape.name();
}

MaterialIndex ShapeConverter::material(const Plugin& shape, const TextureSite& site) {
  return materials_.material(
      {shape.first_child(Kind::kBsdf), area_light_of(shape), media_.interface_of(shape), site});
}

void ShapeConverter::add_mesh(const Plugin& shape, std::optional<std::uint32_t> object) {
  if (auto mesh = load_mesh(conversion_, shape, needs(shape).images))
    return add_finished_mesh(shape, std::move(*mesh), object);
  shape.ignore_all();
}

void ShapeConverter::add_finished_mesh(const Plugin& shape, ShapeMesh mesh,
                                       std::optional<std::uint32_t> object) {
  TextureSite site{mesh.layout, nullptr};
  if (const TextureNeeds needed = needs(shape); needed.attributes) {
    if (needed.images) shape.warn("the means replace its attributes, because its material has images, too");
    attributes_.push_back(needed.images ? mean_attributes(conversion_, mesh)
                                        : make_attribute_textures(conversion_, shape, mesh));
    site = {needed.images ? mesh.layout : UvLayout::kReversedV, &attributes_.back()};
  }
  const MaterialIndex index = material(shape, site);
  if (index.is_reversed) flip_mesh(mesh.mesh);
  mesh.mesh.colors.clear();
  mesh.mesh.triangle_materials = {index.index};
  conversion_.check(conversion_.builder.add_mesh(std::move(mesh.mesh), name_of(shape), object, shape.file(),
                                                 shape.where().line));
}

void ShapeConverter::add_sphere(const Plugin& shape, std::optional<std::uint32_t> object) {
  const float written_radius = shape.real("radius", 1), radius = std::fabs(written_radius);
  const Vec3 center = shape.vector("center").value_or(Vec3{});
  const Transform to_world =
      compose(compose(shape.transform("to_world"), translation(center)), scaling({radius, radius, radius}));
  const bool flipped =
      (shape.flag("flip_normals", false) != (written_radius < 0)) != (to_world.determinant() < 0);
  const bool has_images = needs(shape).images;
  const MaterialIndex index = material(shape, {has_images ? UvLayout::kReversedV : UvLayout::kSame, nullptr});
  const bool is_exact = is_similarity(to_world) && flipped == index.is_reversed && (!has_images || !object);
  if (!is_exact) {
    shape.warn(
        "is approximated by triangles, because its normals point inwards, it is no sphere in the world, "
        "or it is part of a group and has images");
    ShapeMesh mesh{sphere_mesh(), {}, UvLayout::kSame};
    place_mesh(mesh.mesh, to_world);
    if (flipped) flip_mesh(mesh.mesh);
    return add_finished_mesh(shape, std::move(mesh), object);
  }
  if (!has_images) {
    const float scale = to_world.scales().x;
    conversion_.builder.add_shape(SphereDescription{to_world.origin, scale, index.index}, name_of(shape),
                                  object, shape.place());
    return;
  }
  // The poles of texture coordinates are on y here, and on z in Mitsuba.
  const std::uint32_t own = conversion_.builder.add_object(name_of(shape));
  conversion_.builder.add_shape(SphereDescription{{}, 1, index.index}, name_of(shape), own, shape.place());
  const Transform poles_on_z{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {0, 0, 0}};
  conversion_.builder.add_instance(own, compose(to_world, poles_on_z), name_of(shape), shape.place());
}

void ShapeConverter::add_disk(const Plugin& shape, std::optional<std::uint32_t> object) {
  const Transform to_world = shape.transform("to_world");
  const MaterialIndex index = material(shape, {UvLayout::kDisk, nullptr});
  DiskDescription disk;
  disk.center = to_world.origin;
  disk.radius_u = to_world.x_axis;
  disk.radius_v = to_world.y_axis;
  const bool mirrored = to_world.determinant() < 0;
  disk.flipped = (mirrored != shape.flag("flip_normals", false)) != index.is_reversed;
  disk.material = index.index;
  conversion_.builder.add_shape(disk, name_of(shape), object, shape.place());
}

void ShapeConverter::add_cylinder(const Plugin& shape, std::optional<std::uint32_t> object) {
  const Vec3 p0 = shape.vector("p0").value_or(Vec3{0, 0, 0}), p1 = shape.vector("p1").value_or(Vec3{0, 0, 1});
  const float radius = shape.real("radius", 1);
  const auto [u, v] = frame_around(normalize(p1 - p0));
  if (!is_finite(u) || !is_finite(v)) {
    shape.warn("its ends coincide; it is left out");
    return;
  }
  const Transform to_world = shape.transform("to_world");
  const MaterialIndex index = material(shape, {});
  CylinderDescription cylinder;
  cylinder.start = to_world.point(p0);
  cylinder.axis = to_world.direction(p1 - p0);
  cylinder.radius_u = to_world.direction(u * radius);
  cylinder.radius_v = to_world.direction(v * radius);
  const bool mirrored = to_world.determinant() < 0;  // turns its normals, as those of spheres
  cylinder.flipped = (mirrored != shape.flag("flip_normals", false)) != index.is_reversed;
  cylinder.material = index.index;
  conversion_.builder.add_shape(cylinder, name_of(shape), object, shape.place());
}

// Transforms move the control points only, and keep the radii.
void ShapeConverter::add_curves(const Plugin& shape, CurveBasis basis, std::optional<std::uint32_t> object) {
  const auto path = find_shape_file(conversion_, shape);
  if (!path) return shape.ignore_all();
  const auto text = conversion_.builder.read(*path);
  if (!text) return conversion_.check(fail(text.error()));
  auto strands = read_curve_text(*text, basis);
  if (!strands) {
    shape.warn(fmt::format("{} {}; the shape is left out", in_quotes(*path), strands.error().message));
    return shape.ignore_all();
  }
  if (basis == CurveBasis::kLinear) shape.warn("the joints of linear segments are open, and not rounded");
  if (needs(shape).images)
    shape.warn(
        "texture coordinates are u along each strand and v across it, not around it and along all strands");
  if (area_light_of(shape)) shape.warn("curves that emit light are not supported; they are dark");
  const Transform to_world = shape.transform("to_world");
  for (Vec3& point : strands->points) point = to_world.point(point);
  const MaterialIndex index = materials_.material(
      {shape.first_child(Kind::kBsdf), std::nullopt, media_.interface_of(shape), TextureSite{}});
  conversion_.check(conversion_.builder.add_curves({std::move(*strands), index.index}, name_of(shape), object,
                                                   shape.place()));
}

void ShapeConverter::add_instance(const Plugin& shape, std::optional<std::uint32_t> object) {
  const auto of = shape.first_child(Kind::kShape);
  if (!of || of->type() != "shapegroup" || object) {
    shape.warn(object ? "inside of a shape group is left out" : "has no shape group; it is left out");
    return shape.ignore_all();
  }
  // The parameter "animation" replaces "to_world".
  const auto* keys = shape.animation(shape.has("animation") ? "animation" : "to_world");
  auto motion = keys != nullptr && keys->size() > 1 ? motion_of(shape, *keys) : std::nullopt;
  if (!motion) {
    const Transform place = keys == nullptr ? shape.transform("to_world") : keys->front().transform;
    conversion_.builder.add_instance(group(*of), place, name_of(shape), shape.place());
    return;
  }
  if (!conversion_.builder.add_instance(group(*of), transform_at(*motion, 0), name_of(shape), shape.place()))
    return;
  SceneDescription& scene = conversion_.builder.scene();
  scene.animation.instances.push_back(
      {static_cast<std::uint32_t>(scene.shapes.size()) - 1, *std::move(motion)});
}

// nullopt after a warning.
std::optional<std::vector<MotionStep>> ShapeConverter::motion_of(const Plugin& shape,
                                                                 const KeyedTransforms& keys) {
  auto motion = motion_through(conversion_.in_frames(keys));
  if (!motion || !motion->is_exact) {
    shape.warn(
        "does not move as its keyframes shear it, reflect it or have no inverse; the first one counts");
    return std::nullopt;
  }
  return std::move(motion->steps);
}

std::uint32_t ShapeConverter::group(const Plugin& shape) {
  if (const auto known = groups_.find(shape.id()); known != groups_.end()) return known->second;
  const std::uint32_t object = conversion_.builder.add_object(name_of(shape));
  groups_.emplace(shape.id(), object);
  for (const Plugin& part : shape.children(Kind::kShape)) add(part, object);
  return object;
}

ShapeConverter::TextureNeeds ShapeConverter::needs(const Plugin& shape) const {
  TextureNeeds needed;
  std::map<NodeId, bool> seen;
  if (const auto bsdf = shape.first_child(Kind::kBsdf)) collect_needs(bsdf->id(), seen, needed);
  if (const auto emitter = area_light_of(shape)) collect_needs(emitter->id(), seen, needed);
  return needed;
}

void ShapeConverter::collect_needs(NodeId id, std::map<NodeId, bool>& seen, TextureNeeds& needed) const {
  if (!seen.try_emplace(id, true).second) return;
  const Node& node = conversion_.graph.nodes[id];
  if (node.kind == Kind::kTexture && node.type == "mesh_attribute") needed.attributes = true;
  if (node.kind == Kind::kTexture && (node.type == "bitmap" || node.type == "checkerboard"))
    needed.images = true;
  for (const Property& property : node.properties)
    if (const auto* child = std::get_if<Child>(&property.value)) collect_needs(child->node, seen, needed);
}

}  // namespace tessera::core::mitsuba
