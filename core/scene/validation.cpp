// SPDX-License-Identifier: Apache-2.0
#include "core/scene/validation.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/overloaded.hpp"
#include "core/geometry/placement.hpp"
#include "core/geometry/primitives.hpp"
#include "core/scene/analytic_shapes.hpp"

namespace tessera::core {
namespace {

tl::unexpected<Error> invalid(std::string message) {
  return fail(ErrorCode::kInvalidArgument, std::move(message));
}

bool fits(Vec3 p) {
  const auto in_range = [](float c) { return std::fabs(c) <= kMaxCoordinate; };
  return in_range(p.x) && in_range(p.y) && in_range(p.z);
}

bool is_valid_radiance(Rgb c) {
  return is_finite(c) && c.r >= 0 && c.g >= 0 && c.b >= 0;
}

bool is_share(Rgb c) {
  return is_valid_radiance(c) && max_component(c) <= 1;
}

// Also checks the product with the texture's largest value.
bool is_valid_radiance(const ColorParameter& color, const std::vector<Texture>& textures) {
  if (!is_valid_radiance(color.value)) return false;
  return color.texture < 0 ||
         is_valid_radiance(color.value * textures[static_cast<std::size_t>(color.texture)].image->largest());
}

}  // namespace

Status validate_camera(const CameraDescription& camera) {
  if (!fits(camera.position) || !fits(camera.look_at) || !is_finite(camera.up))
    return invalid("camera: position, look_at and up must be finite numbers");
  const Vec3 view = camera.look_at - camera.position;
  if (!(length_squared(view) > 0)) return invalid("camera.look_at: must differ from camera.position");
  const Vec3 across = cross(normalize(view), camera.up);
  if (!(length_squared(across) > 0))
    return invalid("camera.up: must not be parallel to the viewing direction");
  if (camera.type == CameraType::kOrthographic &&
      !(camera.view_height > 0 && camera.view_height <= kMaxCoordinate))
    return invalid(fmt::format("camera.view_height: must be above 0 and at most {:g}, got {}", kMaxCoordinate,
                               camera.view_height));
  const auto is_shift = [](float shift) { return std::fabs(shift) <= kMaxLensShift; };
  if (!is_shift(camera.lens_shift.x) || !is_shift(camera.lens_shift.y))
    return invalid(fmt::format("camera.lens_shift: must be between -{0} and {0}, got [{1}, {2}]",
                               kMaxLensShift, camera.lens_shift.x, camera.lens_shift.y));
  if (!(camera.vertical_fov_degrees > 0 && camera.vertical_fov_degrees < 180))
    return invalid(fmt::format("camera.vertical_fov_degrees: must lie between 0 and 180, got {}",
                               camera.vertical_fov_degrees));
  if (!(camera.aperture_radius >= 0 && camera.aperture_radius <= kMaxCoordinate))
    return invalid(fmt::format("camera.aperture_radius: must be between 0 and {:g}, got {}", kMaxCoordinate,
                               camera.aperture_radius));
  const int blades = camera.aperture_blades;
  if (blades != 0 && !(blades >= kMinApertureBlades && blades <= kMaxApertureBlades))
    return invalid(fmt::format("camera.aperture_blades: must be 0, or between {} and {}, got {}",
                               kMinApertureBlades, kMaxApertureBlades, blades));
  if (!(std::fabs(camera.aperture_rotation_degrees) <= 360))
    return invalid(fmt::format("camera.aperture_rotation_degrees: must be between -360 and 360, got {}",
                               camera.aperture_rotation_degrees));
  if (!(camera.focus_distance >= 0) || !std::isfinite(camera.focus_distance))
    return invalid(fmt::format("camera.focus_distance: must be above 0, got {}", camera.focus_distance));
  return {};
}

namespace {

bool is_in_range(std::string_view, const ColorParameter& color) {
  return is_valid_radiance(color.value);
}

bool is_in_range(std::string_view key, const ScalarParameter& scalar) {
  if (key.ends_with("ior")) return scalar.value > 0 && std::isfinite(scalar.value);
  return scalar.value >= 0 && std::isfinite(scalar.value);
}

Status check_material(const Material& material, const std::vector<Texture>& textures) {
  const auto texture_count = static_cast<int>(textures.size());
  const auto wrong = [&](std::string_view what) {
    return invalid(fmt::format("material '{}': {}", material.name, what));
  };
  std::string_view mistaken;
  visit_parameters(material.model, [&](std::string_view key, const auto& parameter) {
    if (parameter.texture >= texture_count || !is_in_range(key, parameter)) mistaken = key;
  });
  if (!mistaken.empty()) return wrong(fmt::format("{} is out of range, or its texture", mistaken));
  if (material.normal_map.texture >= texture_count || !std::isfinite(material.normal_map.strength))
    return wrong("the normal map's texture or its strength is out of range");
  if (material.bump.texture >= texture_count || !std::isfinite(material.bump.height))
    return wrong("the bump map's texture or its height is out of range");
  const ScalarParameter& opacity = material.opacity;
  if (opacity.texture >= texture_count || !(opacity.value >= 0 && opacity.value <= 1))
    return wrong("opacity must be between 0 and 1, or its texture is out of range");
  if (material.sampling == Sampling::kHalfVector && !std::holds_alternative<CookTorrance>(material.model))
    return wrong("only cook_torrance can be sampled by half-vectors");
  if (!is_valid_radiance(material.emission.value)) return wrong("emission must be finite and not negative");
  if (std::holds_alternative<Null>(material.model) && !is_black(material.emission.value))
    return wrong("a null material cannot emit");
  if (material.emission.texture >= texture_count) return wrong("emission: there is no such texture");
  if (!is_valid_radiance(material.emission, textures))
    return wrong("emission times its texture is too bright to be computed; lower it");
  return {};
}

bool is_medium(int medium, const SceneDescription& scene) {
  return medium >= kNoMedium && medium < static_cast<int>(scene.media.size());
}

// A blend's parts stand before it, which rules out cycles; `depths` are those of the materials before it.
Status check_blend(const Material& material, const Blend& blend, const std::vector<Material>& all,
                   std::vector<int>& depths) {
  if (std::max(blend.first, blend.second) >= depths.size() - 1)
    return invalid(
        fmt::format("material '{}': a blend's materials must stand before the blend", material.name));
  depths.back() = 1 + std::max(depths[blend.first], depths[blend.second]);
  if (!is_black(material.emission.value) &&
      !(is_opaque(all[blend.first], all) && is_opaque(all[blend.second], all)))
    return invalid(
        fmt::format("material '{}': a blend of what light passes through cannot emit", material.name));
  if (depths.back() <= kMaxBlendDepth) return {};
  return invalid(
      fmt::format("material '{}': blends of blends may be {} deep", material.name, kMaxBlendDepth));
}

Status check_materials(const SceneDescription& scene) {
  std::vector<int> blend_depths;
  for (const Material& material : scene.materials) {
    blend_depths.push_back(0);
    if (auto ok = check_material(material, scene.textures); !ok) return ok;
    if (const auto* blend = std::get_if<Blend>(&material.model))
      if (auto ok = check_blend(material, *blend, scene.materials, blend_depths); !ok) return ok;
    if (!is_medium(material.media.interior, scene) || !is_medium(material.media.exterior, scene))
      return invalid(fmt::format("material '{}': there is no such medium", material.name));
  }
  return {};
}

// Whether the coefficients and the products with the grid's values can be computed.
bool is_valid_coefficient(Rgb value, int grid, const SceneDescription& scene) {
  const auto is_valid = [](Rgb v) {
    return is_valid_radiance(v) && max_component(v) <= kMaxMediumCoefficient;
  };
  if (!is_valid(value)) return false;
  if (grid < 0) return true;
  const auto& values = scene.grids[static_cast<std::size_t>(grid)].values;
  return is_valid(value * *std::max_element(values.begin(), values.end()));
}

Status check_medium(const MediumDescription& medium, const SceneDescription& scene) {
  const auto wrong = [&](std::string_view what) {
    return invalid(fmt::format("medium '{}': {}", medium.name, what));
  };
  for (const int grid : {medium.absorption_grid, medium.scattering_grid, medium.emission_grid})
    if (grid < -1 || grid >= static_cast<int>(scene.grids.size())) return wrong("there is no such grid");
  if (!(medium.scale >= 0) ||
      !is_valid_coefficient(medium.sigma_a * medium.scale, medium.absorption_grid, scene) ||
      !is_valid_coefficient(medium.sigma_s * medium.scale, medium.scattering_grid, scene))
    return wrong("sigma_a, sigma_s and scale must be from 0 to 1e18, also times the grid's values");
  if (!is_valid_coefficient(medium.emission, medium.emission_grid, scene))
    return wrong("emission must be from 0 to 1e18, also times the grid's values");
  if (!(medium.g > -1 && medium.g < 1)) return wrong("g must be above -1 and below 1");
  if (medium.has_grid() && !Placement::can_place(medium.grid_to_world))
    return wrong("the transform flattens the grid, or scales or moves it too far to be computed");
  return {};
}

Status check_media(const SceneDescription& scene) {
  for (std::size_t i = 0; i < scene.grids.size(); ++i)
    if (!is_sound(scene.grids[i]))
      return invalid(
          fmt::format("grid {}: needs one or three finite values that are not negative for each voxel, and 1 "
                      "to {} voxels "
                      "a side",
                      i, kMaxGridSide));
  for (const MediumDescription& medium : scene.media)
    if (auto ok = check_medium(medium, scene); !ok) return ok;
  if (!is_medium(scene.camera_medium, scene)) return invalid("camera: there is no such medium");
  return {};
}

bool glows(const MediumDescription& medium) {
  return medium.scale > 0 && !is_black(medium.sigma_a * medium.emission);
}

// Whether the direction from `from` to `to` can be computed.
bool has_way(Vec3 from, Vec3 to) {
  const float distance2 = length_squared(to - from);
  return distance2 > 0 && std::isfinite(distance2);
}

Status check_light(const LightDescription& light) {
  return std::visit(
      Overloaded{
          [](const PointLightDescription& d) -> Status {
            if (!fits(d.position)) return invalid("position must be finite numbers");
            if (!is_valid_radiance(d.intensity)) return invalid("intensity must be finite and not negative");
            return {};
          },
          [](const SpotLightDescription& d) -> Status {
            if (!fits(d.position) || !fits(d.look_at) || !has_way(d.position, d.look_at))
              return invalid("position and look_at must be two points");
            if (!is_valid_radiance(d.intensity)) return invalid("intensity must be finite and not negative");
            if (!(d.angle_degrees > 0 && d.angle_degrees <= 180))
              return invalid(
                  fmt::format("angle_degrees: must be above 0 and at most 180, got {}", d.angle_degrees));
            if (!(d.softness >= 0 && d.softness <= 1))
              return invalid(fmt::format("softness: must be between 0 and 1, got {}", d.softness));
            return {};
          },
          [](const DirectionalLightDescription& d) -> Status {
            if (!has_way({}, d.direction)) return invalid("direction must have a length");
            if (!is_valid_radiance(d.irradiance))
              return invalid("irradiance must be finite and not negative");
            return {};
          },
      },
      light);
}

// Or a reflection, to within rounding.
bool is_rotation(const Transform& t) {
  return std::fabs(uniform_scale(t, kEnvironmentTolerance) - 1) <= kEnvironmentTolerance;
}

Status check_environment(const SceneDescription& scene) {
  if (!scene.environment) return {};
  if (!is_valid_radiance(scene.environment->radiance.value))
    return invalid("environment: radiance must be finite and not negative");
  if (scene.environment->radiance.texture >= static_cast<int>(scene.textures.size()))
    return invalid("environment: there is no such texture");
  if (!is_valid_radiance(scene.environment->radiance, scene.textures))
    return invalid("environment: radiance times its image is too bright to be computed; lower it");
  if (!std::isfinite(scene.environment->rotation_degrees))
    return invalid("environment: rotation_degrees must be a number");
  if (!is_rotation(scene.environment->orientation))
    return invalid("environment: the orientation must be a rotation or a reflection");
  return {};
}

Status check_mesh(const MeshDescription& mesh, std::size_t material_count) {
  const std::size_t vertices = mesh.positions.size(), triangles = mesh.triangles.size();
  for (std::size_t i = 0; i < vertices; ++i)
    if (!fits(mesh.positions[i]))
      return invalid(
          fmt::format("vertex {}: coordinates must be numbers of at most {:g}", i + 1, kMaxCoordinate));
  if (!mesh.normals.empty() && mesh.normals.size() != vertices)
    return invalid(fmt::format("{} normals for {} vertices", mesh.normals.size(), vertices));
  if (!mesh.uvs.empty() && mesh.uvs.size() != vertices)
    return invalid(fmt::format("{} texture coordinates for {} vertices", mesh.uvs.size(), vertices));
  if (!mesh.colors.empty() && mesh.colors.size() != vertices)
    return invalid(fmt::format("{} colours for {} vertices", mesh.colors.size(), vertices));
  for (std::size_t i = 0; i < mesh.colors.size(); ++i)
    if (!is_share(mesh.colors[i]))
      return invalid(fmt::format("vertex {}: colours must be numbers between 0 and 1", i + 1));
  for (std::size_t i = 0; i < triangles; ++i)
    for (const std::uint32_t v : mesh.triangles[i])
      if (v >= vertices) return invalid(fmt::format("triangle {}: there is no vertex {}", i + 1, v + 1));
  if (mesh.triangle_materials.size() != 1 && mesh.triangle_materials.size() != triangles)
    return invalid(fmt::format("{} materials for {} triangles", mesh.triangle_materials.size(), triangles));
  for (const std::uint32_t m : mesh.triangle_materials)
    if (m >= material_count) return invalid(fmt::format("there is no material {}", m));
  return {};
}

Aabb bounds_of(const ShapeDescription& shape) {
  Aabb box;
  if (const auto* mesh = std::get_if<MeshDescription>(&shape)) {
    for (const Vec3 p : mesh->positions) box.include(p);
  } else if (const auto* sphere = std::get_if<SphereDescription>(&shape)) {
    const Vec3 reach{sphere->radius, sphere->radius, sphere->radius};
    box.include(sphere->center - reach);
    box.include(sphere->center + reach);
  } else if (const auto* quad = std::get_if<QuadDescription>(&shape)) {
    for (const Vec3 p : {quad->corner, quad->corner + quad->edge_u})
      for (const Vec3 q : {p, p + quad->edge_v}) box.include(q);
  } else if (const auto* disk = std::get_if<DiskDescription>(&shape)) {
    box = geometry_of(*disk).bounds();
  } else if (const auto* cylinder = std::get_if<CylinderDescription>(&shape)) {
    box = geometry_of(*cylinder).bounds();
  }
  return box;
}

// The properties of an object that its instances depend on.
struct ObjectFacts {
  Aabb bounds;
  std::vector<std::uint32_t> sphere_materials;
};

ObjectFacts facts_of(const ObjectDescription& object) {
  ObjectFacts facts;
  for (const ShapeDescription& shape : object.shapes) {
    facts.bounds.include(bounds_of(shape));
    if (const auto* sphere = std::get_if<SphereDescription>(&shape))
      facts.sphere_materials.push_back(sphere->material);
  }
  return facts;
}

bool has_emissive_sphere(const ObjectFacts& object, const InstanceDescription& instance,
                         const std::vector<Material>& materials) {
  return std::any_of(object.sphere_materials.begin(), object.sphere_materials.end(), [&](std::uint32_t m) {
    return !is_black(materials[instance.material.value_or(m)].emission.value);
  });
}

PlacementLimits limits_of(const ObjectFacts& object, const InstanceDescription& instance,
                          const std::vector<Material>& materials) {
  return {object.bounds, has_emissive_sphere(object, instance, materials)};
}

Status check_instance(const InstanceDescription& instance, const SceneDescription& scene,
                      const std::vector<ObjectFacts>& objects) {
  if (instance.object >= objects.size())
    return invalid(fmt::format("there is no object {}", instance.object));
  if (instance.material && *instance.material >= scene.materials.size())
    return invalid(fmt::format("there is no material {}", *instance.material));
  return validate_placement(instance.to_world,
                            limits_of(objects[instance.object], instance, scene.materials));
}

Status check_disk(const DiskDescription& disk) {
  if (!fits(disk.center) || !fits(disk.radius_u) || !fits(disk.radius_v))
    return invalid(fmt::format("coordinates must be numbers of at most {:g}", kMaxCoordinate));
  if (!(disk.inner >= 0 && disk.inner < 1))
    return invalid("the inner radius must be 0 or greater, and less than the radius");
  if (!geometry_of(disk).can_be_hit()) return invalid("the disk has no area that can be computed");
  return {};
}

Status check_cylinder(const CylinderDescription& c) {
  if (!fits(c.start) || !fits(c.axis) || !fits(c.radius_u) || !fits(c.radius_v))
    return invalid(fmt::format("coordinates must be numbers of at most {:g}", kMaxCoordinate));
  if (!Cylinder::can_be_hit(c.start, c.axis, c.radius_u, c.radius_v))
    return invalid("the cylinder is flat, or too small or too large to be computed");
  return {};
}

// For a scene or an object; `objects` is empty for the latter, which cannot contain instances.
Status check_shape(const ShapeDescription& shape, const SceneDescription& scene,
                   const std::vector<ObjectFacts>& objects) {
  const std::size_t material_count = scene.materials.size();
  return std::visit(
      Overloaded{
          [&](const MeshDescription& mesh) { return check_mesh(mesh, material_count); },
          [&](const SphereDescription& s) -> Status {
            if (!fits(s.center) || !(s.radius > 0 && s.radius <= kMaxCoordinate))
              return invalid(fmt::format("the centre must be numbers of at most {:g} and the radius above 0",
                                         kMaxCoordinate));
            if (s.material >= material_count)
              return invalid(fmt::format("there is no material {}", s.material));
            return {};
          },
          [&](const QuadDescription& q) -> Status {
            if (!fits(q.corner) || !fits(q.edge_u) || !fits(q.edge_v))
              return invalid(fmt::format("coordinates must be numbers of at most {:g}", kMaxCoordinate));
            if (q.material >= material_count)
              return invalid(fmt::format("there is no material {}", q.material));
            return {};
          },
          [&](const InstanceDescription& i) { return check_instance(i, scene, objects); },
          [&](const DiskDescription& d) -> Status {
            if (d.material >= material_count)
              return invalid(fmt::format("there is no material {}", d.material));
            return check_disk(d);
          },
          [&](const CylinderDescription& c) -> Status {
            if (c.material >= material_count)
              return invalid(fmt::format("there is no material {}", c.material));
            return check_cylinder(c);
          },
      },
      shape);
}

Status check_shapes(const std::vector<ShapeDescription>& shapes, const std::vector<std::string>& names,
                    const SceneDescription& scene, const std::vector<ObjectFacts>& objects) {
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (auto ok = check_shape(shapes[i], scene, objects); !ok) {
      const bool named = i < names.size() && !names[i].empty();
      return fail(ok.error().within(named ? names[i] : fmt::format("shapes[{}]", i)));
    }
  }
  return {};
}

Status check_object(const ObjectDescription& object, const SceneDescription& scene) {
  if (object.shapes.empty()) return invalid("needs at least one shape");
  for (const ShapeDescription& shape : object.shapes)
    if (std::holds_alternative<InstanceDescription>(shape))
      return invalid("an object cannot hold instances of others; write them among the scene's shapes");
  return check_shapes(object.shapes, object.shape_names, scene, {});
}

Status check_all_shapes(const SceneDescription& scene) {
  std::vector<ObjectFacts> objects;
  for (const ObjectDescription& object : scene.objects) {
    if (auto ok = check_object(object, scene); !ok)
      return fail(ok.error().within(fmt::format("object '{}'", object.name)));
    objects.push_back(facts_of(object));
  }
  return check_shapes(scene.shapes, scene.shape_names, scene, objects);
}

Status check_animation(const SceneDescription& scene) {
  const Animation& animation = scene.animation;
  if (!is_sound(animation))
    return invalid("animation: the frames of keyframes must be numbers that increase");
  for (const LightAnimation& light : animation.lights)
    if (light.light >= scene.lights.size())
      return invalid(fmt::format("animation: there is no light {}", light.light));
  for (const InstanceMotion& motion : animation.instances)
    if (motion.shape >= scene.shapes.size() ||
        !std::holds_alternative<InstanceDescription>(scene.shapes[motion.shape]))
      return invalid(fmt::format("animation: there is no instance {}", motion.shape));
  return {};
}

bool emits(const ShapeDescription& shape, const SceneDescription& scene) {
  const auto emissive = [&](std::uint32_t material) {
    return !is_black(scene.materials[material].emission.value);
  };
  return std::visit(Overloaded{[&](const MeshDescription& mesh) {
                                 return std::any_of(mesh.triangle_materials.begin(),
                                                    mesh.triangle_materials.end(), emissive);
                               },
                               [&](const SphereDescription& sphere) { return emissive(sphere.material); },
                               [&](const QuadDescription& quad) { return emissive(quad.material); },
                               [&](const DiskDescription& disk) { return emissive(disk.material); },
                               [&](const CylinderDescription& c) { return emissive(c.material); },
                               [&](const InstanceDescription& instance) {
                                 if (instance.material) return emissive(*instance.material);
                                 const auto& shapes = scene.objects[instance.object].shapes;
                                 return std::any_of(
                                     shapes.begin(), shapes.end(),
                                     [&](const ShapeDescription& part) { return emits(part, scene); });
                               }},
                    shape);
}

Rgb color_of(const LightDescription& light) {
  return std::visit(Overloaded{[](const PointLightDescription& d) { return d.intensity; },
                               [](const SpotLightDescription& d) { return d.intensity; },
                               [](const DirectionalLightDescription& d) { return d.irradiance; }},
                    light);
}

}  // namespace

Status validate_lights(const std::vector<LightDescription>& lights) {
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (auto ok = check_light(lights[i]); !ok) return fail(ok.error().within(fmt::format("lights[{}]", i)));
  return {};
}

PlacementLimits placement_limits(const SceneDescription& scene, const InstanceDescription& instance) {
  return limits_of(facts_of(scene.objects[instance.object]), instance, scene.materials);
}

Status validate_placement(const Transform& to_world, const PlacementLimits& limits) {
  if (!Placement::can_place(to_world))
    return invalid("the transform flattens the object, or scales or moves it too far to be computed");
  const Aabb box = Placement(to_world).bounds(limits.object_bounds);
  if (!fits(box.lower) || !fits(box.upper))
    return invalid(fmt::format("the object reaches farther than {:g} there", kMaxCoordinate));
  if (limits.must_stay_round && !(uniform_scale(to_world, kRoundToRounding) > 0))
    return invalid(
        "a sphere that emits must stay round: the transform must scale by the same factor in all directions");
  return {};
}

Status validate_scene(const SceneDescription& scene) {
  if (auto ok = check_settings(scene.settings); !ok) return fail(ok.error().within("render"));
  // Jobs stored by earlier releases may exceed the limit.
  if (scene.settings.max_depth > kMaxDepth)
    return invalid(fmt::format("render: max_depth: must be between 0 and {}, got {}", kMaxDepth,
                               scene.settings.max_depth));
  if (auto ok = check_display(scene.display); !ok) return fail(ok.error().within("output"));
  if (auto ok = validate_camera(scene.camera); !ok) return ok;
  if (auto ok = check_media(scene); !ok) return ok;
  if (auto ok = check_materials(scene); !ok) return ok;
  if (auto ok = validate_lights(scene.lights); !ok) return ok;
  if (auto ok = check_environment(scene); !ok) return ok;
  if (auto ok = check_all_shapes(scene); !ok) return ok;
  return check_animation(scene);
}

bool uses_media(const SceneDescription& scene) {
  return scene.camera_medium != kNoMedium ||
         std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& material) { return material.media.changes_medium(); });
}

bool gives_light(const SceneDescription& scene) {
  if (scene.environment && !is_black(scene.environment->radiance.value)) return true;
  for (const LightDescription& light : scene.lights)
    if (!is_black(color_of(light))) return true;
  // A light that is dark at frame 0 brightens later.
  for (const LightAnimation& light : scene.animation.lights)
    if (!light.color.empty()) return true;
  if (uses_media(scene) && std::any_of(scene.media.begin(), scene.media.end(), glows)) return true;
  return std::any_of(scene.shapes.begin(), scene.shapes.end(),
                     [&](const ShapeDescription& shape) { return emits(shape, scene); });
}

}  // namespace tessera::core
