// SPDX-License-Identifier: Apache-2.0
// Materials as they are seen at a point, or one in each lane at the lane's point: what BSDFs are made of.
// Keeps references.
#pragma once

#include <array>
#include <functional>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/materials/material.hpp"
#include "core/math/lane_array.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// Where a material is seen; in each lane for T = FloatN.
template <typename T>
struct MaterialPointOf {
  const std::vector<Texture>& textures;
  TexturePointOf<T> texture_point;
  MaskOf<T> outside;     // the viewer is on the side that the outward geometric normal points to
  RgbOf<T> tint;         // multiplies the base colour
  bool has_tint = true;  // else it is white in all lanes
  const WavelengthOf<T>* wavelength = nullptr;  // of the light, if any material disperses

  RgbOf<T> tinted(RgbOf<T> color) const { return has_tint ? color * tint : color; }
};
using MaterialPoint = MaterialPointOf<float>;

// A Part of a material: the material itself, or its model. One, or one in each lane.
template <typename T, typename Part>
using PartsOf =
    std::conditional_t<std::is_same_v<T, float>, const Part*, std::array<const Part*, kLaneCount>>;
template <typename T>
using MaterialsOf = PartsOf<T, Material>;

inline const Material& first_of(const Material* material) {
  return *material;
}
inline const Material& first_of(const MaterialsOf<FloatN>& materials) {
  return *materials[0];
}

// part_of(material), a pointer, of each material.
template <typename PartOf>
auto parts_of(const Material* material, const PartOf& part_of) {
  return part_of(*material);
}
template <typename PartOf>
auto parts_of(const MaterialsOf<FloatN>& materials, const PartOf& part_of) {
  std::array<decltype(part_of(*materials[0])), kLaneCount> parts;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) parts[lane] = part_of(*materials[lane]);
  return parts;
}

// The models of materials, which must all be a Model.
template <typename Model, typename Materials>
auto models_of(const Materials& materials) {
  return parts_of(materials, [](const Material& material) { return std::get_if<Model>(&material.model); });
}

// Evaluates parameters, which are named by pointers to members or by functions of the part.
template <typename T, typename Part>
class ModelAt;

template <typename Part>
class ModelAt<float, Part> {
 public:
  ModelAt(const Part* part, const MaterialPoint& at) : part_(*part), at_(at) {}

  const Part& first() const { return part_; }
  const MaterialPoint& at() const { return at_; }
  template <typename Parameter>
  auto operator()(const Parameter& parameter) const {
    return std::invoke(parameter, part_).evaluate(at_.textures, at_.texture_point);
  }
  template <typename Predicate>
  bool holds(const Predicate& predicate) const {
    return predicate(part_);
  }
  // A number that is no parameter.
  template <typename Member>
  auto number(const Member& member) const {
    return std::invoke(member, part_);
  }

 private:
  const Part& part_;
  const MaterialPoint& at_;
};

template <typename Part>
class ModelAt<FloatN, Part> {
 public:
  ModelAt(const PartsOf<FloatN, Part>& parts, const MaterialPointOf<FloatN>& at) : parts_(parts), at_(at) {
    for (const Part* part : parts_) is_one_ &= part == parts_[0];
  }

  const Part& first() const { return *parts_[0]; }
  const MaterialPointOf<FloatN>& at() const { return at_; }
  template <typename Parameter>
  auto operator()(const Parameter& parameter) const {
    const auto& one = std::invoke(parameter, first());
    using Evaluated = std::remove_cvref_t<decltype(one)>;
    if (is_one_ && one.texture < 0) return in_every_lane(one.value);
    std::array<const Evaluated*, kLaneCount> parameters;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane)
      parameters[lane] = &std::invoke(parameter, *parts_[lane]);
    return evaluate(parameters, at_.textures, at_.texture_point);
  }
  template <typename Predicate>
  MaskN holds(const Predicate& predicate) const {
    if (is_one_) return predicate(first());
    unsigned lanes = 0;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane)
      lanes |= (predicate(*parts_[lane]) ? 1u : 0u) << lane;
    return MaskN::from_bits(lanes);
  }
  template <typename Member>
  auto number(const Member& member) const {
    using Lanes = std::conditional_t<
        std::is_same_v<std::remove_cvref_t<std::invoke_result_t<Member, const Part&>>, Rgb>, RgbLanes,
        FloatLanes>;
    if (is_one_) return in_every_lane(std::invoke(member, first()));
    Lanes numbers;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane)
      numbers.set(lane, std::invoke(member, *parts_[lane]));
    return numbers.all();
  }

 private:
  static FloatN in_every_lane(float value) { return value; }
  static RgbOf<FloatN> in_every_lane(Rgb value) { return {value.r, value.g, value.b}; }

  const PartsOf<FloatN, Part> parts_;
  const MaterialPointOf<FloatN>& at_;
  bool is_one_ = true;  // the same in all lanes
};

}  // namespace tessera::core
