// SPDX-License-Identifier: Apache-2.0
#include "scenes/modelling/files.hpp"

#include <fmt/format.h>

#include <iterator>

#include "core/image/srgb.hpp"

namespace tessera::modelling {
namespace {

using core::MeshDescription;

void append_triangles(std::string& text, const MeshDescription& mesh, std::size_t material) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (mesh.triangle_materials.size() > 1 && mesh.triangle_materials[i] != material) continue;
    const auto [a, b, c] = mesh.triangles[i];
    if (mesh.uvs.empty()) {
      fmt::format_to(std::back_inserter(text), "f {0}//{0} {1}//{1} {2}//{2}\n", a + 1, b + 1, c + 1);
    } else {
      fmt::format_to(std::back_inserter(text), "f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", a + 1, b + 1,
                     c + 1);
    }
  }
}

}  // namespace

std::string obj_text(const MeshDescription& mesh, const std::vector<std::string>& material_names,
                     const std::string& mtl_file) {
  std::string text;
  const auto out = std::back_inserter(text);
  if (!material_names.empty()) fmt::format_to(out, "mtllib {}\n", mtl_file);
  for (const core::Vec3 p : mesh.positions) fmt::format_to(out, "v {:.5f} {:.5f} {:.5f}\n", p.x, p.y, p.z);
  for (const core::Vec2 t : mesh.uvs) fmt::format_to(out, "vt {:.5f} {:.5f}\n", t.x, t.y);
  for (const core::Vec3 n : mesh.normals) fmt::format_to(out, "vn {:.4f} {:.4f} {:.4f}\n", n.x, n.y, n.z);
  if (material_names.empty()) append_triangles(text, mesh, 0);
  for (std::size_t i = 0; i < material_names.size(); ++i) {
    fmt::format_to(out, "usemtl {}\n", material_names[i]);
    append_triangles(text, mesh, i);
  }
  return text;
}

core::Image paint(int width, int height, const std::function<core::Rgb(float u, float v)>& color) {
  core::Image image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width);
      const float v = 1 - (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
      image.at(x, y) = color(u, v);
    }
  }
  return image;
}

core::Rgb srgb(unsigned hex) {
  const auto channel = [hex](int shift) {
    return core::srgb_decode(static_cast<std::uint8_t>(hex >> shift));
  };
  return {channel(16), channel(8), channel(0)};
}

}  // namespace tessera::modelling
