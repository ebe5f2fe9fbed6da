// SPDX-License-Identifier: Apache-2.0
// Finds the materials of meshes in the MTL files that their OBJ files name, and the images that PLY files
// name, adds the used ones to the scene with their textures, and reports missing ones. Not thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/asset_cache.hpp"
#include "core/scene/loader/file_warnings.hpp"
#include "core/scene/loader/mesh_file.hpp"
#include "core/scene/loader/mtl_material.hpp"
#include "core/scene/tables/shape_tables.hpp"

namespace tessera::core {

class ObjMaterials {
 public:
  // All arguments must outlive this object.
  ObjMaterials(AssetCache& cache, SceneDescription& scene, SceneWarnings& warnings)
      : cache_(cache), scene_(scene), warnings_(warnings) {}

  // The scene's material for each run of the file's triangles. `gaps` is the material of triangles whose
  // own is unknown; if it is not set, a default material is used, with the vertex colours if there are some
  // and `colors` does not ignore them. Fails only if the scene exceeds the limits.
  Result<std::vector<std::uint32_t>> of_runs(const std::string& path, const ObjFile& obj,
                                             std::optional<std::uint32_t> gaps,
                                             VertexColors colors = VertexColors::kUse);

  // The scene's material for each triangle of a PLY file, or one for all: diffuse with its image, which
  // replaces vertex colours. `gaps` is as above. Fails only if the scene exceeds the limits.
  Result<std::vector<std::uint32_t>> of_images(const std::string& path, MeshFile& file,
                                               std::optional<std::uint32_t> gaps);

  // Sets the height of bump maps of materials that `mesh` uses first, because MTL files define no unit for
  // it.
  void settle_bump_heights(const MeshDescription& mesh);

  // Of meshes without material; the same at each call.
  std::uint32_t default_material(bool is_colored);

 private:
  // By path, in the order of the "mtllib" lines.
  using Libraries = std::vector<std::pair<std::string, std::shared_ptr<const MtlFile>>>;
  struct Found {
    std::string library;
    const MtlMaterial* material;
  };
  using Names = std::map<std::string, Found, std::less<>>;
  using Image = std::shared_ptr<const TextureImage>;

  static Names names_in(const Libraries& libraries);
  Libraries load_libraries(const ObjFile& obj);
  // Returns whether the file exists.
  bool add_library(const std::string& name, int line, Libraries& libraries);
  void tell_other_name(const std::string& file, int line, const std::string& written,
                       const std::string& expected, const std::string& found);
  void tell_gap(const ObjFile& obj, std::size_t run, const Names& names, std::string_view filler);
  void tell_missing_uvs(const ObjFile& obj, std::size_t run, std::uint32_t material);
  Result<std::uint32_t> add_material(const Found& found);
  // The material of the image that a PLY file calls `name`; nullopt if it cannot be used.
  Result<std::optional<std::uint32_t>> add_image_material(const std::string& name);
  Result<std::vector<std::optional<std::uint32_t>>> add_image_materials(const MeshFile& file);
  void tell_unused(const MtlMaterial& material, const Material& added);
  // The image of a map, or null if it has none that can be used.
  Result<Image> load(const MtlMaterial::Map& map, std::optional<ColorSpace> color_space = std::nullopt,
                     TextureChannel channel = TextureChannel::kColor);
  Result<Image> load_share(const MtlMaterial::Map& map, std::optional<ColorSpace> color_space = std::nullopt);
  int add_texture(const Image& image, const MtlMaterial::Map& map);
  Result<MtlTextures> add_textures(const MtlMaterial& material);
  Status add_numbers(const MtlMaterial& material, MtlTextures& textures);
  Status add_opacity(const MtlMaterial& material, MtlTextures& textures);
  Status add_bump(const MtlMaterial& material, MtlTextures& textures);

  // Warns once for each OBJ file, however many shapes use it.
  template <typename Text>
  void warn(const std::string& file, std::string_view kind, int line, const Text& text,
            std::uint64_t count = 1, std::string_view unit = "times") {
    if (tells_) warnings_.of(file).add(kind, line, text, count, unit);
  }

  AssetCache& cache_;
  SceneDescription& scene_;
  SceneWarnings& warnings_;
  std::string obj_, library_;  // the files whose materials are being added
  bool tells_ = true;
  std::set<std::string> told_;                                          // OBJ files
  std::set<std::pair<std::string, std::string>> told_names_;            // files, and names in them
  std::map<std::pair<std::string, std::string>, std::uint32_t> known_;  // by library and name
  std::map<Image, Image> clamped_;              // images of reflectances with values above 1
  std::map<bool, std::uint32_t> defaults_;      // for meshes without and with vertex colours
  std::set<std::uint32_t> with_images_;         // materials
  std::vector<std::uint32_t> unsettled_bumps_;  // materials
};

}  // namespace tessera::core
