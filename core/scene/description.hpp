// SPDX-License-Identifier: Apache-2.0
// A scene as its file tells it, after assets are read and transforms applied: plain data in world space,
// not yet validated as a whole. Scene::build turns it into what is rendered.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/camera/camera_description.hpp"
#include "core/image/display.hpp"
#include "core/materials/material.hpp"
#include "core/math/transform.hpp"
#include "core/math/vec3.hpp"
#include "core/scene/settings.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

struct MeshDescription {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  // one per position, need not be unit length; or empty: flat shading
  std::vector<Vec2> uvs;      // one per position; or empty
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from outside
  std::vector<std::uint32_t> triangle_materials;        // one per triangle, or a single one for all
  // Linear colours from 0 to 1, one per position; or empty. They are interpolated over triangles and multiply
  // the base colour of the material: Lambert's albedo, Mirror's reflectance, the diffuse part of Phong and
  // CookTorrance, and f0 of a CookTorrance without diffuse part. Glass and conductors ignore them.
  std::vector<Rgb> colors{};
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

// An object shown once more: all of its shapes, as `to_world` places them.
struct InstanceDescription {
  std::uint32_t object = 0;
  Transform to_world;
  std::optional<std::uint32_t> material;  // of all of it; nullopt: those of its shapes
};

using ShapeDescription =
    std::variant<MeshDescription, SphereDescription, QuadDescription, InstanceDescription>;

// Shapes that are seen only where instances show them, stored once however many of those there are.
struct ObjectDescription {
  std::string name;
  std::vector<ShapeDescription> shapes;  // no instances
  std::vector<std::string> shape_names;  // one per shape, for error messages
};

struct PointLightDescription {
  Vec3 position;
  Rgb intensity;  // watts per steradian
};

struct SpotLightDescription {
  Vec3 position, look_at;
  Rgb intensity;             // watts per steradian, in the middle of the cone
  float angle_degrees = 45;  // of the whole cone
  float softness = 0.2f;     // the share of the cone, from its edge inwards, over which light falls off
};

struct DirectionalLightDescription {
  Vec3 direction;  // the way light travels; need not be of unit length
  Rgb irradiance;  // of a surface that faces the light
};

using LightDescription =
    std::variant<PointLightDescription, SpotLightDescription, DirectionalLightDescription>;

// What rays that meet nothing see.
struct EnvironmentDescription {
  ColorParameter radiance;  // a texture is equirectangular; of it, only the picture counts
  float rotation_degrees = 0;
};

struct SceneDescription {
  RenderSettings settings;
  CameraDescription camera;
  DisplaySettings display;  // of PNG files; linear ones are left alone
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<ObjectDescription> objects;
  std::vector<ShapeDescription> shapes;
  std::vector<std::string> shape_names;  // one per shape, for error messages: "shapes[2] (bunny.obj)"
  std::vector<LightDescription> lights;  // besides emissive shapes
  std::optional<EnvironmentDescription> environment;
  std::vector<std::string> warnings;  // what other programs' files lack, and what is used instead
};

}  // namespace tessera::core
