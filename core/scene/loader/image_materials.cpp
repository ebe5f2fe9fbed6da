// SPDX-License-Identifier: Apache-2.0
// The materials of PLY files that name images ("comment TextureFile").
#include <fmt/format.h>

#include <algorithm>

#include "core/scene/loader/obj_materials.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {

Result<std::vector<std::uint32_t>> ObjMaterials::of_images(const std::string& path, MeshFile& file,
                                                           std::optional<std::uint32_t> gaps) {
  obj_ = library_ = path;
  tells_ = told_.insert(path).second;
  const auto materials = add_image_materials(file);
  if (!materials) return fail(materials.error());
  const bool has_image =
      std::ranges::any_of(*materials, [](const auto& material) { return material.has_value(); });
  if (has_image && !file.mesh.colors.empty()) {
    warn(path, "colours", 0, [] { return "has images, so that its vertex colours are not used"; });
    file.mesh.colors = {};
  }
  const auto material_of = [&](std::uint32_t image) {
    if (image >= file.images.size() && !file.images.empty())
      warn(
          path, "texnumber", 0,
          [] { return "'texnumber' of a face names no image; the default material is used"; }, 1,
          "triangles");
    if (image < materials->size() && (*materials)[image]) return *(*materials)[image];
    return gaps ? *gaps : default_material(!file.mesh.colors.empty());
  };
  std::vector<std::uint32_t> of_triangles;
  for (const std::uint32_t image : file.triangle_images) of_triangles.push_back(material_of(image));
  if (of_triangles.empty()) of_triangles.push_back(material_of(0));
  return of_triangles;
}

Result<std::vector<std::optional<std::uint32_t>>> ObjMaterials::add_image_materials(const MeshFile& file) {
  std::vector<std::optional<std::uint32_t>> materials;
  if (!file.images.empty() && file.mesh.uvs.empty()) {
    warn(library_, "no uvs", 0, [&] {
      return fmt::format("has no texture coordinates for the image {}; it is ignored",
                         in_quotes(file.images[0]));
    });
    return materials;
  }
  const std::size_t used = file.triangle_images.empty() ? 1 : file.images.size();
  if (used < file.images.size())
    warn(library_, "images", 0, [&] {
      return fmt::format("names {} images, and no 'texnumber' gives a face one of them; the first is used",
                         file.images.size());
    });
  for (std::size_t i = 0; i < std::min(used, file.images.size()); ++i) {
    const auto material = add_image_material(file.images[i]);
    if (!material) return fail(material.error());
    materials.push_back(*material);
  }
  return materials;
}

Result<std::optional<std::uint32_t>> ObjMaterials::add_image_material(const std::string& name) {
  MtlMaterial material;
  material.name = name;
  material.diffuse = Rgb::gray(1);
  material.diffuse_map = MtlMap{.file = name};
  const auto image = load_share(material.diffuse_map);
  if (!image) return fail(image.error());
  if (!*image) return std::nullopt;
  const auto added = add_material({library_, &material});
  if (!added) return fail(added.error());
  return *added;
}

}  // namespace tessera::core
