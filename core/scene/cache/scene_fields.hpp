// SPDX-License-Identifier: Apache-2.0
// The fields of all types of a scene description and its tree, for serialisation: all members of each type,
// as references. They are those of its table of keys, or listed here: then a type with an additional member
// does not compile until the member is added. Then the
// values of all enumerations: one with an additional value gives a warning until it is added.
#pragma once

#include <concepts>
#include <tuple>
#include <type_traits>

#include "core/accel/bvh.hpp"
#include "core/scene/description.hpp"
#include "core/scene/tables/camera_tables.hpp"
#include "core/scene/tables/light_tables.hpp"
#include "core/scene/tables/material_tables.hpp"
#include "core/scene/tables/medium_tables.hpp"
#include "core/scene/tables/shape_tables.hpp"
#include "core/scene/tables/texture_tables.hpp"

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
  auto& [bits, light_groups, groups] = value;
  return std::tie(bits, light_groups, groups);
}
auto fields(Is<RenderSettings> auto& value) {
  auto& [width_px, height_px, spp, seed, integrator, heuristic, max_depth, clamp_indirect, filter, crop,
         layers] = value;
  return std::tie(width_px, height_px, spp, seed, integrator, heuristic, max_depth, clamp_indirect, filter,
                  crop, layers);
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
  auto& [image, wrap, scale, offset, wrap_v, shear, uv_set, filter, procedural] = value;
  return std::tie(image, wrap, scale, offset, wrap_v, shear, uv_set, filter, procedural);
}
auto fields(Is<ColorParameter> auto& value) {
  auto& [color, texture] = value;
  return std::tie(color, texture);
}
auto fields(Is<ScalarParameter> auto& value) {
  auto& [number, texture] = value;
  return std::tie(number, texture);
}
auto fields(Is<VoxelGrid> auto& value) {
  auto& [size, channels, values, filter, border] = value;
  return std::tie(size, channels, values, filter, border);
}
auto fields(Is<MeshDescription> auto& value) {
  auto& [positions, normals, uvs, triangles, triangle_materials, colors, steps, second_uvs, tangents] = value;
  return std::tie(positions, normals, uvs, triangles, triangle_materials, colors, steps, second_uvs,
                  tangents);
}
auto fields(Is<MeshStep> auto& value) {
  auto& [frame, positions, normals, tangents] = value;
  return std::tie(frame, positions, normals, tangents);
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
  auto& [camera, lights, instances, materials, media, environment, deforms] = value;
  return std::tie(camera, lights, instances, materials, media, environment, deforms);
}
// `contents` are for those who read the scene's file itself.
auto fields(Is<SceneDescription> auto& value) {
  auto& [settings, camera, camera_medium, display, textures, grids, media, materials, objects, shapes, names,
         lights, environment, animation, contents, warnings] = value;
  return std::tie(settings, camera, camera_medium, display, textures, grids, media, materials, objects,
                  shapes, names, lights, environment, animation, warnings);
}
auto fields(Is<accel::Bvh::Arrays> auto& value) {
  auto& [nodes, packets, objects] = value;
  return std::tie(nodes, packets, objects);
}

// The members of a type with a table of keys, in the order of that. A test looks for members without entry.
template <HasTable Owner>
void visit_fields(Owner& owner, auto& visit) {
  for_each(kKeys<std::remove_const_t<Owner>>, [&]<typename Entry>(const Entry& entry) {
    if constexpr (MemberOf<Entry, Owner>) visit(entry.of(owner));
  });
}
// Those of all others.
void visit_fields(auto& value, auto& visit) {
  std::apply([&](auto&... field) { (visit(field), ...); }, fields(value));
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
constexpr bool is_known(lights::SpotFalloff value) {
  switch (value) {
    case lights::SpotFalloff::kSmooth:
    case lights::SpotFalloff::kLinear:
    case lights::SpotFalloff::kSquared:
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
constexpr bool is_known(TextureFilter value) {
  switch (value) {
    case TextureFilter::kLinear:
    case TextureFilter::kNearest:
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
constexpr bool is_known(Projection value) {
  switch (value) {
    case Projection::kPlanar:
    case Projection::kSpherical:
    case Projection::kCylindrical:
      return true;
  }
  return false;
}
constexpr bool is_known(PatternSpace value) {
  switch (value) {
    case PatternSpace::kPosition:
    case PatternSpace::kUv:
    case PatternSpace::kNormal:
      return true;
  }
  return false;
}
constexpr bool is_known(UvSet value) {
  switch (value) {
    case UvSet::kFirst:
    case UvSet::kSecond:
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
constexpr bool is_known(ShadingNormals value) {
  switch (value) {
    case ShadingNormals::kConserving:
    case ShadingNormals::kPlain:
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
    case Conductor::kMagnesiumOxide:
    case Conductor::kTitaniumDioxide:
    case Conductor::kTitaniumDioxideExtraordinary:
    case Conductor::kDiamond:
    case Conductor::kCaesiumIodide:
    case Conductor::kSiliconCarbide:
    case Conductor::kBeryllium:
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
    Is<T, Quaternion> || Is<T, std::array<std::uint32_t, 3>> || Is<T, TextureImage::Tile> ||
    Is<T, accel::BvhNode> || Is<T, accel::BvhPacket> || Is<T, VertexTangent>;

}  // namespace tessera::core::stored
