// A scene as its file tells it, after assets are read and transforms applied: plain data in world space,
// not yet validated as a whole. Scene::build turns it into what is rendered.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/camera/camera_description.hpp"
#include "core/image/display.hpp"
#include "core/materials/material.hpp"
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

using ShapeDescription = std::variant<MeshDescription, SphereDescription, QuadDescription>;

struct SceneDescription {
  RenderSettings settings;
  CameraDescription camera;
  DisplaySettings display;  // of PNG files; linear ones are left alone
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<ShapeDescription> shapes;
  std::vector<std::string> shape_names;  // one per shape, for error messages: "shapes[2] (bunny.obj)"
};

}  // namespace tessera::core
