// SPDX-License-Identifier: Apache-2.0
// A surface made of lobes in layers, in each lane. Light that the upper layers reflect to the viewer is taken
// from the lower ones, by the directional albedo for the viewer's direction only: so no energy is gained or
// lost, at the price of reciprocity (Turquin 2019; OpenPBR 1.1, albedo scaling). T is float for one point, or
// FloatN for one in each lane, whose lanes may have different lobes. Lobes that no lane has cost nothing.
// Directions as in bsdf.hpp.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>

#include "core/math/frame.hpp"
#include "core/math/word_lanes.hpp"
#include "core/shading/diffuse_lobes.hpp"
#include "core/shading/glass_lobes.hpp"
#include "core/shading/microfacet_lobes.hpp"

namespace tessera::core::shading {

// The places of a closure's lobes, from the top: light meets them in this order.
enum LobeSlot : std::uint32_t {
  kFuzzSlot,
  kCoatSlot,
  kMetalSlot,
  kMetalFilmSlot,
  kConductorSlot,
  kOtherConductorSlot,
  kGlassSlot,
  kThinGlassSlot,
  kBoundarySlot,
  kOtherBoundarySlot,
  kBoundaryFilmSlot,
  kDiffuseSlot,
  kCoveredDiffuseSlot,
  kDiffuseTransmissionSlot,
};

template <typename T>
class ClosureOf {
 public:
  using Lobes = std::tuple<SheenLobe<T>, GgxLobe<T, DielectricReflectance>, GgxLobe<T, EdgeTintReflectance>,
                           GgxLobe<T, FilmedMetal>, GgxLobe<T, ConductorReflectance>,
                           OtherMicrofacetLobe<T, ConductorReflectance>, GlassLobe<T>, ThinGlassLobe<T>,
                           GgxLobe<T, DielectricReflectance>, OtherMicrofacetLobe<T, DielectricReflectance>,
                           GgxLobe<T, FilmedDielectric>, DiffuseLobe<T>, CoveredDiffuseLobe<T>,
                           DiffuseTransmissionLobe<T>>;
  static constexpr std::size_t kSlots = std::tuple_size_v<Lobes>;

  // What a lobe does to the light of those below it.
  struct Below {
    T cover{};  // the share of the surface where its albedo is taken off
    RgbOf<T> tint = RgbOf<T>::gray(1);
  };

  // Adds a lobe in some lanes, at most once in each place, from the top. `weight` multiplies the lobe.
  template <std::size_t kSlot>
  void add(MaskOf<T> lanes, const std::tuple_element_t<kSlot, Lobes>& lobe, RgbOf<T> weight,
           const Below& below);
  template <std::size_t kSlot>
  void add(MaskOf<T> lanes, const std::tuple_element_t<kSlot, Lobes>& lobe, RgbOf<T> weight) {
    add<kSlot>(lanes, lobe, weight, Below{});
  }

  // Turns anisotropic lobes to the direction of increasing u. Its z is ignored; lanes without x and y stay.
  void orient(Vec3Of<T> tangent_local);

  // Gives the coat, in some lanes, the normal and the tangent of `axes`, which are given in the local frame:
  // those of the other lanes are ignored. The coat's normal must be on the side of wo. To be called last.
  void turn_coat(MaskOf<T> lanes, const FrameOf<T>& axes, Vec3Of<T> wo_local);

  // Computes at once what evaluate() and sample() need of the viewer, whose cosine is wo_local.z of all calls
  // that follow. To be called after scale_diffuse().
  void look_from(T cos_o) {
    shares_ = shares_at(cos_o, cos_o);
    viewed_ = true;
  }

  MaskOf<T> is_delta() const;   // only delta lobes
  MaskOf<T> has_delta() const;  // any
  MaskOf<T> transmits() const;  // by lobes that are not delta
  T transmitted_eta() const;
  void scale_diffuse(T factor);
  BsdfValueOf<T> evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T diffuse_cos) const;
  BsdfSampleOf<T> sample(Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const;
  // For T = float.
  DeltaBranches delta_branches(Vec3 wo_local) const;

 private:
  static constexpr std::uint32_t kNoSlot = 0xff;

  template <typename Lobe>
  struct Layer {
    Layer() = default;
    Layer(const Layer& other) { *this = other; }
    // Copies no lobe that no lane has.
    Layer& operator=(const Layer& other) {
      present = other.present;
      if (!any(present)) return *this;
      lobe = other.lobe, weight = other.weight, below = other.below;
      return *this;
    }

    MaskOf<T> present{};  // the lanes that have the lobe
    Lobe lobe;
    RgbOf<T> weight;
    Below below;
  };
  // The frame of the coat where it is not that of the base, in coordinates by tangent_.
  struct TurnedCoat {
    TurnedCoat() = default;
    TurnedCoat(const TurnedCoat& other) { *this = other; }
    // Copies no frame that no lane has.
    TurnedCoat& operator=(const TurnedCoat& other) {
      lanes = other.lanes;
      if (any(lanes)) frame = other.frame;
      return *this;
    }

    MaskOf<T> lanes{};
    FrameOf<T> frame;
  };
  template <typename AllLobes>
  struct LayersOf;
  template <typename... Each>
  struct LayersOf<std::tuple<Each...>> {
    using Type = std::tuple<Layer<Each>...>;
  };
  // Of each lobe: the factor of its light, and the chance that a sample is its own.
  struct Shares {
    std::array<RgbOf<T>, kSlots> light;
    std::array<T, kSlots> chance{};
  };

  template <typename Self, typename F>
  static void for_each_present(Self& self, const F& f);
  // By the cosines of the viewer to the normals of the base and of the coat.
  Shares shares_at(T cos_o, T coat_cos_o) const;
  Shares shares_seen_from(Vec3Of<T> wo) const { return shares_at(wo.z, to_coat(wo).z); }
  BsdfValueOf<T> evaluate(const Shares& shares, Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const;

  // A lobe in its own frame; the slot is a constant type.
  template <typename Lobe, typename Slot>
  BsdfValueOf<T> evaluate_lobe(const Lobe& lobe, Slot slot, Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const;
  template <typename Lobe, typename Slot>
  BsdfSampleOf<T> sample_lobe(const Lobe& lobe, Slot slot, Vec3Of<T> wo, Vec2Of<T> u, T u_lobe) const;
  Vec3Of<T> to_coat(Vec3Of<T> w) const;
  Vec3Of<T> to_tangents(Vec3Of<T> w) const;
  Vec3Of<T> from_tangents(Vec3Of<T> w) const;

  BsdfSampleOf<T> sample(const Shares& shares, Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const;

  typename LayersOf<Lobes>::Type layers_;
  Shares shares_;  // if viewed_
  bool viewed_ = false;
  WordOf<T> last_{kNoSlot};  // the last place that is taken
  Vec2Of<T> tangent_{T(1.0f), T(0.0f)};
  TurnedCoat turned_coat_;
};

template <typename T>
template <std::size_t kSlot>
void ClosureOf<T>::add(MaskOf<T> lanes, const std::tuple_element_t<kSlot, Lobes>& lobe, RgbOf<T> weight,
                       const Below& below) {
  const MaskOf<T> lets_all_through =
      (below.cover == 0) & (below.tint.r == 1) & (below.tint.g == 1) & (below.tint.b == 1);
  const MaskOf<T> black = is_black(weight);
  auto& layer = std::get<kSlot>(layers_);
  assert(!any(layer.present));
  layer.present = lanes & !(black & lets_all_through);
  if (!any(layer.present)) return;
  layer.lobe = lobe;
  layer.weight = weight;
  layer.below = below;
  last_ = select(layer.present, WordOf<T>(static_cast<std::uint32_t>(kSlot)), last_);
}

extern template class ClosureOf<float>;
extern template class ClosureOf<FloatN>;

}  // namespace tessera::core::shading
