// SPDX-License-Identifier: Apache-2.0
// The keys of each object of a scene file: the loader accepts them and suggests them for misspelt keys, and
// a test compares them with scenes/scene.schema.json.
#pragma once

#include <array>
#include <span>
#include <string_view>

namespace tessera::core {

struct KeyRule {
  std::string_view name;
  bool required = false;
};

// The keys of one type of object.
struct ObjectRules {
  std::string_view kind;            // as in "a sphere needs the key 'radius'"
  std::string_view schema_pointer;  // the location of its description in the schema
  std::span<const KeyRule> keys;
};

namespace scene_keys {

inline constexpr bool kRequired = true;

inline constexpr std::array kSceneKeys{KeyRule{"$schema"},
                                       KeyRule{"render"},
                                       KeyRule{"camera", kRequired},
                                       KeyRule{"output"},
                                       KeyRule{"textures"},
                                       KeyRule{"materials"},
                                       KeyRule{"objects"},
                                       KeyRule{"shapes", kRequired},
                                       KeyRule{"lights"},
                                       KeyRule{"environment"},
                                       KeyRule{"grids"},
                                       KeyRule{"media"}};
inline constexpr std::array kRenderKeys{
    KeyRule{"width"},     KeyRule{"height"},         KeyRule{"spp"},
    KeyRule{"seed"},      KeyRule{"integrator"},     KeyRule{"heuristic"},
    KeyRule{"max_depth"}, KeyRule{"filter"},         KeyRule{"filter_radius"},
    KeyRule{"crop"},      KeyRule{"clamp_indirect"}, KeyRule{"layers"}};
inline constexpr std::array kCameraKeys{KeyRule{"position", kRequired},
                                        KeyRule{"look_at", kRequired},
                                        KeyRule{"up"},
                                        KeyRule{"vertical_fov_degrees"},
                                        KeyRule{"aperture_radius"},
                                        KeyRule{"focus_distance"},
                                        KeyRule{"aperture_blades"},
                                        KeyRule{"aperture_rotation_degrees"},
                                        KeyRule{"medium"},
                                        KeyRule{"type"},
                                        KeyRule{"view_height"},
                                        KeyRule{"lens_shift"},
                                        KeyRule{"mirror"},
                                        KeyRule{"shutter"}};
inline constexpr std::array kOutputKeys{KeyRule{"exposure"}, KeyRule{"tone_curve"}};
inline constexpr std::array kTextureKeys{
    KeyRule{"file", kRequired}, KeyRule{"color_space"}, KeyRule{"channel"}, KeyRule{"wrap"},
    KeyRule{"scale"},           KeyRule{"offset"},      KeyRule{"wrap_v"},  KeyRule{"shear"}};
inline constexpr std::array kTexturedColorKeys{KeyRule{"texture", kRequired}, KeyRule{"tint"}};
inline constexpr std::array kTexturedScalarKeys{KeyRule{"texture", kRequired}, KeyRule{"scale"}};
inline constexpr std::array kGridKeys{KeyRule{"file", kRequired}, KeyRule{"filter"}, KeyRule{"border"}};
inline constexpr std::array kMediumKeys{
    KeyRule{"sigma_a"},  KeyRule{"sigma_s"},         KeyRule{"scale"},           KeyRule{"g"},
    KeyRule{"emission"}, KeyRule{"absorption_grid"}, KeyRule{"scattering_grid"}, KeyRule{"emission_grid"},
    KeyRule{"transform"}};
inline constexpr std::array kNormalMapKeys{KeyRule{"texture", kRequired}, KeyRule{"strength"}};
inline constexpr std::array kBumpKeys{KeyRule{"texture", kRequired}, KeyRule{"height"}};

// A material's own keys, without those common to all types.
template <std::size_t count>
constexpr std::array<KeyRule, count + 10> material_keys(const std::array<KeyRule, count>& own) {
  std::array<KeyRule, count + 10> all{KeyRule{"type", kRequired}};
  std::size_t next = 1;
  for (const KeyRule& rule : own) all[next++] = rule;
  for (const auto name : {"emission", "emission_sides", "sampling", "normal_map", "bump", "opacity", "sides",
                          "interior_medium", "exterior_medium"})
    all[next++] = {name};
  return all;
}

inline constexpr auto kLambertKeys = material_keys(std::array{KeyRule{"albedo"}});
inline constexpr auto kMirrorKeys = material_keys(std::array{KeyRule{"reflectance"}});
inline constexpr auto kGlassKeys = material_keys(
    std::array{KeyRule{"ior"}, KeyRule{"reflectance"}, KeyRule{"transmittance"}, KeyRule{"fresnel"},
               KeyRule{"roughness"}, KeyRule{"distribution"}, KeyRule{"masking"}});
inline constexpr auto kPhongKeys =
    material_keys(std::array{KeyRule{"diffuse"}, KeyRule{"specular"}, KeyRule{"exponent"}, KeyRule{"lobe"}});
inline constexpr auto kCookTorranceKeys =
    material_keys(std::array{KeyRule{"diffuse"}, KeyRule{"specular"}, KeyRule{"f0"}, KeyRule{"conductor"},
                             KeyRule{"roughness"}, KeyRule{"masking"}});
inline constexpr auto kPrincipledKeys = material_keys(std::array{KeyRule{"base_weight"},
                                                                 KeyRule{"base_color"},
                                                                 KeyRule{"base_diffuse_roughness"},
                                                                 KeyRule{"base_metalness"},
                                                                 KeyRule{"subsurface_weight"},
                                                                 KeyRule{"subsurface_color"},
                                                                 KeyRule{"specular_weight"},
                                                                 KeyRule{"specular_color"},
                                                                 KeyRule{"specular_roughness"},
                                                                 KeyRule{"specular_roughness_anisotropy"},
                                                                 KeyRule{"specular_ior"},
                                                                 KeyRule{"transmission_weight"},
                                                                 KeyRule{"transmission_color"},
                                                                 KeyRule{"transmission_depth"},
                                                                 KeyRule{"coat_weight"},
                                                                 KeyRule{"coat_color"},
                                                                 KeyRule{"coat_roughness"},
                                                                 KeyRule{"coat_ior"},
                                                                 KeyRule{"coat_darkening"},
                                                                 KeyRule{"fuzz_weight"},
                                                                 KeyRule{"fuzz_color"},
                                                                 KeyRule{"fuzz_roughness"},
                                                                 KeyRule{"thin_film_weight"},
                                                                 KeyRule{"thin_film_thickness"},
                                                                 KeyRule{"thin_film_ior"},
                                                                 KeyRule{"geometry_thin_walled"}});
inline constexpr auto kPlasticKeys = material_keys(
    std::array{KeyRule{"diffuse"}, KeyRule{"specular"}, KeyRule{"ior"}, KeyRule{"roughness"},
               KeyRule{"nonlinear"}, KeyRule{"distribution"}, KeyRule{"masking"}, KeyRule{"compensated"}});
inline constexpr auto kConductorKeys = material_keys(
    std::array{KeyRule{"metal"}, KeyRule{"eta"}, KeyRule{"k"}, KeyRule{"specular"}, KeyRule{"roughness"},
               KeyRule{"anisotropy"}, KeyRule{"distribution"}, KeyRule{"masking"}});
inline constexpr auto kDiffuseTransmissionKeys =
    material_keys(std::array{KeyRule{"reflectance"}, KeyRule{"transmittance"}});
inline constexpr auto kThinDielectricKeys =
    material_keys(std::array{KeyRule{"ior"}, KeyRule{"reflectance"}, KeyRule{"transmittance"}});
inline constexpr std::array kBlendKeys{KeyRule{"type", kRequired}, KeyRule{"materials", kRequired},
                                       KeyRule{"weight"},          KeyRule{"emission"},
                                       KeyRule{"emission_sides"},  KeyRule{"opacity"},
                                       KeyRule{"interior_medium"}, KeyRule{"exterior_medium"}};
inline constexpr auto kHairKeys = material_keys(
    std::array{KeyRule{"reflectance"}, KeyRule{"sigma_a"}, KeyRule{"eumelanin"}, KeyRule{"pheomelanin"},
               KeyRule{"beta_m"}, KeyRule{"beta_n"}, KeyRule{"ior"}, KeyRule{"tilt_degrees"}});
inline constexpr std::array kNullKeys{KeyRule{"type", kRequired}, KeyRule{"interior_medium"},
                                      KeyRule{"exterior_medium"}};
inline constexpr std::array kMeshKeys{
    KeyRule{"type", kRequired}, KeyRule{"file", kRequired}, KeyRule{"material"}, KeyRule{"default_material"},
    KeyRule{"materials"},       KeyRule{"vertex_colors"},   KeyRule{"normals"},  KeyRule{"transform"}};
inline constexpr std::array kSphereKeys{KeyRule{"type", kRequired}, KeyRule{"center"},
                                        KeyRule{"radius", kRequired}, KeyRule{"material", kRequired},
                                        KeyRule{"transform"}};
inline constexpr std::array kQuadKeys{KeyRule{"type", kRequired},     KeyRule{"corner", kRequired},
                                      KeyRule{"edge_u", kRequired},   KeyRule{"edge_v", kRequired},
                                      KeyRule{"material", kRequired}, KeyRule{"transform"}};
inline constexpr std::array kDiskKeys{
    KeyRule{"type", kRequired},     KeyRule{"center"},       KeyRule{"normal"},
    KeyRule{"radius", kRequired},   KeyRule{"inner_radius"}, KeyRule{"flip_normal"},
    KeyRule{"material", kRequired}, KeyRule{"transform"}};
inline constexpr std::array kCylinderKeys{KeyRule{"type", kRequired}, KeyRule{"start", kRequired},
                                          KeyRule{"end", kRequired},  KeyRule{"radius", kRequired},
                                          KeyRule{"flip_normal"},     KeyRule{"material", kRequired},
                                          KeyRule{"transform"}};
inline constexpr std::array kCurvesKeys{
    KeyRule{"type", kRequired}, KeyRule{"file"},   KeyRule{"points"},  KeyRule{"basis"},
    KeyRule{"shape"},           KeyRule{"radius"}, KeyRule{"normals"}, KeyRule{"material", kRequired},
    KeyRule{"transform"}};
inline constexpr std::array kInstanceKeys{KeyRule{"type", kRequired}, KeyRule{"object", kRequired},
                                          KeyRule{"material"}, KeyRule{"transform"}};
inline constexpr std::array kObjectKeys{KeyRule{"shapes", kRequired}};
inline constexpr std::array kPointLightKeys{KeyRule{"type", kRequired}, KeyRule{"position", kRequired},
                                            KeyRule{"intensity", kRequired}, KeyRule{"texture"},
                                            KeyRule{"orientation"}};
inline constexpr std::array kSpotLightKeys{KeyRule{"type", kRequired},
                                           KeyRule{"position", kRequired},
                                           KeyRule{"look_at", kRequired},
                                           KeyRule{"intensity", kRequired},
                                           KeyRule{"angle_degrees"},
                                           KeyRule{"softness"},
                                           KeyRule{"falloff"},
                                           KeyRule{"image"}};
inline constexpr std::array kProjectedImageKeys{KeyRule{"texture", kRequired}, KeyRule{"right", kRequired},
                                                KeyRule{"up", kRequired}, KeyRule{"flat_field"}};
inline constexpr std::array kDirectionalLightKeys{KeyRule{"type", kRequired}, KeyRule{"direction", kRequired},
                                                  KeyRule{"irradiance", kRequired}};
inline constexpr std::array kEnvironmentKeys{KeyRule{"radiance"}, KeyRule{"texture"},
                                             KeyRule{"rotation_degrees"}, KeyRule{"orientation"},
                                             KeyRule{"visible_to_camera"}};
inline constexpr std::array kTransformStepKeys{KeyRule{"scale"}, KeyRule{"rotate"}, KeyRule{"translate"},
                                               KeyRule{"matrix"}};
inline constexpr std::array kAnimatedKeys{KeyRule{"keyframes", kRequired}};
inline constexpr std::array kKeyframeKeys{KeyRule{"frame", kRequired}, KeyRule{"value", kRequired}};
inline constexpr std::array kRotationKeys{KeyRule{"axis", kRequired}, KeyRule{"degrees", kRequired}};
inline constexpr std::array kQuaternionKeys{KeyRule{"quaternion", kRequired}};

inline constexpr ObjectRules kScene{"scene", "", kSceneKeys};
inline constexpr ObjectRules kRender{"render", "/properties/render", kRenderKeys};
inline constexpr ObjectRules kCamera{"camera", "/properties/camera", kCameraKeys};
inline constexpr ObjectRules kOutput{"output", "/properties/output", kOutputKeys};
inline constexpr ObjectRules kTexture{"texture", "/$defs/texture", kTextureKeys};
inline constexpr ObjectRules kGrid{"grid", "/$defs/grid", kGridKeys};
inline constexpr ObjectRules kMedium{"medium", "/$defs/medium", kMediumKeys};
inline constexpr ObjectRules kTexturedColor{"textured colour", "/$defs/textured_color", kTexturedColorKeys};
inline constexpr ObjectRules kTexturedIor{"textured number", "/$defs/textured_ior", kTexturedScalarKeys};
inline constexpr ObjectRules kTexturedRoughness{"textured number", "/$defs/textured_roughness",
                                                kTexturedScalarKeys};
inline constexpr ObjectRules kTexturedExponent{"textured number", "/$defs/textured_exponent",
                                               kTexturedScalarKeys};
inline constexpr ObjectRules kNormalMap{"normal map", "/$defs/normal_map", kNormalMapKeys};
inline constexpr ObjectRules kBump{"bump map", "/$defs/bump", kBumpKeys};
inline constexpr ObjectRules kTexturedOpacity{"textured number", "/$defs/textured_opacity",
                                              kTexturedScalarKeys};
inline constexpr ObjectRules kLambert{"lambert material", "/$defs/lambert", kLambertKeys};
inline constexpr ObjectRules kMirror{"mirror material", "/$defs/mirror", kMirrorKeys};
inline constexpr ObjectRules kGlass{"glass material", "/$defs/glass", kGlassKeys};
inline constexpr ObjectRules kPhong{"phong material", "/$defs/phong", kPhongKeys};
inline constexpr ObjectRules kCookTorrance{"cook_torrance material", "/$defs/cook_torrance",
                                           kCookTorranceKeys};
inline constexpr ObjectRules kPrincipled{"principled material", "/$defs/principled", kPrincipledKeys};
inline constexpr ObjectRules kPlastic{"plastic material", "/$defs/plastic", kPlasticKeys};
inline constexpr ObjectRules kConductor{"conductor material", "/$defs/conductor", kConductorKeys};
inline constexpr ObjectRules kDiffuseTransmission{"diffuse_transmission material",
                                                  "/$defs/diffuse_transmission", kDiffuseTransmissionKeys};
inline constexpr ObjectRules kThinDielectric{"thin_dielectric material", "/$defs/thin_dielectric",
                                             kThinDielectricKeys};
inline constexpr ObjectRules kBlend{"blend material", "/$defs/blend", kBlendKeys};
inline constexpr ObjectRules kNull{"null material", "/$defs/null", kNullKeys};
inline constexpr ObjectRules kHair{"hair material", "/$defs/hair", kHairKeys};
inline constexpr ObjectRules kTexturedLength{"textured number", "/$defs/textured_length",
                                             kTexturedScalarKeys};
inline constexpr ObjectRules kTexturedIndex{"textured colour", "/$defs/textured_index", kTexturedColorKeys};
inline constexpr ObjectRules kMesh{"mesh", "/$defs/mesh", kMeshKeys};
inline constexpr ObjectRules kSphere{"sphere", "/$defs/sphere", kSphereKeys};
inline constexpr ObjectRules kQuad{"quad", "/$defs/quad", kQuadKeys};
inline constexpr ObjectRules kDisk{"disk", "/$defs/disk", kDiskKeys};
inline constexpr ObjectRules kCylinder{"cylinder", "/$defs/cylinder", kCylinderKeys};
inline constexpr ObjectRules kCurves{"curves", "/$defs/curves", kCurvesKeys};
inline constexpr ObjectRules kInstance{"instance", "/$defs/instance", kInstanceKeys};
inline constexpr ObjectRules kObject{"object", "/$defs/object", kObjectKeys};
inline constexpr ObjectRules kTexturedEmission{"textured emission", "/$defs/textured_emission",
                                               kTexturedColorKeys};
inline constexpr ObjectRules kPointLight{"point light", "/$defs/point", kPointLightKeys};
inline constexpr ObjectRules kSpotLight{"spot light", "/$defs/spot", kSpotLightKeys};
inline constexpr ObjectRules kProjectedImage{"projected image", "/$defs/projected_image",
                                             kProjectedImageKeys};
inline constexpr ObjectRules kDirectionalLight{"directional light", "/$defs/directional",
                                               kDirectionalLightKeys};
inline constexpr ObjectRules kEnvironment{"environment", "/properties/environment", kEnvironmentKeys};
inline constexpr ObjectRules kTransformStep{"transform step", "/$defs/transform_step", kTransformStepKeys};
inline constexpr ObjectRules kRotation{"rotation", "/$defs/rotation", kRotationKeys};
inline constexpr ObjectRules kQuaternion{"quaternion", "/$defs/quaternion", kQuaternionKeys};
inline constexpr ObjectRules kAnimated{"animated value", "/$defs/animated", kAnimatedKeys};
inline constexpr ObjectRules kKeyframe{"keyframe", "/$defs/keyframe", kKeyframeKeys};

inline constexpr std::array kAllObjects{kScene,
                                        kRender,
                                        kCamera,
                                        kOutput,
                                        kTexture,
                                        kGrid,
                                        kMedium,
                                        kTexturedColor,
                                        kTexturedEmission,
                                        kTexturedIor,
                                        kTexturedRoughness,
                                        kTexturedExponent,
                                        kNormalMap,
                                        kBump,
                                        kTexturedOpacity,
                                        kLambert,
                                        kMirror,
                                        kGlass,
                                        kPhong,
                                        kCookTorrance,
                                        kPrincipled,
                                        kPlastic,
                                        kConductor,
                                        kDiffuseTransmission,
                                        kThinDielectric,
                                        kBlend,
                                        kNull,
                                        kHair,
                                        kTexturedLength,
                                        kTexturedIndex,
                                        kMesh,
                                        kSphere,
                                        kQuad,
                                        kInstance,
                                        kDisk,
                                        kCylinder,
                                        kCurves,
                                        kObject,
                                        kTransformStep,
                                        kRotation,
                                        kQuaternion,
                                        kAnimated,
                                        kKeyframe,
                                        kPointLight,
                                        kSpotLight,
                                        kProjectedImage,
                                        kDirectionalLight,
                                        kEnvironment};

// The words of an enumeration, in the order of its values.
// In the order of Layer, then all of them.
inline constexpr std::array<std::string_view, 19> kLayers{"alpha",
                                                          "direct",
                                                          "indirect",
                                                          "emission",
                                                          "environment",
                                                          "albedo",
                                                          "normal",
                                                          "depth",
                                                          "position",
                                                          "uv",
                                                          "object_index",
                                                          "material_index",
                                                          "instance_index",
                                                          "crypto_object",
                                                          "crypto_material",
                                                          "crypto_asset",
                                                          "samples",
                                                          "standard_error",
                                                          "all"};
inline constexpr std::array<std::string_view, 4> kIntegrators{"naive", "nee", "mis", "whitted"};
inline constexpr std::array<std::string_view, 2> kHeuristics{"balance", "power"};
inline constexpr std::array<std::string_view, 3> kFilters{"box", "tent", "gaussian"};
inline constexpr std::array<std::string_view, 3> kToneCurves{"none", "aces", "agx"};
// In the order of MaterialModel's alternatives.
inline constexpr std::array<std::string_view, 13> kMaterialTypes{"lambert",
                                                                 "mirror",
                                                                 "glass",
                                                                 "phong",
                                                                 "cook_torrance",
                                                                 "principled",
                                                                 "plastic",
                                                                 "conductor",
                                                                 "diffuse_transmission",
                                                                 "thin_dielectric",
                                                                 "blend",
                                                                 "null",
                                                                 "hair"};
inline constexpr std::array<std::string_view, 3> kCameraTypes{"perspective", "orthographic", "panoramic"};
inline constexpr std::array<std::string_view, 7> kShapeTypes{"mesh", "sphere",   "quad",  "instance",
                                                             "disk", "cylinder", "curves"};
inline constexpr std::array<std::string_view, 4> kCurveBases{"linear", "bezier", "b_spline", "catmull_rom"};
inline constexpr std::array<std::string_view, 3> kCurveShapes{"round", "flat", "ribbon"};
inline constexpr std::array<std::string_view, 2> kSpotFalloffs{"smooth", "linear"};
inline constexpr std::array<std::string_view, 3> kLightTypes{"point", "spot", "directional"};
inline constexpr std::array<std::string_view, 3> kNormals{"file", "smooth", "flat"};
inline constexpr std::array<std::string_view, 2> kVertexColors{"use", "ignore"};
inline constexpr std::array<std::string_view, 2> kColorSpaces{"srgb", "linear"};
inline constexpr std::array<std::string_view, 3> kWraps{"repeat", "clamp", "mirror"};
inline constexpr std::array<std::string_view, 5> kChannels{"color", "alpha", "red", "green", "blue"};
inline constexpr std::array<std::string_view, 2> kSides{"both", "front"};
inline constexpr std::array<std::string_view, 2> kGridFilters{"linear", "nearest"};
inline constexpr std::array<std::string_view, 2> kGridBorders{"clamp", "zero"};
inline constexpr std::array<std::string_view, 3> kDielectricFresnels{"exact", "schlick", "none"};
inline constexpr std::array<std::string_view, 2> kPhongLobes{"n+1", "n+2"};
inline constexpr std::array<std::string_view, 10> kConductors{
    "copper",   "gold",   "silver",   "aluminium", "brass",
    "chromium", "nickel", "tungsten", "mercury",   "titanium_nitride"};
inline constexpr std::array<std::string_view, 2> kMaskings{"smith", "schlick"};
inline constexpr std::array<std::string_view, 2> kDistributions{"ggx", "beckmann"};
inline constexpr std::array<std::string_view, 2> kSmithMaskings{"smith", "separable"};
inline constexpr std::array<std::string_view, 3> kMicrofacetSamplings{"bsdf", "uniform", "half_vector"};
inline constexpr std::span<const std::string_view> kSamplings =
    std::span(kMicrofacetSamplings).first(2);  // for the other materials

}  // namespace scene_keys
}  // namespace tessera::core
