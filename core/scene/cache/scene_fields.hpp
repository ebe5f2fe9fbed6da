// SPDX-License-Identifier: Apache-2.0
// The fields of all types of a scene description and its tree, for serialisation: all members of each type,
// as references. A type with an additional member does not compile until the member is added here. Then the
// values of all enumerations: one with an additional value gives a warning until it is added.
#pragma once

#include <concepts>
#include <tuple>
#include <type_traits>

#include "core/accel/bvh.hpp"
#include "core/scene/description.hpp"

namespace tessera::core::stored {

// T, or const T.
template <typename T, typename U>
concept Is = std::same_as<std::remove_const_t<T>, U>;

auto fields(Is<PixelFilter> auto& value) {
  auto& [kind, radius_px] = value;
  return std::tie(kind, radius_px);
}
auto fields(Is<PixelRect> auto& value) {
  auto& [x0, y0, x1, y1] = value;
  return std::tie(x0, y0, x1, y1);
}
auto fields(Is<LayerSet> auto& value) {
  auto& [bits] = value;
  return std::tie(bits);
}
auto fields(Is<RenderSettings> auto& value) {
  auto& [width_px, height_px, spp, seed, integrator, heuristic, max_depth, clamp_indirect, filter, crop,
         layers] = value;
  return std::tie(width_px, height_px, spp, seed, integrator, heuristic, max_depth, clamp_indirect, filter,
                  crop, layers);
}
auto fields(Is<CameraDescription> auto& value) {
  auto& [position, look_at, up, fov, radius, focus, blades, rotation, type, view_height, shift, mirrored,
         shutter_open, shutter_close] = value;
  return std::tie(position, look_at, up, fov, radius, focus, blades, rotation, type, view_height, shift,
                  mirrored, shutter_open, shutter_close);
}
auto fields(Is<DisplaySettings> auto& value) {
  auto& [exposure_stops, tone_curve] = value;
  return std::tie(exposure_stops, tone_curve);
}
auto fields(Is<TextureImage::Texels> auto& value) {
  auto& [width, height, format, tiles, floats] = value;
  return std::tie(width, height, format, tiles, floats);
}
auto fields(Is<Texture> auto& value) {
  auto& [image, wrap, scale, offset, wrap_v, shear] = value;
  return std::tie(image, wrap, scale, offset, wrap_v, shear);
}
auto fields(Is<ColorParameter> auto& value) {
  auto& [color, texture] = value;
  return std::tie(color, texture);
}
auto fields(Is<ScalarParameter> auto& value) {
  auto& [number, texture] = value;
  return std::tie(number, texture);
}
auto fields(Is<Lambert> auto& value) {
  auto& [albedo] = value;
  return std::tie(albedo);
}
auto fields(Is<Mirror> auto& value) {
  auto& [reflectance] = value;
  return std::tie(reflectance);
}
auto fields(Is<MicrofacetKind> auto& value) {
  auto& [distribution, masking] = value;
  return std::tie(distribution, masking);
}
auto fields(Is<Glass> auto& value) {
  auto& [ior, reflectance, transmittance, fresnel, roughness, microfacets] = value;
  return std::tie(ior, reflectance, transmittance, fresnel, roughness, microfacets);
}
auto fields(Is<Phong> auto& value) {
  auto& [diffuse, specular, exponent, lobe] = value;
  return std::tie(diffuse, specular, exponent, lobe);
}
auto fields(Is<CookTorrance> auto& value) {
  auto& [diffuse, specular, f0, conductor, roughness, masking] = value;
  return std::tie(diffuse, specular, f0, conductor, roughness, masking);
}
auto fields(Is<Principled> auto& value) {
  auto& [base_weight, base_color, base_diffuse_roughness, base_metalness, subsurface_weight, subsurface_color,
         specular_weight, specular_color, specular_roughness, specular_roughness_anisotropy, specular_ior,
         transmission_weight, transmission_color, transmission_depth, coat_weight, coat_color, coat_roughness,
         coat_ior, coat_darkening, fuzz_weight, fuzz_color, fuzz_roughness, thin_film_weight,
         thin_film_thickness, thin_film_ior, geometry_thin_walled] = value;
  return std::tie(base_weight, base_color, base_diffuse_roughness, base_metalness, subsurface_weight,
                  subsurface_color, specular_weight, specular_color, specular_roughness,
                  specular_roughness_anisotropy, specular_ior, transmission_weight, transmission_color,
                  transmission_depth, coat_weight, coat_color, coat_roughness, coat_ior, coat_darkening,
                  fuzz_weight, fuzz_color, fuzz_roughness, thin_film_weight, thin_film_thickness,
                  thin_film_ior, geometry_thin_walled);
}
auto fields(Is<Plastic> auto& value) {
  auto& [diffuse, specular, ior, roughness, nonlinear, microfacets, compensated] = value;
  return std::tie(diffuse, specular, ior, roughness, nonlinear, microfacets, compensated);
}
auto fields(Is<ConductorMaterial> auto& value) {
  auto& [eta, k, specular, roughness, anisotropy, microfacets] = value;
  return std::tie(eta, k, specular, roughness, anisotropy, microfacets);
}
auto fields(Is<DiffuseTransmission> auto& value) {
  auto& [reflectance, transmittance] = value;
  return std::tie(reflectance, transmittance);
}
auto fields(Is<ThinDielectric> auto& value) {
  auto& [ior, reflectance, transmittance] = value;
  return std::tie(ior, reflectance, transmittance);
}
auto fields(Is<Blend> auto& value) {
  auto& [first, second, weight] = value;
  return std::tie(first, second, weight);
}
auto fields(Is<Null> auto&) {
  return std::tie();
}
auto fields(Is<Hair> auto& value) {
  auto& [pigment, reflectance, sigma_a, eumelanin, pheomelanin, beta_m, beta_n, ior, tilt] = value;
  return std::tie(pigment, reflectance, sigma_a, eumelanin, pheomelanin, beta_m, beta_n, ior, tilt);
}
auto fields(Is<NormalMap> auto& value) {
  auto& [texture, strength] = value;
  return std::tie(texture, strength);
}
auto fields(Is<BumpMap> auto& value) {
  auto& [texture, height] = value;
  return std::tie(texture, height);
}
auto fields(Is<MediumInterface> auto& value) {
  auto& [interior, exterior] = value;
  return std::tie(interior, exterior);
}
auto fields(Is<Material> auto& value) {
  auto& [name, model, emission, two_sided_emission, sampling, normal_map, bump, opacity, two_sided, media] =
      value;
  return std::tie(name, model, emission, two_sided_emission, sampling, normal_map, bump, opacity, two_sided,
                  media);
}
auto fields(Is<VoxelGrid> auto& value) {
  auto& [size, channels, values, filter, border] = value;
  return std::tie(size, channels, values, filter, border);
}
auto fields(Is<MediumDescription> auto& value) {
  auto& [name, sigma_a, sigma_s, scale, g, emission, absorption_grid, scattering_grid, emission_grid,
         grid_to_world] = value;
  return std::tie(name, sigma_a, sigma_s, scale, g, emission, absorption_grid, scattering_grid, emission_grid,
                  grid_to_world);
}
auto fields(Is<MeshDescription> auto& value) {
  auto& [positions, normals, uvs, triangles, triangle_materials, colors] = value;
  return std::tie(positions, normals, uvs, triangles, triangle_materials, colors);
}
auto fields(Is<SphereDescription> auto& value) {
  auto& [center, radius, material] = value;
  return std::tie(center, radius, material);
}
auto fields(Is<QuadDescription> auto& value) {
  auto& [corner, edge_u, edge_v, material] = value;
  return std::tie(corner, edge_u, edge_v, material);
}
auto fields(Is<DiskDescription> auto& value) {
  auto& [center, radius_u, radius_v, inner, flipped, material] = value;
  return std::tie(center, radius_u, radius_v, inner, flipped, material);
}
auto fields(Is<CylinderDescription> auto& value) {
  auto& [start, axis, radius_u, radius_v, flipped, material] = value;
  return std::tie(start, axis, radius_u, radius_v, flipped, material);
}
auto fields(Is<CurveStrands> auto& value) {
  auto& [basis, shape, points, radii, counts, normals] = value;
  return std::tie(basis, shape, points, radii, counts, normals);
}
auto fields(Is<CurvesDescription> auto& value) {
  auto& [strands, material] = value;
  return std::tie(strands, material);
}
auto fields(Is<Transform> auto& value) {
  auto& [x_axis, y_axis, z_axis, origin] = value;
  return std::tie(x_axis, y_axis, z_axis, origin);
}
auto fields(Is<InstanceDescription> auto& value) {
  auto& [object, to_world, material] = value;
  return std::tie(object, to_world, material);
}
auto fields(Is<ObjectDescription> auto& value) {
  auto& [name, shapes, shape_names] = value;
  return std::tie(name, shapes, shape_names);
}
auto fields(Is<PointLightDescription> auto& value) {
  auto& [position, intensity, texture, orientation] = value;
  return std::tie(position, intensity, texture, orientation);
}
auto fields(Is<ProjectedImage> auto& value) {
  auto& [texture, right, up, flat_field] = value;
  return std::tie(texture, right, up, flat_field);
}
auto fields(Is<SpotLightDescription> auto& value) {
  auto& [position, look_at, intensity, angle, softness, falloff, image] = value;
  return std::tie(position, look_at, intensity, angle, softness, falloff, image);
}
auto fields(Is<DirectionalLightDescription> auto& value) {
  auto& [direction, irradiance] = value;
  return std::tie(direction, irradiance);
}
auto fields(Is<EnvironmentDescription> auto& value) {
  auto& [radiance, rotation, orientation, visible_to_camera] = value;
  return std::tie(radiance, rotation, orientation, visible_to_camera);
}
template <typename T>
inline constexpr bool kIsTrack = false;
template <typename T>
inline constexpr bool kIsTrack<Track<T>> = true;
template <typename T>
requires kIsTrack<std::remove_const_t<T>>
auto fields(T& value) {
  auto& [frames, values] = value;
  return std::tie(frames, values);
}
auto fields(Is<CameraAnimation> auto& value) {
  auto& [position, look_at, up, fov, radius, focus, rotation, view_height, shift] = value;
  return std::tie(position, look_at, up, fov, radius, focus, rotation, view_height, shift);
}
auto fields(Is<LightAnimation> auto& value) {
  auto& [light, position, look_at, direction, color, angle, softness] = value;
  return std::tie(light, position, look_at, direction, color, angle, softness);
}
template <typename T>
inline constexpr bool kIsKeyedTrack = false;
template <typename T>
inline constexpr bool kIsKeyedTrack<KeyedTrack<T>> = true;
template <typename T>
requires kIsKeyedTrack<std::remove_const_t<T>>
auto fields(T& value) {
  auto& [key, track] = value;
  return std::tie(key, track);
}
auto fields(Is<ParameterTracks> auto& value) {
  auto& [numbers, colors] = value;
  return std::tie(numbers, colors);
}
auto fields(Is<IndexedTracks> auto& value) {
  auto& [index, tracks] = value;
  return std::tie(index, tracks);
}
auto fields(Is<ScaleMotion> auto& value) {
  auto& [factors] = value;
  return std::tie(factors);
}
auto fields(Is<TurnMotion> auto& value) {
  auto& [axis, degrees] = value;
  return std::tie(axis, degrees);
}
auto fields(Is<RotationMotion> auto& value) {
  auto& [rotations] = value;
  return std::tie(rotations);
}
auto fields(Is<TranslationMotion> auto& value) {
  auto& [offsets] = value;
  return std::tie(offsets);
}
auto fields(Is<InstanceMotion> auto& value) {
  auto& [shape, steps] = value;
  return std::tie(shape, steps);
}
auto fields(Is<Animation> auto& value) {
  auto& [camera, lights, instances, materials, media, environment] = value;
  return std::tie(camera, lights, instances, materials, media, environment);
}
// `contents` are for those who read the scene's file itself.
auto fields(Is<SceneDescription> auto& value) {
  auto& [settings, camera, camera_medium, display, textures, grids, media, materials, objects, shapes, names,
         lights, environment, animation, contents, warnings] = value;
  return std::tie(settings, camera, camera_medium, display, textures, grids, media, materials, objects,
                  shapes, names, lights, environment, animation, warnings);
}
auto fields(Is<Bvh::Arrays> auto& value) {
  auto& [nodes, packets, objects] = value;
  return std::tie(nodes, packets, objects);
}

// Whether a stored number is one of the enumeration's values.
constexpr bool is_known(Integrator value) {
  switch (value) {
    case Integrator::kNaive:
    case Integrator::kNee:
    case Integrator::kMis:
    case Integrator::kWhitted:
      return true;
  }
  return false;
}
constexpr bool is_known(Heuristic value) {
  switch (value) {
    case Heuristic::kBalance:
    case Heuristic::kPower:
      return true;
  }
  return false;
}
constexpr bool is_known(FilterKind value) {
  switch (value) {
    case FilterKind::kBox:
    case FilterKind::kTent:
    case FilterKind::kGaussian:
      return true;
  }
  return false;
}
constexpr bool is_known(SpotFalloff value) {
  switch (value) {
    case SpotFalloff::kSmooth:
    case SpotFalloff::kLinear:
      return true;
  }
  return false;
}
constexpr bool is_known(ToneCurve value) {
  switch (value) {
    case ToneCurve::kNone:
    case ToneCurve::kAces:
    case ToneCurve::kAgx:
      return true;
  }
  return false;
}
constexpr bool is_known(TextureImage::Format value) {
  switch (value) {
    case TextureImage::Format::kSrgbBytes:
    case TextureImage::Format::kLinearBytes:
    case TextureImage::Format::kSharedExponent:
    case TextureImage::Format::kFloats:
      return true;
  }
  return false;
}
constexpr bool is_known(Wrap value) {
  switch (value) {
    case Wrap::kRepeat:
    case Wrap::kClamp:
    case Wrap::kMirror:
      return true;
  }
  return false;
}
constexpr bool is_known(CameraType value) {
  switch (value) {
    case CameraType::kPerspective:
    case CameraType::kOrthographic:
    case CameraType::kPanoramic:
      return true;
  }
  return false;
}
constexpr bool is_known(HairPigment value) {
  switch (value) {
    case HairPigment::kReflectance:
    case HairPigment::kAbsorption:
    case HairPigment::kMelanin:
      return true;
  }
  return false;
}
constexpr bool is_known(CurveBasis value) {
  switch (value) {
    case CurveBasis::kLinear:
    case CurveBasis::kBezier:
    case CurveBasis::kBSpline:
    case CurveBasis::kCatmullRom:
      return true;
  }
  return false;
}
constexpr bool is_known(CurveShape value) {
  switch (value) {
    case CurveShape::kRound:
    case CurveShape::kFlat:
    case CurveShape::kRibbon:
      return true;
  }
  return false;
}
constexpr bool is_known(GridFilter value) {
  switch (value) {
    case GridFilter::kLinear:
    case GridFilter::kNearest:
      return true;
  }
  return false;
}
constexpr bool is_known(GridBorder value) {
  switch (value) {
    case GridBorder::kClamp:
    case GridBorder::kZero:
      return true;
  }
  return false;
}
constexpr bool is_known(DielectricFresnel value) {
  switch (value) {
    case DielectricFresnel::kExact:
    case DielectricFresnel::kSchlick:
    case DielectricFresnel::kNone:
      return true;
  }
  return false;
}
constexpr bool is_known(PhongLobe value) {
  switch (value) {
    case PhongLobe::kNPlus1:
    case PhongLobe::kNPlus2:
      return true;
  }
  return false;
}
constexpr bool is_known(Conductor value) {
  switch (value) {
    case Conductor::kCopper:
    case Conductor::kGold:
    case Conductor::kSilver:
    case Conductor::kAluminium:
    case Conductor::kBrass:
    case Conductor::kChromium:
    case Conductor::kNickel:
    case Conductor::kTungsten:
    case Conductor::kMercury:
    case Conductor::kTitaniumNitride:
      return true;
  }
  return false;
}
constexpr bool is_known(MicrofacetDistribution value) {
  switch (value) {
    case MicrofacetDistribution::kGgx:
    case MicrofacetDistribution::kBeckmann:
      return true;
  }
  return false;
}
constexpr bool is_known(SmithMasking value) {
  switch (value) {
    case SmithMasking::kCorrelated:
    case SmithMasking::kSeparable:
      return true;
  }
  return false;
}
constexpr bool is_known(Masking value) {
  switch (value) {
    case Masking::kSmith:
    case Masking::kSchlick:
      return true;
  }
  return false;
}
constexpr bool is_known(Sampling value) {
  switch (value) {
    case Sampling::kBsdf:
    case Sampling::kUniform:
    case Sampling::kHalfVector:
      return true;
  }
  return false;
}

// Types that are stored as in memory, alone and in arrays: numbers, and structures of numbers of one type.
template <typename T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T> || Is<T, Vec2> || Is<T, Vec3> || Is<T, Rgb> ||
    Is<T, Quaternion> || Is<T, std::array<std::uint32_t, 3>> || Is<T, TextureImage::Tile> || Is<T, BvhNode> ||
    Is<T, BvhPacket>;

}  // namespace tessera::core::stored
