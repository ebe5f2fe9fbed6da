// SPDX-License-Identifier: Apache-2.0
// The materials of a scene, converted to ours. Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/materials/material.hpp"
#include "core/scene/pbrt/colors.hpp"
#include "core/scene/pbrt/report.hpp"
#include "core/scene/pbrt/texture_baker.hpp"
#include "core/scene/pbrt/textures.hpp"

namespace tessera::core::pbrt {

class Materials {
 public:
  // The arguments must outlive this object.
  Materials(SceneBuilder& builder, const Report& report, Colors& colors, Textures& textures,
            TextureBaker& baker)
      : builder_(builder), report_(report), colors_(colors), textures_(textures), baker_(baker) {}

  // Converts a material; its index for at(). The type "" or "interface" is Null. Types that are not supported
  // become gray, with a warning. Fails for textures beyond the limits.
  // Cryptomatte calls it by `name`; without one, by its type and number.
  Result<int> add(const std::string& type, const Parameters& p, const std::string& name = {});
  // Names it for find(), also for the parts of later mixtures. False if another one had the name.
  bool set_name(const std::string& name, int index) { return names_.insert_or_assign(name, index).second; }
  std::optional<int> find(const std::string& name) const;
  // The gray material of shapes that were given none.
  int default_material();

  // Without emission, opacity and media, which are those of a shape.
  const Material& at(int index) const { return materials_[static_cast<std::size_t>(index)]; }
  bool is_textured(int index) const { return textured_[static_cast<std::size_t>(index)]; }

 private:
  using Model = Result<MaterialModel>;

  Model model(const std::string& type, const Parameters& p);
  Model earlier_model(const std::string& type, const Parameters& p);
  Model diffuse(const Parameters& p, std::string_view reflectance);
  Model coated_diffuse(const Parameters& p);
  Model conductor(const Parameters& p, const std::string& prefix);
  Model coated_conductor(const Parameters& p);
  Model dielectric(const Parameters& p);
  Model thin_dielectric(const Parameters& p);
  Model diffuse_transmission(const Parameters& p);
  Model subsurface(const Parameters& p);
  Model hair(const Parameters& p);
  Model mix(const Parameters& p);
  Model unknown(const std::string& type, const Parameters& p);
  Model plastic_of_version_3(const Parameters& p, float default_roughness);
  Model glass_of_version_3(const Parameters& p);
  Model uber_of_version_3(const Parameters& p);
  Model disney_of_version_3(const Parameters& p);
  Status add_relief(const Parameters& p, Material& material);

  Result<ColorParameter> color(const Parameters& p, std::string_view name, Rgb otherwise);
  // The square root of pbrt's alpha.
  struct Roughness {
    ScalarParameter value, anisotropy;
  };
  Result<Roughness> roughness(const Parameters& p, const std::string& prefix, float otherwise,
                              bool may_differ);
  float index_of_refraction(const Parameters& p, std::string_view name, float otherwise);
  int add(Material material);
  bool has_texture(const Material& material) const;
  std::uint32_t part_of_mix(const Parameters& p, std::size_t part);

  SceneBuilder& builder_;
  const Report& report_;
  Colors& colors_;
  Textures& textures_;
  TextureBaker& baker_;
  std::vector<Material> materials_;
  std::vector<bool> textured_;  // each, or a part of it
  std::map<std::string, int> names_;
  std::optional<int> default_;
  std::map<int, std::uint32_t> parts_;  // of mixtures: the scene's material
};

}  // namespace tessera::core::pbrt
