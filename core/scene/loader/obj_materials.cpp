// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/obj_materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/validate_materials.hpp"

namespace tessera::core {
namespace {

// The height of a full-range bump map, relative to the length of one repeat of its texture.
constexpr float kBumpHeight = 0.02f;

std::size_t end_of_run(const ObjFile& obj, std::size_t run) {
  return run + 1 < obj.runs.size() ? obj.runs[run + 1].first_triangle : obj.triangle_count();
}

// Distinguishes normal maps, whose pixels are mostly near (0.5, 0.5, 1), from height maps, which are grey.
bool is_normal_map(const TextureImage& image) {
  const Rgb mean = image.mean();
  constexpr float kTolerance = 0.15f;
  return std::fabs(mean.r - 0.5f) < kTolerance && std::fabs(mean.g - 0.5f) < kTolerance && mean.b > 0.75f;
}

bool is_one(const TextureImage& image) {
  return image.width() == 1 && image.height() == 1 && image.largest().r >= 1;
}

// The image with every channel at most 1, and the number of texels that this changed.
std::pair<TextureImage, std::uint64_t> clamped_to_one(const TextureImage& image) {
  std::vector<float> values;
  values.reserve(3 * static_cast<std::size_t>(image.width()) * static_cast<std::size_t>(image.height()));
  std::uint64_t changed = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const Rgb texel = image.texel(x, y);
      changed += max_component(texel) > 1 ? 1 : 0;
      for (const float channel : {texel.r, texel.g, texel.b}) values.push_back(std::min(channel, 1.0f));
    }
  return {TextureImage(image.width(), image.height(), std::move(values)), changed};
}

// The mean world-space length over which the texture coordinates of the material's triangles grow by 1; 0
// if there are none.
double texture_length(const MeshDescription& mesh, std::uint32_t material, Vec2 texture_scale) {
  double area = 0, uv_area = 0;
  const bool one_material = mesh.triangle_materials.size() == 1;
  for (std::size_t t = 0; t < mesh.triangles.size() && !mesh.uvs.empty(); ++t) {
    if (mesh.triangle_materials[one_material ? 0 : t] != material) continue;
    const auto [a, b, c] = mesh.triangles[t];
    const Vec3 p = mesh.positions[a];
    const Vec2 uv = mesh.uvs[a], u = mesh.uvs[b], v = mesh.uvs[c];
    area += double{length(cross(mesh.positions[b] - p, mesh.positions[c] - p))};
    uv_area += std::fabs(double{u.x - uv.x} * double{v.y - uv.y} - double{u.y - uv.y} * double{v.x - uv.x});
  }
  uv_area *= std::fabs(double{texture_scale.x} * double{texture_scale.y});
  const double length = std::sqrt(area / uv_area);
  return std::isfinite(length) ? length : 0;
}

}  // namespace

Result<std::vector<std::uint32_t>> ObjMaterials::of_runs(const std::string& path, const ObjFile& obj,
                                                         std::optional<std::uint32_t> gaps,
                                                         VertexColors colors) {
  obj_ = path;
  tells_ = told_.insert(path).second;
  const Names names = names_in(load_libraries(obj));
  const bool is_colored = colors == VertexColors::kUse && !obj.text.colors.empty();
  const std::string_view filler = gaps         ? "'default_material' is used"
                                  : is_colored ? "a white lambert with the vertex colours is used"
                                               : "the default material, a mid-grey lambert, is used";
  std::vector<std::uint32_t> materials;
  for (std::size_t run = 0; run < obj.runs.size(); ++run) {
    const std::uint32_t index = obj.runs[run].material;
    auto found = names.end();
    if (index != kNoMaterialName) found = names.find(obj.material_names[index]);
    if (index != kNoMaterialName && found == names.end())
      found = names.find(name_without_comment(obj.material_names[index]));
    if (found == names.end()) {
      if (index != kNoMaterialName || !gaps) tell_gap(obj, run, names, filler);
      materials.push_back(gaps ? *gaps : default_material(is_colored));
      continue;
    }
    const auto material = add_material(found->second);
    if (!material) return fail(material.error());
    tell_missing_uvs(obj, run, *material);
    materials.push_back(*material);
  }
  return materials;
}

void ObjMaterials::tell_missing_uvs(const ObjFile& obj, std::size_t run, std::uint32_t material) {
  if (!with_images_.contains(material)) return;
  const auto& uvs = obj.corners.uvs;
  std::size_t missing = 0;
  for (std::size_t t = obj.runs[run].first_triangle; t < end_of_run(obj, run); ++t)
    missing += uvs.empty() || uvs[3 * t] < 0 || uvs[3 * t + 1] < 0 || uvs[3 * t + 2] < 0 ? 1 : 0;
  if (missing == 0) return;
  const std::string& name = scene_.materials[material].name;
  const auto text = [&] {
    return fmt::format("{} has images, and faces of it have no texture coordinates; they show a single texel",
                       in_quotes(name));
  };
  warn(obj_, "no uvs " + name, obj.material_lines[obj.runs[run].material], text, missing, "triangles");
}

// Among equal names of a file the last wins, and among those of several files the first. A name that may end
// with a comment is first used as written, then without the comment if no other material has that name.
ObjMaterials::Names ObjMaterials::names_in(const Libraries& libraries) {
  Names names, without_comments;
  for (const auto& [path, file] : libraries) {
    for (auto material = file->materials.rbegin(); material != file->materials.rend(); ++material) {
      names.emplace(material->name, Found{path, &*material});
      without_comments.emplace(name_without_comment(material->name), Found{path, &*material});
    }
  }
  names.merge(without_comments);
  return names;
}

// A line is one name with blanks in it, or several names.
ObjMaterials::Libraries ObjMaterials::load_libraries(const ObjFile& obj) {
  Libraries libraries;
  for (const auto& [name, line] : obj.text.libraries) {
    if (add_library(name, line, libraries)) continue;
    std::vector<std::string> words;
    std::string_view rest = name_without_comment(name);
    for (auto word = take_word(rest); !word.empty(); word = take_word(rest)) words.emplace_back(word);
    for (const std::string& word : words)
      if (words.size() == 1 || !add_library(word, line, libraries))
        warn(obj_, "missing library " + word, line, [&] {
          return fmt::format(
              "{} does not exist, and neither does a file of this name beside the OBJ file; its "
              "materials are missing",
              in_quotes(word));
        });
  }
  return libraries;
}

bool ObjMaterials::add_library(const std::string& name, int line, Libraries& libraries) {
  const std::string written(without_quotes(name));
  const auto path = cache_.find(written, {obj_});
  if (!path) return false;
  const auto file = cache_.mtl(*path);
  if (!file) {
    warn(obj_, "unreadable library " + *path, line,
         [&] { return file.error().message + "; its materials are missing"; });
    return true;
  }
  tell_other_name(obj_, line, written, path_beside(obj_, written), *path);
  if (!warnings_.knows(*path)) warnings_.of(*path) = (*file)->warnings;
  libraries.emplace_back(*path, *file);
  return true;
}

void ObjMaterials::tell_other_name(const std::string& file, int line, const std::string& written,
                                   const std::string& expected, const std::string& found) {
  if (found == expected || path_beside(file, std::string(name_without_comment(written))) == found) return;
  // An image is loaded twice, for colour and for alpha, but reported once.
  if (!told_names_.emplace(file, written).second) return;
  warn(file, "other name", line,
       [&] { return fmt::format("{} does not exist; {} is used", in_quotes(written), in_quotes(found)); });
}

void ObjMaterials::tell_gap(const ObjFile& obj, std::size_t run, const Names& names,
                            std::string_view filler) {
  const std::uint32_t index = obj.runs[run].material;
  const std::size_t triangles = end_of_run(obj, run) - obj.runs[run].first_triangle;
  if (index == kNoMaterialName) {
    const auto text = [&] { return fmt::format("no 'usemtl' gives this face a material; {}", filler); };
    warn(obj_, "no material", run == 0 ? obj.text.first_face_line : 0, text, triangles, "triangles");
    return;
  }
  const auto text = [&] {
    std::vector<std::string_view> known;
    for (const auto& [name, found] : names) known.push_back(name);
    const std::string& name = obj.material_names[index];
    return fmt::format("there is no material {}{}{}; {}", in_quotes(name),
                       names.empty() ? "" : " in the 'mtllib' files", suggestion(name, known), filler);
  };
  warn(obj_, "unknown material", obj.material_lines[index], text, triangles, "triangles");
}

std::uint32_t ObjMaterials::default_material(bool is_colored) {
  const Rgb albedo = is_colored ? Rgb::gray(1) : kDefaultDiffuse;
  const auto [known, is_new] =
      defaults_.emplace(is_colored, static_cast<std::uint32_t>(scene_.materials.size()));
  if (is_new) scene_.materials.push_back({"default material", Lambert{{albedo, -1}}});
  return known->second;
}

Result<std::uint32_t> ObjMaterials::add_material(const Found& found) {
  const auto& [library, material] = found;
  const auto known = known_.find({library, material->name});
  if (known != known_.end()) return known->second;
  library_ = library;
  const std::size_t textures_before = scene_.textures.size();
  const auto textures = add_textures(*material);
  if (!textures) return fail(textures.error());
  const auto index = static_cast<std::uint32_t>(scene_.materials.size());
  if (scene_.textures.size() > textures_before) with_images_.insert(index);
  Material added = make_material(*material, *textures);
  added.name = library + ": " + added.name;
  tell_unused(*material, added);
  for (const std::string_view key : clamp_to_ranges(added))
    warn(library, key, 0, [&] { return clamped_text(added.name, key); });
  if (added.bump.texture >= 0) unsettled_bumps_.push_back(index);
  scene_.materials.push_back(std::move(added));
  known_.emplace(std::pair(library, material->name), index);
  return index;
}

// What was read and has no effect on this material.
void ObjMaterials::tell_unused(const MtlMaterial& material, const Material& added) {
  const Rgb filter = material.transmission.value_or(Rgb{});
  const bool is_filtering = !is_black(filter) && filter != Rgb::gray(1);
  if (is_filtering && is_opaque(added, scene_.materials) && !transmits_light(added.model))
    warn(library_, "Tf", 0, [] { return "'Tf' is used for materials that transmit light only"; });
}

// Returns null with a warning if the image cannot be used. Fails only if a limit is exceeded.
Result<ObjMaterials::Image> ObjMaterials::load(const MtlMaterial::Map& map,
                                               std::optional<ColorSpace> color_space,
                                               TextureChannel channel) {
  if (!map) return nullptr;
  const auto path = cache_.find(map->file, {library_, obj_});
  if (!path) {
    warn(library_, "missing image " + map->file, map->line, [&] {
      return fmt::format(
          "{} does not exist, and neither does a file of this name beside the file; the map is ignored",
          in_quotes(map->file));
    });
    return nullptr;
  }
  auto image = cache_.image(*path, color_space, channel);
  if (!image && image.error().code == ErrorCode::kResourceExhausted)
    return fail(image.error().within(fmt::format("{}:{}", library_, map->line)));
  if (!image) {
    warn(library_, "unreadable image " + *path, map->line,
         [&] { return image.error().message + "; the map is ignored"; });
    return nullptr;
  }
  tell_other_name(library_, map->line, map->file, path_beside(library_, map->file), *path);
  return *image;
}

// Loads the image of a reflectance. Texels above 1 are clamped.
Result<ObjMaterials::Image> ObjMaterials::load_share(const MtlMaterial::Map& map,
                                                     std::optional<ColorSpace> color_space) {
  auto image = load(map, color_space);
  if (!image || !*image || max_component((*image)->largest()) <= 1) return image;
  const auto known = clamped_.find(*image);
  if (known != clamped_.end()) return known->second;
  const TextureSize size{(*image)->width(), (*image)->height()};
  if (auto counted = cache_.count_pixels(map->file, size); !counted)
    return fail(counted.error().within(fmt::format("{}:{}", library_, map->line)));
  auto [clamped, changed] = clamped_to_one(**image);
  const auto text = [&] {
    return fmt::format(
        "{} has values above 1, and nothing reflects more light than it gets; they are clamped",
        in_quotes(map->file));
  };
  warn(library_, "bright image " + map->file, map->line, text, changed, "texels");
  return clamped_.emplace(*image, std::make_shared<const TextureImage>(std::move(clamped))).first->second;
}

int ObjMaterials::add_texture(const Image& image, const MtlMaterial::Map& map) {
  if (!image) return -1;
  scene_.textures.push_back({image, map->clamp ? Wrap::kClamp : Wrap::kRepeat, map->scale, map->offset});
  return static_cast<int>(scene_.textures.size()) - 1;
}

Result<MtlTextures> ObjMaterials::add_textures(const MtlMaterial& material) {
  MtlTextures textures;
  // The meaning of an image determines its colour space.
  struct ColorUse {
    const MtlMaterial::Map& map;
    int& texture;
    std::optional<ColorSpace> color_space;
    bool is_share;
  };
  constexpr auto kLinear = ColorSpace::kLinear;
  for (const ColorUse& use : {ColorUse{material.diffuse_map, textures.diffuse, std::nullopt, true},
                              ColorUse{material.specular_map, textures.specular, kLinear, true},
                              ColorUse{material.emission_map, textures.emission, std::nullopt, false},
                              ColorUse{material.normal_map, textures.normal, kLinear, false}}) {
    const auto image = use.is_share ? load_share(use.map, use.color_space) : load(use.map, use.color_space);
    if (!image) return fail(image.error());
    use.texture = add_texture(*image, use.map);
  }
  for (const auto add : {&ObjMaterials::add_numbers, &ObjMaterials::add_opacity, &ObjMaterials::add_bump})
    if (auto added = (this->*add)(material, textures); !added) return fail(added.error());
  return textures;
}

// Blender writes its roughness as map_Ns.
Status ObjMaterials::add_numbers(const MtlMaterial& material, MtlTextures& textures) {
  struct NumberUse {
    const MtlMaterial::Map& map;
    int& texture;
  };
  const auto& roughness = material.roughness_map ? material.roughness_map : material.exponent_map;
  for (const NumberUse& use :
       {NumberUse{roughness, textures.roughness}, NumberUse{material.metallic_map, textures.metallic},
        NumberUse{material.coat_map, textures.coat},
        NumberUse{material.coat_roughness_map, textures.coat_roughness},
        NumberUse{material.sheen_map, textures.sheen}}) {
    if (!use.map) continue;
    const auto image = load(use.map, ColorSpace::kLinear, use.map->channel);
    if (!image) return fail(image.error());
    use.texture = add_texture(*image, use.map);
  }
  return {};
}

// The channel of map_d that the file names; else its alpha, if it has any, or its red channel. Without map_d,
// the alpha of map_Kd.
Status ObjMaterials::add_opacity(const MtlMaterial& material, MtlTextures& textures) {
  const bool has_own_map = material.dissolve_map.has_value();
  const auto& map = has_own_map ? material.dissolve_map : material.diffuse_map;
  if (!has_own_map && textures.diffuse < 0) return {};
  const bool has_channel = has_own_map && map->channel != TextureChannel::kColor;
  auto image = has_channel ? load(map, ColorSpace::kLinear, map->channel)
                           : load(map, std::nullopt, TextureChannel::kAlpha);
  if (!image) return fail(image.error());
  if (!has_channel && *image && is_one(**image)) {
    if (!has_own_map) return {};
    image = load(map, ColorSpace::kLinear);
    if (!image) return fail(image.error());
  }
  textures.opacity = add_texture(*image, map);
  return {};
}

// Programs write both normal maps and height maps as "bump".
Status ObjMaterials::add_bump(const MtlMaterial& material, MtlTextures& textures) {
  const auto image = load(material.bump_map, ColorSpace::kLinear);
  if (!image) return fail(image.error());
  if (!*image) return {};
  if (!is_normal_map(**image)) {
    const auto heights = load(material.bump_map, ColorSpace::kLinear, material.bump_map->channel);
    if (!heights) return fail(heights.error());
    textures.bump = add_texture(*heights, material.bump_map);
  } else if (textures.normal < 0) {
    textures.normal = add_texture(*image, material.bump_map);
  }
  return {};
}

void ObjMaterials::settle_bump_heights(const MeshDescription& mesh) {
  for (const std::uint32_t index : unsettled_bumps_) {
    BumpMap& bump = scene_.materials[index].bump;
    const Vec2 scale = scene_.textures[static_cast<std::size_t>(bump.texture)].scale;
    bump.height *= kBumpHeight * static_cast<float>(texture_length(mesh, index, scale));
    if (!std::isfinite(bump.height)) bump.height = 0;
  }
  unsettled_bumps_.clear();
}

}  // namespace tessera::core
