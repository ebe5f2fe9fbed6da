// SPDX-License-Identifier: Apache-2.0
// Materials. A Material is a model with its parameters, possibly textured, and emission; bsdf.hpp evaluates
// and samples it at a point. docs/materials.md gives the formulae.
//
// docs/architecture.md tells how to add a model.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/materials/conductor.hpp"
#include "core/materials/disney.hpp"
#include "core/materials/dispersion.hpp"
#include "core/materials/fresnel.hpp"
#include "core/materials/limits.hpp"
#include "core/materials/microfacets.hpp"
#include "core/materials/tangent_direction.hpp"
#include "core/media/medium_description.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// Upper limits of parameters; texture values are clamped to them.
inline constexpr float kMaxExponent = 1e5f, kMaxHairTiltDegrees = 20;

// The lower limit of an index of refraction: textures have none below 1.
inline float min_ior(const ScalarParameter& ior) {
  return ior.texture < 0 ? kMinRelativeIor : 1.0f;
}

// Ideal diffuse reflection on both sides (Lambert 1760).
struct Lambert {
  ColorParameter albedo{Rgb::gray(0.5f)};
};

// Ideal mirror on both sides.
struct Mirror {
  ColorParameter reflectance{Rgb::gray(1)};
};

// Dielectric boundary, smooth or with microfacets (Walter et al. 2007). The inside is the side that the
// geometric normal points away from; outside is air.
struct Glass {
  ScalarParameter ior = 1.5f;  // of the inside, relative to the outside; if it disperses, at line d
  Dispersion dispersion{};
  ColorParameter reflectance{Rgb::gray(1)};
  ColorParameter transmittance{Rgb::gray(1)};
  DielectricFresnel fresnel = DielectricFresnel::kExact;
  ScalarParameter roughness = 0;  // alpha is its square; smooth if that is below kMinAlpha
  MicrofacetKind microfacets{};
  float priority = 0;  // where it overlaps other dielectrics (core/scene/nested_dielectrics.hpp); 0 for none
};

// The sampling density of Phong's highlight, by the angle alpha to the mirror direction: proportional to
// cos^n or to cos^(n + 1) alpha.
enum class PhongLobe { kNPlus1, kNPlus2 };

// Modified Phong (Lafortune and Willems 1994), on both sides. If diffuse + specular exceed 1, both are
// scaled down to that.
struct Phong {
  ColorParameter diffuse{Rgb::gray(0.5f)};
  ColorParameter specular{Rgb::gray(0.3f)};
  ScalarParameter exponent = 30;
  PhongLobe lobe = PhongLobe::kNPlus1;
};

enum class Masking {
  kSmith,    // height-correlated (Heitz 2014)
  kSchlick,  // separable, by Schlick's approximation (Schlick 1994), k = alpha / 2
};

// GGX microfacet reflection (Cook and Torrance 1982; Walter et al. 2007) over a diffuse base, on both
// sides. If diffuse + specular exceed 1, both are scaled down to that.
struct CookTorrance {
  ColorParameter diffuse{Rgb::gray(0)};
  ColorParameter specular{Rgb::gray(1)};
  ColorParameter f0{Rgb::gray(0.04f)};   // reflectance at normal incidence, with Schlick's approximation; or:
  std::optional<Conductor> conductor{};  // exact reflectance of a metal
  ScalarParameter roughness = 0.3f;      // alpha is its square, at least kMinAlpha
  Masking masking = Masking::kSmith;
};

// Perturbs shading normals: a texture's red, green and blue are x, y and z from -1 to 1 in the frame of u,
// v and the normal.
struct NormalMap {
  int texture = -1;    // index among the scene's textures, -1 for none
  float strength = 1;  // multiplies x and y
};

// The surface of OpenPBR 1.1 (Academy Software Foundation 2024), by its names, meanings and defaults. On both
// sides, or a dielectric solid as far as it transmits; then the inside is that of Glass. Colours are linear
// Rec. 709. Emission and opacity are those of the Material.
struct Principled {
  ScalarParameter base_weight = 1;
  ColorParameter base_color{Rgb::gray(0.8f)};
  ScalarParameter base_diffuse_roughness = 0;
  ScalarParameter base_metalness = 0;
  // Subsurface scattering is approximated by diffuse reflection of this colour.
  ScalarParameter subsurface_weight = 0;
  ColorParameter subsurface_color{Rgb::gray(0.8f)};
  float subsurface_scatter_anisotropy = 0;  // from -1 to 1; a sheet transmits (1 + it) / 2 of that light
  ScalarParameter specular_weight = 1;
  ColorParameter specular_color{Rgb::gray(1)};
  ScalarParameter specular_roughness = 0.3f;
  ScalarParameter specular_roughness_anisotropy = 0;  // the highlight is longer along its tangent
  ScalarParameter specular_ior = 1.5f;
  ScalarParameter transmission_weight = 0;
  ColorParameter transmission_color{Rgb::gray(1)};
  ScalarParameter transmission_depth = 0;  // where the colour is reached, in world units; 0: at the boundary
  Dispersion transmission_dispersion{};    // of the clear base, unless it is thin-walled
  ScalarParameter coat_weight = 0;
  ColorParameter coat_color{Rgb::gray(1)};
  ScalarParameter coat_roughness = 0;
  ScalarParameter coat_roughness_anisotropy = 0;
  ScalarParameter coat_ior = 1.6f;
  ScalarParameter coat_darkening = 1;
  ScalarParameter fuzz_weight = 0;
  ColorParameter fuzz_color{Rgb::gray(1)};
  ScalarParameter fuzz_roughness = 0.5f;
  ScalarParameter thin_film_weight = 0;
  ScalarParameter thin_film_thickness = 0.5f;  // micrometres
  ScalarParameter thin_film_ior = 1.4f;
  bool geometry_thin_walled = false;  // a sheet without volume: transmitted light is not refracted
  TangentDirection tangent{}, coat_tangent{};
  NormalMap geometry_coat_normal{};  // of the coat, in place of the material's maps
  float priority = 0;                // as Glass's, if it is a clear solid
};

// A dielectric boundary over a diffuse base, with reflection between the two inside (Walter et al. 2007;
// Weidlich and Wilkie 2007).
struct Plastic {
  ColorParameter diffuse{Rgb::gray(0.5f)};  // reflectance of the base
  ColorParameter specular{Rgb::gray(1)};    // tint of the boundary's reflection
  ScalarParameter ior = 1.5f;
  ScalarParameter roughness = 0;  // alpha is its square; smooth if that is below kMinAlpha
  // Multiplies what the boundary throws back to the base from inside.
  ScalarParameter internal_reflection = 1;
  bool nonlinear = false;  // each reflection inside takes the base's colour; else only the first
  MicrofacetKind microfacets{};
  bool compensated =
      true;  // light between microfacets stays inside; else it is lost, as by single scattering
};

// A metal of complex index eta + i k in each channel. The defaults reflect everything.
struct ConductorMaterial {
  ColorParameter eta{Rgb{}};
  ColorParameter k{Rgb::gray(1)};
  ColorParameter specular{Rgb::gray(1)};  // tint
  ScalarParameter roughness = 0;          // alpha is its square; a mirror if that is below kMinAlpha
  ScalarParameter anisotropy = 0;         // as Principled's
  TangentDirection tangent{};
  MicrofacetKind microfacets{};
};

// Diffuse reflection, and diffuse transmission to the other side.
struct DiffuseTransmission {
  ColorParameter reflectance{Rgb::gray(0.25f)};
  ColorParameter transmittance{Rgb::gray(0.25f)};
};

// A smooth sheet of a dielectric with parallel sides, as a pane: light leaves it unrefracted, with all
// reflections between the sides.
struct ThinDielectric {
  ScalarParameter ior = 1.5f;
  ColorParameter reflectance{Rgb::gray(1)};  // tints
  ColorParameter transmittance{Rgb::gray(1)};
};

// What absorbs light in hair.
enum class HairPigment { kReflectance, kAbsorption, kMelanin };

// A hair or a strand of fur (Chiang et al. 2016), for curves: a dielectric cylinder with scales and pigment.
struct Hair {
  HairPigment pigment = HairPigment::kMelanin;
  ColorParameter reflectance{Rgb::gray(0.5f)};  // of much hair, for kReflectance
  ColorParameter sigma_a{Rgb{}};                // absorption per radius of the hair, for kAbsorption
  // Concentrations, for kMelanin: eumelanin from 0.3 (blond) over 1.3 (brown) to 8 (black).
  ScalarParameter eumelanin = 1.3f;
  ScalarParameter pheomelanin = 0;
  ScalarParameter beta_m = 0.3f;  // roughness along the hair and around it, from 0 to 1
  ScalarParameter beta_n = 0.3f;
  ScalarParameter ior = 1.55f;
  float tilt_degrees = 2;  // of the scales on the hair
};

// Two materials, mixed point by point, with their normal and bump maps and opacities. The blend's own maps
// and the emission of its parts count for nothing.
struct Blend {
  // Indices among the scene's materials, below the blend's own.
  std::uint32_t first = 0, second = 0;
  ScalarParameter weight = 0.5f;  // of the second, in [0, 1]; texture values are clamped
  // The first is the front, that is the side that the geometric normal points to, and the second the back;
  // the weight does not count.
  bool by_side = false;
};
inline constexpr int kMaxBlendDepth = 8;  // of blends of blends

// Nothing: light passes straight through. Bounds a medium.
struct Null {};

using MaterialModel =
    std::variant<Lambert, Mirror, Glass, Phong, CookTorrance, Principled, Plastic, ConductorMaterial,
                 DiffuseTransmission, ThinDielectric, Blend, Null, Hair, Disney>;

// The sampling strategy for directions.
enum class Sampling {
  kBsdf,        // approximately in proportion to the scattered light
  kUniform,     // uniformly over the hemisphere, or the sphere for transmission; delta lobes
                // of ideal mirrors and smooth glass are unchanged
  kHalfVector,  // CookTorrance: the half-vector in proportion to the microfacets' projected area
};

// Tilts shading normals as if the surface were displaced by the heights in a texture's red channel (Blinn
// 1978).
struct BumpMap {
  int texture = -1;  // index among the scene's textures, -1 for none
  float height = 1;  // of a texel of 1, in world units; if negative, bright texels are lower
};

// What becomes of light where the shading normal, interpolated or from a map, differs from the geometric one.
enum class ShadingNormals {
  kConserving,  // neither lost nor gained (core/integrators/shading_normal.hpp)
  kPlain,       // the shading normal replaces the geometric one, and light from below the surface is lost
};

struct Material {
  std::string name;
  MaterialModel model;
  ColorParameter emission{Rgb{}};  // radiance leaving the surface, uniform over directions; black for none
  bool two_sided_emission = true;  // else only on the side the geometric normal points to
  // Else camera rays pass it as if it were not there, and only those: it emits, reflects and casts shadows.
  bool visible_to_camera = true;
  Sampling sampling = Sampling::kBsdf;
  NormalMap normal_map{};
  BumpMap bump{};  // applied after the normal map
  // The probability that light meets the surface; else it passes straight through. In [0, 1]; texture values
  // are clamped. It multiplies emission.
  ScalarParameter opacity = 1;
  // Whether the side that the geometric normal points away from scatters light, too; else it is black. All
  // models that transmit light have two sides.
  bool two_sided = true;
  ShadingNormals shading_normals = ShadingNormals::kConserving;
  // Where light passes the surface, by transmission or straight through, it enters the medium of that side.
  MediumInterface media{};
  std::string light_group{};  // of what it emits; empty for none
};

// Whether light passes straight through what emits: the surface adds to it.
inline bool emits_in_passing(const Material& material) {
  return std::holds_alternative<Null>(material.model) && !is_black(material.emission.value);
}

// Whether all light that the model transmits passes straight through: a pane, or a boundary between equal
// indices. Rays then go on behind it (interception_at); only what it reflects is scattered. Surfaces that
// emit stop all rays.
inline bool passes_straight(const Material& material) {
  if (!is_black(material.emission.value)) return false;
  if (const auto* glass = std::get_if<Glass>(&material.model))
    return glass->ior.texture < 0 && std::fabs(glass->ior.value - 1) < kMinBending;
  return std::holds_alternative<ThinDielectric>(material.model);
}

bool is_opaque(const Material& material, const std::vector<Material>& all);

// Whether the surface stops every ray where its own opacity is 1. `all` are the scene's materials, to which
// blends refer.
inline bool is_opaque_model(const Material& material, const std::vector<Material>& all) {
  if (std::holds_alternative<Null>(material.model) || passes_straight(material)) return false;
  const auto* blend = std::get_if<Blend>(&material.model);
  return blend == nullptr || (is_opaque(all[blend->first], all) && is_opaque(all[blend->second], all));
}

// Whether the surface stops every ray: light passes it only by its model's transmission.
inline bool is_opaque(const Material& material, const std::vector<Material>& all) {
  return material.opacity.texture < 0 && material.opacity.value >= 1 && is_opaque_model(material, all);
}

// Whether the model has an inside that light enters, so that both of its sides scatter light.
inline bool transmits_light(const MaterialModel& model) {
  if (const auto* disney = std::get_if<Disney>(&model)) return transmits_light(*disney);
  if (const auto* principled = std::get_if<Principled>(&model))
    return principled->geometry_thin_walled || principled->transmission_weight.texture >= 0 ||
           principled->transmission_weight.value > 0;
  return std::holds_alternative<Glass>(model) || std::holds_alternative<DiffuseTransmission>(model) ||
         std::holds_alternative<ThinDielectric>(model) || std::holds_alternative<Hair>(model);
}

// Whether the side that the geometric normal points away from is black.
inline bool is_one_sided(const Material& material) {
  return !material.two_sided && !transmits_light(material.model);
}

// Whether the transmission colour is that of a medium inside, which a Scene adds, rather than a tint at each
// crossing. Textures vary over the surface only, and tint.
inline bool absorbs_inside(const Principled& model) {
  const ScalarParameter& depth = model.transmission_depth;
  return !model.geometry_thin_walled && transmits_light(model) && depth.texture < 0 && depth.value > 0 &&
         model.transmission_color.texture < 0;
}

// Whether the model refracts light by its wavelength.
inline bool disperses(const Glass& model) {
  return model.dispersion.scale != 0;
}
inline bool disperses(const Principled& model) {
  return model.transmission_dispersion.scale != 0 && !model.geometry_thin_walled && transmits_light(model);
}
inline bool disperses(const MaterialModel& model) {
  if (const auto* glass = std::get_if<Glass>(&model)) return disperses(*glass);
  const auto* principled = std::get_if<Principled>(&model);
  return principled != nullptr && disperses(*principled);
}

// Whether light scatters below the surface, which is approximated; exact in sheets.
inline bool has_subsurface(const MaterialModel& model) {
  const auto* principled = std::get_if<Principled>(&model);
  return principled != nullptr && !principled->geometry_thin_walled &&
         (principled->subsurface_weight.texture >= 0 || principled->subsurface_weight.value > 0);
}

// Whether a weight can be above 0.
inline bool may_be_positive(const ScalarParameter& weight) {
  return weight.texture >= 0 || weight.value > 0;
}

// The direction that highlights of the model have, if they are longer in one than in the other, or lie across
// a hair; else null.
inline const TangentDirection* highlight_direction(const MaterialModel& model) {
  static constexpr auto kDirection = [](const auto& of, const ScalarParameter& anisotropy) {
    return may_be_positive(anisotropy) ? &of.tangent : nullptr;
  };
  if (const auto* m = std::get_if<Principled>(&model))
    return kDirection(*m, m->specular_roughness_anisotropy);
  if (const auto* m = std::get_if<Disney>(&model)) return kDirection(*m, m->anisotropic);
  if (const auto* m = std::get_if<ConductorMaterial>(&model)) return kDirection(*m, m->anisotropy);
  if (!std::holds_alternative<Hair>(model)) return nullptr;
  static const TangentDirection kAlongU;
  return &kAlongU;
}

// The model, if its coat is seen in another frame than its base; else null.
inline const Principled* with_own_coat_frame(const MaterialModel& model) {
  const auto* principled = std::get_if<Principled>(&model);
  const bool differs = principled != nullptr && may_be_positive(principled->coat_weight) &&
                       (principled->geometry_coat_normal.texture >= 0 ||
                        may_be_positive(principled->coat_roughness_anisotropy));
  return differs ? principled : nullptr;
}

// Whether f0 is the base colour, as for a metal.
inline bool f0_is_base_color(const CookTorrance& model) {
  return model.diffuse.texture < 0 && is_black(model.diffuse.value);
}

}  // namespace tessera::core
