// SPDX-License-Identifier: Apache-2.0
// The keys of materials. A new model adds its table here, and its word to kMaterialTypes;
// docs/architecture.md tells what else.
#pragma once

#include <variant>

#include "core/materials/material.hpp"
#include "core/scene/tables/domains.hpp"

namespace tessera::core {

template <typename Owner>
constexpr auto microfacet_keys(MicrofacetKind Owner::*kind) {
  return Table{PartKey{"distribution", kind, &MicrofacetKind::distribution, domains::kDistribution,
                       "the distribution of microfacet normals"},
               PartKey{"masking", kind, &MicrofacetKind::masking, domains::kSmithMasking,
                       "the masking-shadowing function: height-correlated, or the product for both "
                       "directions"}};
}

// The names are those of the scale and of the Abbe number.
template <typename Owner>
constexpr auto dispersion_keys(std::string_view scale, std::string_view abbe_number,
                               Dispersion Owner::*dispersion) {
  return Table{
      PartKey{
          scale, dispersion, &Dispersion::scale, domains::kDispersionScale,
          "how much [dispersion](materials.md#dispersion) spreads colours: 1 is that of the Abbe number, 0 "
          "is none",
          KeyTraits{.has_keyframes = true}},
      PartKey{abbe_number, dispersion, &Dispersion::abbe_number, domains::kAbbeNumber,
              "the Abbe number at a scale of 1: 64 for crown glass, 28 for dense flint, 55 for diamond",
              KeyTraits{.has_keyframes = true}}};
}

template <>
inline constexpr auto kKeys<NormalMap> = Table{
    Key{"texture", &NormalMap::texture, domains::kTextureName, "a name in `textures`",
        KeyTraits{.required = true}},
    Key{"strength", &NormalMap::strength, domains::kStrength,
        "the factor of the slopes: 0 is flat, and a negative one turns dents into bumps",
        KeyTraits{.has_keyframes = true}},
};

template <>
inline constexpr auto kKeys<TangentMap> = Table{
    Key{"texture", &TangentMap::texture, domains::kTextureName, "a name in `textures`",
        KeyTraits{.required = true}},
};

// The names are those of the map and of the angle.
template <typename Owner>
constexpr auto tangent_keys(std::string_view map, std::string_view rotation,
                            TangentDirection Owner::*direction) {
  return Table{
      PartKey{map, direction, &TangentDirection::map, domains::kTangentMap,
              "a texture of the direction along which highlights are stretched: red and green are its "
              "components from −1 to 1 along increasing u and v",
              KeyTraits{.otherwise = "increasing u"}},
      PartKey{rotation, direction, &TangentDirection::rotation, domains::kTangentTurns,
              "rotates that direction from increasing u towards increasing v; 1 is a whole rotation"}};
}

template <>
inline constexpr auto kKeys<Lambert> = Table{
    Key{"albedo", &Lambert::albedo, domains::kShare, "the reflectance"},
};

template <>
inline constexpr auto kKeys<Mirror> = Table{
    Key{"reflectance", &Mirror::reflectance, domains::kShare, "the reflectance"},
};

template <>
inline constexpr auto kKeys<Glass> = join(
    Table{
        Key{"ior", &Glass::ior, domains::kIor,
            "the index of refraction of the inside: 1.33 for water, 1.5 for window glass, 2.42 for diamond. "
            "For an air bubble in glass, turn its surface inside out"},
    },
    dispersion_keys("dispersion_scale", "dispersion_abbe_number", &Glass::dispersion),
    Table{
        Key{"reflectance", &Glass::reflectance, domains::kShare, "multiplies the reflected light"},
        Key{"transmittance", &Glass::transmittance, domains::kShare,
            "multiplies the transmitted light, at each crossing of the surface"},
        Key{"fresnel", &Glass::fresnel, domains::kDielectricFresnel,
            "the Fresnel reflectance: exact, Schlick's approximation, or 0 (except for total internal "
            "reflection)"},
        Key{"roughness", &Glass::roughness, domains::kRoughness,
            "the roughness of the microfacets; 0 is smooth"},
        Key{"priority", &Glass::priority, domains::kPriority,
            "which of [dielectrics that overlap](#nested-dielectrics) fills their common space: that of the "
            "highest priority. 0 is none"},
    },
    microfacet_keys(&Glass::microfacets));

template <>
inline constexpr auto kKeys<Phong> = Table{
    Key{"diffuse", &Phong::diffuse, domains::kShare, "the diffuse reflectance"},
    Key{"specular", &Phong::specular, domains::kShare, "the reflectance of the highlight"},
    Key{"exponent", &Phong::exponent, domains::kExponent,
        "the Phong exponent; a larger one makes a smaller highlight"},
    Key{"lobe", &Phong::lobe, domains::kPhongLobe,
        "the sampling density of the highlight: the cosine of the angle to the mirror direction is "
        "u^(1/(n+1)) or u^(1/(n+2)). Only the noise differs"},
};

template <>
inline constexpr auto kKeys<CookTorrance> = Table{
    Key{"diffuse", &CookTorrance::diffuse, domains::kShare, "the diffuse reflectance"},
    Key{"specular", &CookTorrance::specular, domains::kShare, "multiplies the microfacet reflection"},
    Key{"f0", &CookTorrance::f0, domains::kShare,
        "the reflectance at normal incidence (Schlick's approximation)"},
    Key{"conductor", &CookTorrance::conductor, domains::kConductor,
        "a measured metal instead of `f0`; `f0` must be left out"},
    Key{"roughness", &CookTorrance::roughness, domains::kRoughness, "the roughness; α is its square"},
    Key{"masking", &CookTorrance::masking, domains::kMasking,
        "the masking-shadowing function: that of Smith, or Schlick's approximation"},
};

template <>
inline constexpr auto kKeys<Principled> = join(
    Table{
        Key{"base_weight", &Principled::base_weight, domains::kWeight, "multiplies `base_color`"},
        Key{"base_color", &Principled::base_color, domains::kShare,
            "the colour of diffuse reflection, and of metal at normal incidence"},
        Key{"base_diffuse_roughness", &Principled::base_diffuse_roughness, domains::kWeight,
            "the roughness of the diffuse base; 0 is Lambert"},
        Key{"base_metalness", &Principled::base_metalness, domains::kWeight, "the share of metal"},
        Key{"subsurface_weight", &Principled::subsurface_weight, domains::kWeight,
            "the share of subsurface scattering, approximated by diffuse reflection"},
        Key{"subsurface_color", &Principled::subsurface_color, domains::kShare,
            "the colour of subsurface scattering"},
        Key{"subsurface_scatter_anisotropy", &Principled::subsurface_scatter_anisotropy,
            domains::kScatterAnisotropy,
            "of a thin-walled surface: what subsurface scattering transmits, from none at −1 to all at 1"},
        Key{"specular_weight", &Principled::specular_weight, domains::kWeight,
            "multiplies the reflectance at normal incidence"},
        Key{"specular_color", &Principled::specular_color, domains::kShare,
            "the tint of the reflection; of metal, near the horizon"},
        Key{"specular_roughness", &Principled::specular_roughness, domains::kRoughness,
            "the roughness; α is its square"},
        Key{"specular_roughness_anisotropy", &Principled::specular_roughness_anisotropy, domains::kWeight,
            "stretches highlights along the tangent"},
        Key{"specular_ior", &Principled::specular_ior, domains::kIor, "the index of refraction"},
        Key{"transmission_weight", &Principled::transmission_weight, domains::kWeight,
            "the share of the base that is clear"},
        Key{"transmission_color", &Principled::transmission_color, domains::kShare,
            "the colour of transmitted light, at each crossing"},
        Key{"transmission_depth", &Principled::transmission_depth, domains::kLength,
            "where transmitted light has `transmission_color`; 0: at each crossing"},
    },
    dispersion_keys("transmission_dispersion_scale", "transmission_dispersion_abbe_number",
                    &Principled::transmission_dispersion),
    Table{
        Key{"coat_weight", &Principled::coat_weight, domains::kWeight, "the share that a clear coat covers"},
        Key{"coat_color", &Principled::coat_color, domains::kShare, "what the coat lets through"},
        Key{"coat_roughness", &Principled::coat_roughness, domains::kRoughness, "the roughness of the coat"},
        Key{"coat_roughness_anisotropy", &Principled::coat_roughness_anisotropy, domains::kWeight,
            "stretches highlights of the coat along the tangent of the coat"},
        Key{"coat_ior", &Principled::coat_ior, domains::kIor, "the index of refraction of the coat"},
        Key{"coat_darkening", &Principled::coat_darkening, domains::kWeight,
            "how much reflection inside the coat darkens the base"},
        Key{"fuzz_weight", &Principled::fuzz_weight, domains::kWeight,
            "the share that fuzz covers, as on cloth or dust"},
        Key{"fuzz_color", &Principled::fuzz_color, domains::kShare, "the colour of fuzz"},
        Key{"fuzz_roughness", &Principled::fuzz_roughness, domains::kWeight, "the roughness of fuzz"},
        Key{"thin_film_weight", &Principled::thin_film_weight, domains::kWeight,
            "the share that a thin film covers"},
        Key{"thin_film_thickness", &Principled::thin_film_thickness, domains::kLength,
            "the thickness of the film, in micrometres"},
        Key{"thin_film_ior", &Principled::thin_film_ior, domains::kIor,
            "the index of refraction of the film"},
        Key{"geometry_thin_walled", &Principled::geometry_thin_walled, domains::kTruth,
            "whether the surface is a sheet without volume; light passes unrefracted"},
        Key{"priority", &Principled::priority, domains::kPriority,
            "which of [dielectrics that overlap](#nested-dielectrics) fills their common space: that of the "
            "highest priority. 0 is none. For clear solids only"},
        Key{"geometry_coat_normal", &Principled::geometry_coat_normal, domains::kNormalMap,
            "a normal map of the coat, as `normal_map`. The coat then has neither that nor `bump`",
            KeyTraits{.otherwise = "none"}},
    },
    tangent_keys("geometry_tangent", "geometry_tangent_rotation", &Principled::tangent),
    tangent_keys("geometry_coat_tangent", "geometry_coat_tangent_rotation", &Principled::coat_tangent));

template <>
inline constexpr auto kKeys<Plastic> = join(
    Table{
        Key{"diffuse", &Plastic::diffuse, domains::kShare, "the reflectance of the base"},
        Key{"specular", &Plastic::specular, domains::kShare, "multiplies the reflection of the boundary"},
        Key{"ior", &Plastic::ior, domains::kIor, "the index of refraction"},
        Key{"roughness", &Plastic::roughness, domains::kRoughness,
            "the roughness of the boundary; 0 is smooth"},
        Key{"internal_reflection", &Plastic::internal_reflection, domains::kWeight,
            "multiplies what the boundary throws back to the base from inside"},
        Key{"nonlinear", &Plastic::nonlinear, domains::kTruth,
            "whether each reflection inside takes the colour of the base, which makes it more saturated"},
    },
    microfacet_keys(&Plastic::microfacets),
    Table{
        Key{"compensated", &Plastic::compensated, domains::kTruth,
            "whether light that microfacets throw to each other under the boundary stays there; otherwise "
            "it is lost"},
    });

template <>
inline constexpr auto kKeys<ConductorMaterial> = join(
    Table{
        OtherKey{"metal",
                 domains::kConductor,
                 "a measured metal; `eta` and `k` must be left out",
                 {.otherwise = "none"}},
        Key{"eta", &ConductorMaterial::eta, domains::kIndex, "the real part of the index of refraction"},
        Key{"k", &ConductorMaterial::k, domains::kIndex, "its imaginary part"},
        Key{"specular", &ConductorMaterial::specular, domains::kShare, "multiplies the reflection"},
        Key{"roughness", &ConductorMaterial::roughness, domains::kRoughness, "the roughness; 0 is a mirror"},
        Key{"anisotropy", &ConductorMaterial::anisotropy, domains::kWeight,
            "stretches highlights along the tangent"},
    },
    tangent_keys("tangent", "tangent_rotation", &ConductorMaterial::tangent),
    microfacet_keys(&ConductorMaterial::microfacets));

template <>
inline constexpr auto kKeys<DiffuseTransmission> = Table{
    Key{"reflectance", &DiffuseTransmission::reflectance, domains::kShare, "the diffuse reflectance"},
    Key{"transmittance", &DiffuseTransmission::transmittance, domains::kShare,
        "the diffuse transmittance. Where both exceed 1, they are scaled down"},
};

template <>
inline constexpr auto kKeys<ThinDielectric> = Table{
    Key{"ior", &ThinDielectric::ior, domains::kIor, "the index of refraction"},
    Key{"reflectance", &ThinDielectric::reflectance, domains::kShare, "multiplies the reflected light"},
    Key{"transmittance", &ThinDielectric::transmittance, domains::kShare, "multiplies the transmitted light"},
};

template <>
inline constexpr auto kKeys<Blend> = Table{
    OtherKey{"materials",
             domains::kMaterialPair,
             "materials that stand above the blend in the file. They may be blends themselves, 8 deep",
             {.required = true}},
    Key{"weight", &Blend::weight, domains::kWeight, "the share of the second"},
    Key{"by_side", &Blend::by_side, domains::kTruth,
        "whether the first is the front and the second the back, whatever the `weight`"},
    Unkeyed{&Blend::first},
    Unkeyed{&Blend::second},
};

template <>
inline constexpr auto kKeys<Null> = Table{};

template <>
inline constexpr auto kKeys<Hair> = Table{
    Key{"reflectance", &Hair::reflectance, domains::kShare, "the colour of much hair",
        KeyTraits{.otherwise = "none"}},
    Key{"sigma_a", &Hair::sigma_a, domains::kIndex, "the absorption inside, per radius of the hair",
        KeyTraits{.otherwise = "none"}},
    Key{"eumelanin", &Hair::eumelanin, domains::kLength,
        "the concentration of brown pigment: 0.3 is blond, 1.3 brown, 8 black"},
    Key{"pheomelanin", &Hair::pheomelanin, domains::kLength, "the concentration of red pigment"},
    Key{"beta_m", &Hair::beta_m, domains::kWeight, "the roughness along the hair"},
    Key{"beta_n", &Hair::beta_n, domains::kWeight, "the roughness around the hair"},
    Key{"ior", &Hair::ior, domains::kIor, "the index of refraction"},
    Key{"tilt_degrees", &Hair::tilt_degrees, domains::kHairTilt,
        "the angle of the scales on the hair, by which highlights move towards its root"},
    Unkeyed{&Hair::pigment},
};

template <>
inline constexpr auto kKeys<Disney> = join(
    Table{
        Key{"base_color", &Disney::base_color, domains::kShare,
            "the colour of diffuse reflection, of metal and of transmitted light"},
        Key{"metallic", &Disney::metallic, domains::kWeight, "the share of metal"},
        Key{"roughness", &Disney::roughness, domains::kRoughness, "the roughness"},
        Key{"anisotropic", &Disney::anisotropic, domains::kWeight, "stretches highlights along the tangent"},
        Key{"ior", &Disney::ior, domains::kIor, "the index of refraction"},
        Key{"specular_tint", &Disney::specular_tint, domains::kWeight,
            "how much the base colour tints the reflection of the dielectric"},
        Key{"specular_transmission", &Disney::specular_transmission, domains::kWeight,
            "the share of the dielectric that is clear"},
        Key{"flatness", &Disney::flatness, domains::kWeight,
            "flattens diffuse reflection, as subsurface scattering does"},
        Key{"sheen", &Disney::sheen, domains::kWeight, "the brightness of cloth at grazing angles"},
        Key{"sheen_tint", &Disney::sheen_tint, domains::kWeight, "how much the base colour tints the sheen"},
        Key{"clearcoat", &Disney::clearcoat, domains::kWeight, "the strength of a second highlight"},
        Key{"clearcoat_gloss", &Disney::clearcoat_gloss, domains::kWeight,
            "how sharp the second highlight is"},
        Key{"diffuse_transmission", &Disney::diffuse_transmission, domains::kWeight,
            "the share of diffuse light that goes through a thin sheet"},
        Key{"thin_walled", &Disney::thin_walled, domains::kTruth,
            "whether the surface is a sheet without volume, through which light passes unrefracted; it has "
            "neither metal nor clearcoat"},
    },
    tangent_keys("tangent", "tangent_rotation", &Disney::tangent));

template <>
inline constexpr auto kKeys<BumpMap> = Table{
    Key{"texture", &BumpMap::texture, domains::kTextureName, "a name in `textures`",
        KeyTraits{.required = true}},
    Key{"height", &BumpMap::height, domains::kCoordinate,
        "the height of a texel of 1, in scene units; a negative one turns bumps into dents",
        KeyTraits{.has_keyframes = true}},
};

// The keys that all models have, but for those below.
namespace material_keys {
inline constexpr Key kEmission{
    "emission", &Material::emission, domains::kRadiance,
    "the emitted radiance, equal in all directions. The `tint` of a texture may be above 1"};
inline constexpr Key kEmissionSides{
    "emission_sides", &Material::two_sided_emission, domains::kSides,
    "the sides that emit. The front is the side from which the corners of a mesh are in counter-clockwise "
    "order, the outside of a sphere, or the side of a quad to which `edge_u` × `edge_v` points"};
inline constexpr Key kVisibleToCamera{
    "visible_to_camera", &Material::visible_to_camera, domains::kTruth,
    "whether camera rays meet the surface. Otherwise they pass as if it were not there; it still emits, "
    "reflects and casts shadows, and shows in mirrors and through glass. What lies in solid glass that the "
    "camera does not see is brighter by the square of the index, as radiance in glass is"};
inline constexpr Key kGroup{"group", &Material::light_group, domains::kLightGroup,
                            "the [light group](#light-groups) of what the material emits",
                            KeyTraits{.otherwise = "none"}};
inline constexpr std::string_view kSamplingDocumentation =
    "the sampling of directions: in proportion to the BSDF, or uniform. `cook_torrance` also has "
    "`\"half_vector\"`: all microfacets by projected area. Only the noise differs";
inline constexpr Key kSampling{"sampling", &Material::sampling, domains::kSampling, kSamplingDocumentation};
inline constexpr Key kMicrofacetSampling{"sampling", &Material::sampling, domains::kMicrofacetSampling,
                                         kSamplingDocumentation};
inline constexpr Key kNormalMap{
    "normal_map", &Material::normal_map, domains::kNormalMap,
    "a normal map. Red tilts normals towards growing u, green towards growing v (the OpenGL convention). "
    "`strength` (1) multiplies the slopes: 0 is flat, and a negative one turns dents into bumps",
    KeyTraits{.otherwise = "none"}};
inline constexpr Key kBump{
    "bump", &Material::bump, domains::kBump,
    "a bump map: the red channel of the texture is the height of the surface. `height` (1) is that of a "
    "texel of 1, in scene units; a negative one turns bumps into dents",
    KeyTraits{.otherwise = "none"}};
inline constexpr Key kOpacity{
    "opacity", &Material::opacity, domains::kWeight,
    "the fraction of rays that hit the surface; the others pass straight through. `{ \"texture\": "
    "\"leaf_alpha\" }` makes a cut-out"};
inline constexpr Key kSides{"sides", &Material::two_sided, domains::kSides,
                            "the sides that scatter light; the back is black otherwise. Materials that "
                            "transmit light have both"};
inline constexpr Key kShadingNormals{
    "shading_normals", &Material::shading_normals, domains::kShadingNormals,
    "what becomes of light where the shading normal differs from the geometric one: nothing is lost, or, as "
    "in most renderers, what comes from below the surface ([shading "
    "normals](materials.md#shading-normals))"};
inline constexpr PartKey kInterior{"interior_medium",
                                   &Material::media,
                                   &MediumInterface::interior,
                                   domains::kMediumName,
                                   "the [medium](#media) on the side that the normal points away from. If "
                                   "both sides have the same, a ray keeps the "
                                   "medium that it is in",
                                   KeyTraits{.otherwise = "none"}};
inline constexpr PartKey kExterior{"exterior_medium",
                                   &Material::media,
                                   &MediumInterface::exterior,
                                   domains::kMediumName,
                                   "the medium on the side that the normal points to",
                                   KeyTraits{.otherwise = "none"}};
}  // namespace material_keys

template <>
inline constexpr auto kKeys<Material> = Table{material_keys::kEmission, material_keys::kEmissionSides,
                                              material_keys::kGroup,    material_keys::kVisibleToCamera,
                                              material_keys::kSampling, material_keys::kNormalMap,
                                              material_keys::kBump,     material_keys::kOpacity,
                                              material_keys::kSides,    material_keys::kShadingNormals,
                                              material_keys::kInterior, material_keys::kExterior,
                                              Unkeyed{&Material::name}, Unkeyed{&Material::model}};

// Those of them that a model has.
template <typename Model>
inline constexpr const auto& kCommonKeys = kKeys<Material>;
template <>
inline constexpr auto kCommonKeys<CookTorrance> = Table{material_keys::kEmission,
                                                        material_keys::kEmissionSides,
                                                        material_keys::kGroup,
                                                        material_keys::kVisibleToCamera,
                                                        material_keys::kMicrofacetSampling,
                                                        material_keys::kNormalMap,
                                                        material_keys::kBump,
                                                        material_keys::kOpacity,
                                                        material_keys::kSides,
                                                        material_keys::kShadingNormals,
                                                        material_keys::kInterior,
                                                        material_keys::kExterior};
template <>
inline constexpr auto kCommonKeys<Blend> =
    Table{material_keys::kEmission,        material_keys::kEmissionSides, material_keys::kGroup,
          material_keys::kVisibleToCamera, material_keys::kOpacity,       material_keys::kInterior,
          material_keys::kExterior};
template <>
inline constexpr auto kCommonKeys<Null> =
    Table{material_keys::kEmission,        material_keys::kEmissionSides, material_keys::kGroup,
          material_keys::kVisibleToCamera, material_keys::kInterior,      material_keys::kExterior};

// Calls visit(key, value) for each key of the model and then of the material.
template <typename AnyMaterial, typename Visit>
void visit_keys(AnyMaterial& material, const Visit& visit) {
  std::visit(
      [&]<typename Model>(Model& model) { visit_members(kKeys<std::remove_const_t<Model>>, model, visit); },
      material.model);
  visit_members(kKeys<Material>, material, visit);
}

}  // namespace tessera::core
