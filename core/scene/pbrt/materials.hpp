// SPDX-License-Identifier: Apache-2.0
// The materials of a scene, converted to ours. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
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
  // Names it for find(), also for the parts of mixtures. False if another one had the name.
  bool set_name(const std::string& name, int index);
  // The index of the named material, which may be defined later; `place` uses it.
  int find(const std::string& name, const Place& place);
  // Whether at() is defined: the material and, of a mixture, its parts are.
  bool is_made(int index) const { return slot(resolved(index)).state == State::kMade; }
  // Makes all that is not: nothing more is defined. Names without a material become gray, and so do mixtures
  // that are parts of themselves, with warnings. Fails for textures beyond the limits.
  Status finish();
  // The same index for all that are the same material.
  int resolved(int index) const;
  // The gray material of shapes that were given none.
  int default_material();

  // Without emission, opacity and media, which are those of a shape.
  const Material& at(int index) const { return slot(resolved(index)).material; }
  bool is_textured(int index) const { return slot(resolved(index)).is_textured; }
  // Whether the outside is the denser side, so that shapes of the material must be turned inside out.
  bool is_reversed(int index) const { return slot(resolved(index)).is_reversed; }

 private:
  using Model = Result<MaterialModel>;

  using Parts = std::array<int, 2>;  // of a mixture: indices of slots

  enum class State {
    kMissing,    // a name that is used, but not defined yet
    kAlias,      // such a name, defined
    kWaiting,    // a mixture whose parts are not all made
    kBeingMade,  // a mixture whose parts are being made
    kMade,
  };
  struct Slot {
    Material material{};  // only its name, as long as it is not made
    State state = State::kMissing;
    bool is_textured = false;  // it or a part of it
    bool is_reversed = false;
    int alias_of = -1;
    std::vector<Place> uses{};                       // of a missing name
    std::unique_ptr<const Parameters> parameters{};  // of a waiting mixture
    Parts parts{};                                   // of the same
  };
  Slot& slot(int index) { return slots_[static_cast<std::size_t>(index)]; }
  const Slot& slot(int index) const { return slots_[static_cast<std::size_t>(index)]; }

  Model model(const std::string& type, const Parameters& p);
  Model earlier_model(const std::string& type, const Parameters& p);
  Model diffuse(const Parameters& p, std::string_view reflectance);
  Model coated_diffuse(const Parameters& p);
  Model conductor(const Parameters& p);
  Model coated_conductor(const Parameters& p);
  // `index` names the parameter of the index of refraction.
  Model dielectric(const Parameters& p, std::string_view index = "eta");
  Model thin_dielectric(const Parameters& p);
  Model diffuse_transmission(const Parameters& p);
  Model subsurface(const Parameters& p);
  std::pair<Rgb, Rgb> scattering_below(const Parameters& p);
  Model hair(const Parameters& p);
  Model mix(const Parameters& p, const Parts& parts);
  Model unknown(const std::string& type, const Parameters& p);
  Model plastic_of_version_3(const Parameters& p, float default_roughness);
  Model glass_of_version_3(const Parameters& p);
  Model uber_of_version_3(const Parameters& p);
  Model disney_of_version_3(const Parameters& p);
  Status add_relief(const Parameters& p, Material& material);

  Result<ColorParameter> color(const Parameters& p, std::string_view name, Rgb otherwise);
  // From 0 to `most`; remarks on what is clamped.
  Result<ScalarParameter> scalar(const Parameters& p, std::string_view name, float otherwise, float most);
  // The square root of pbrt's alpha.
  struct Roughness {
    ScalarParameter value, anisotropy;
    TangentDirection tangent{};
  };
  Result<Roughness> roughness(const Parameters& p, const std::string& prefix, float otherwise,
                              bool may_differ);
  // function(c) for each channel c, at most `limit`; the texture must have no patterns.
  Result<ColorParameter> mapped(const TexturePtr& texture, const std::function<float(float)>& function,
                                float limit, const Place& place);
  ComplexIndex index_of_metal(const Parameters& p, const std::string& prefix);
  // The metal of the real index 1 that has this reflectance at normal incidence.
  Result<ConductorMaterial> metal_of(const TexturePtr& reflectance, const Place& place);
  // The reflectance at normal incidence of the metal of "coatedconductor", seen from inside of the coat.
  Result<ColorParameter> color_under_coat(const Parameters& p, float coat_index);
  RefractiveIndex refractive_index(const Parameters& p, std::string_view name, float otherwise);
  // The same for materials without dispersion.
  float index_of_refraction(const Parameters& p, std::string_view name, float otherwise);
  int add(Material material);
  int add_waiting(const Parameters& p, const Parts& parts, const std::string& name);
  void set(int index, Material material);
  // The material of a model, with what all types have.
  Result<Material> make(const std::string& type, Model model, const Parameters& p, const std::string& name);
  bool has_texture(const Material& material) const;
  Status finish(int index, int depth = 0);
  // The two parts of a mixture: the names mean what they do where it stands.
  Parts parts_of(const Parameters& p);
  bool are_made(const Parts& parts) const { return is_made(parts[0]) && is_made(parts[1]); }
  std::uint32_t part_of_mix(const Parameters& p, int part);

  SceneBuilder& builder_;
  const Report& report_;
  Colors& colors_;
  Textures& textures_;
  TextureBaker& baker_;
  std::vector<Slot> slots_;
  std::map<std::string, int> names_;
  std::optional<int> default_;
  std::map<int, std::uint32_t> parts_;  // of mixtures: the scene's material of a resolved index
};

}  // namespace tessera::core::pbrt
