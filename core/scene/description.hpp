// SPDX-License-Identifier: Apache-2.0
// A scene as its file describes it, after assets are read and transforms applied: plain data in world
// space, not yet validated as a whole. Scene::build converts it for rendering.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/camera/camera_description.hpp"
#include "core/geometry/curves.hpp"
#include "core/geometry/surface.hpp"
#include "core/geometry/vertex_motion.hpp"
#include "core/image/display.hpp"
#include "core/lights/spot_description.hpp"
#include "core/materials/material.hpp"
#include "core/math/transform.hpp"
#include "core/math/vec3.hpp"
#include "core/media/medium_description.hpp"
#include "core/media/voxel_grid.hpp"
#include "core/scene/animation.hpp"
#include "core/scene/scene_contents.hpp"
#include "core/scene/settings.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

struct MeshDescription {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  // one per position, need not be unit length; or empty: flat shading
  std::vector<Vec2> uvs;      // one per position; or empty
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from outside
  std::vector<std::uint32_t> triangle_materials;        // one per triangle, or one for all
  // Linear colours from 0 to 1, one per position; or empty. They are interpolated over triangles and
  // multiply the material's base colour: Lambert's albedo, Mirror's reflectance, the diffuse part of Phong
  // and CookTorrance, and f0 of a CookTorrance without diffuse part. Glass and conductors ignore them.
  std::vector<Rgb> colors{};
  // Of a mesh that deforms, all of its frames, which must be sound; else empty. `positions` and `normals` are
  // then those at frame 0. Such a mesh cannot emit.
  std::vector<MeshStep> steps{};
  // A second set of texture coordinates, one per position, beside `uvs`; or empty: then `uvs` count as both.
  std::vector<Vec2> second_uvs{};
  // One per position, of any length but 0; or empty. Normal maps and anisotropic highlights follow them
  // instead of the texture coordinates, whatever set or transform their images have.
  std::vector<VertexTangent> tangents{};
};

struct SphereDescription {
  Vec3 center;
  float radius = 1;
  std::uint32_t material = 0;
};

// The parallelogram corner + s * edge_u + t * edge_v, 0 <= s, t <= 1, with uv = (s, t). Its normal is
// edge_u x edge_v.
struct QuadDescription {
  Vec3 corner, edge_u, edge_v;
  std::uint32_t material = 0;
};

// A disk or a ring, in general an ellipse: the points center + r (cos(a) radius_u + sin(a) radius_v) with
// inner <= r <= 1, and uv = (a / 2 pi, (1 - r) / (1 - inner)). Its normal is radius_u x radius_v.
struct DiskDescription {
  Vec3 center{};
  Vec3 radius_u{1, 0, 0}, radius_v{0, 1, 0};
  float inner = 0;       // 0 <= inner < 1
  bool flipped = false;  // the normal is -radius_u x radius_v
  std::uint32_t material = 0;
};

// The lateral surface of a cylinder, without caps; in general elliptic and oblique: the points
// start + z axis + cos(a) radius_u + sin(a) radius_v with 0 <= z <= 1, and uv = (a / 2 pi, z). Its normal
// points away from the axis.
struct CylinderDescription {
  Vec3 start{};
  Vec3 axis{0, 0, 1};
  Vec3 radius_u{1, 0, 0}, radius_v{0, 1, 0};
  bool flipped = false;  // the normal points to the axis
  std::uint32_t material = 0;
};

// Curves that are swept by a radius: hair, grass, wires. They cannot emit.
struct CurvesDescription {
  CurveStrands strands{};
  std::uint32_t material = 0;
};

// An instance of an object: all of its shapes, placed by `to_world`.
struct InstanceDescription {
  std::uint32_t object = 0;
  Transform to_world;
  std::optional<std::uint32_t> material;  // replaces the materials of all its shapes
};

using ShapeDescription =
    std::variant<MeshDescription, SphereDescription, QuadDescription, InstanceDescription, DiskDescription,
                 CylinderDescription, CurvesDescription>;

// Whether it is a mesh that deforms.
inline bool deforms(const ShapeDescription& shape) {
  const auto* mesh = std::get_if<MeshDescription>(&shape);
  return mesh != nullptr && !mesh->steps.empty();
}

// Shapes that are rendered only through instances, stored once.
struct ObjectDescription {
  std::string name;
  std::vector<ShapeDescription> shapes;  // no instances
  std::vector<std::string> shape_names;  // one per shape, for error messages
};

struct PointLightDescription {
  Vec3 position;
  Rgb intensity;  // watts per steradian
  // The index of an equirectangular image that multiplies it by direction, -1 for none, and the rotation or
  // reflection from the space in which its centre is at -z and its upper edge at +y to the world.
  int texture = -1;
  Transform orientation{};
  std::string light_group{};  // empty for none, here and below
};

struct SpotLightDescription {
  Vec3 position, look_at;
  Rgb intensity;             // watts per steradian, on the axis
  float angle_degrees = 45;  // full angle of the cone
  float softness = 0.2f;     // fraction of the cone, from its edge inwards, with falloff
  lights::SpotFalloff falloff = lights::SpotFalloff::kSmooth;
  lights::ProjectedImage image{};
  std::string light_group{};
};

struct DirectionalLightDescription {
  Vec3 direction;  // the direction of travel; need not have unit length
  Rgb irradiance;  // of a surface that faces the light
  std::string light_group{};
};

using LightDescription =
    std::variant<PointLightDescription, SpotLightDescription, DirectionalLightDescription>;

inline const std::string& light_group_of(const LightDescription& light) {
  return std::visit([](const auto& of_type) -> const std::string& { return of_type.light_group; }, light);
}

// The radiance of rays that escape the scene.
struct EnvironmentDescription {
  ColorParameter radiance;     // a texture is equirectangular; only its image is used
  float rotation_degrees = 0;  // about +y, counter-clockwise seen from above
  // A rotation, also a reflection, that is applied after rotation_degrees: from the space in which the centre
  // of the image is at -z and its upper edge at +y to the world. The origin has no effect.
  Transform orientation{};
  bool visible_to_camera = true;  // else camera rays that miss all shapes are black
  std::string light_group{};
};

struct SceneDescription {
  RenderSettings settings;
  CameraDescription camera;
  int camera_medium = kNoMedium;  // index of the medium around the camera
  DisplaySettings display;        // of PNG files only
  std::vector<Texture> textures;
  std::vector<VoxelGrid> grids;  // of media
  std::vector<MediumDescription> media;
  std::vector<Material> materials;
  std::vector<ObjectDescription> objects;
  std::vector<ShapeDescription> shapes;
  std::vector<std::string> shape_names;  // one per shape, for error messages: "shapes[2] (bunny.obj)"
  std::vector<LightDescription> lights;  // besides emissive shapes
  std::optional<EnvironmentDescription> environment;
  // The parameters that change from frame to frame. The others describe all frames, and these frame 0.
  Animation animation;
  SceneContents contents;             // what there was to choose; the scene does not depend on it
  std::vector<std::string> warnings;  // defects of other programs' files, and the substitutions made
};

}  // namespace tessera::core
