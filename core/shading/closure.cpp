// SPDX-License-Identifier: Apache-2.0
#include "core/shading/closure.hpp"

#include <cmath>
#include <type_traits>
#include <utility>

namespace tessera::core::shading {

// Calls f(layer, place) for each lobe that some lane has; the place is a std::integral_constant.
template <typename T>
template <typename Self, typename F>
void ClosureOf<T>::for_each_present(Self& self, const F& f) {
  const auto visit = [&](auto& layer, auto slot) {
    if (any(layer.present)) f(layer, slot);
  };
  [&]<std::size_t... kEach>(std::index_sequence<kEach...>) {
    (visit(std::get<kEach>(self.layers_), std::integral_constant<std::size_t, kEach>()), ...);
  }
  (std::make_index_sequence<kSlots>());
}

template <typename T>
void ClosureOf<T>::orient(Vec3Of<T> tangent_local) {
  using std::sqrt;
  const T length2 = tangent_local.x * tangent_local.x + tangent_local.y * tangent_local.y;
  const MaskOf<T> known = length2 > 0;
  const T scale = 1 / sqrt(length2);
  tangent_ = {select(known, tangent_local.x * scale, tangent_.x),
              select(known, tangent_local.y * scale, tangent_.y)};
}

template <typename T>
Vec3Of<T> ClosureOf<T>::to_tangents(Vec3Of<T> w) const {
  return {tangent_.x * w.x + tangent_.y * w.y, tangent_.x * w.y - tangent_.y * w.x, w.z};
}

template <typename T>
Vec3Of<T> ClosureOf<T>::from_tangents(Vec3Of<T> w) const {
  return {tangent_.x * w.x - tangent_.y * w.y, tangent_.x * w.y + tangent_.y * w.x, w.z};
}

template <typename T>
void ClosureOf<T>::turn_coat(MaskOf<T> lanes, const FrameOf<T>& axes, Vec3Of<T> wo_local) {
  turned_coat_.lanes = lanes;
  turned_coat_.frame = {to_tangents(axes.tangent), to_tangents(axes.bitangent), to_tangents(axes.normal)};
  if (viewed_) shares_ = shares_seen_from(to_tangents(wo_local));
}

template <typename T>
Vec3Of<T> ClosureOf<T>::to_coat(Vec3Of<T> w) const {
  return any(turned_coat_.lanes) ? select(turned_coat_.lanes, turned_coat_.frame.to_local(w), w) : w;
}

// A turned coat scatters only to the side of the base's normal that the viewer is on: what a rough one
// scatters below the plane of the base is mirrored at that plane. Ideal reflection below it is lost.
template <typename T>
template <typename Lobe, typename Slot>
BsdfValueOf<T> ClosureOf<T>::evaluate_lobe(const Lobe& lobe, Slot, Vec3Of<T> wo, Vec3Of<T> wi,
                                           T diffuse_cos) const {
  if constexpr (Slot::value == kCoatSlot) {
    if (any(turned_coat_.lanes)) {
      const Vec3Of<T> viewer = to_coat(wo), below{wi.x, wi.y, -wi.z};
      const BsdfValueOf<T> direct = lobe.evaluate(viewer, to_coat(wi), diffuse_cos);
      const BsdfValueOf<T> mirrored = lobe.evaluate(viewer, to_coat(below), diffuse_cos);
      const BsdfValueOf<T> both =
          only_where<T>(wi.z > 0, {direct.value + mirrored.value, direct.pdf + mirrored.pdf});
      return {select(turned_coat_.lanes, both.value, direct.value),
              select(turned_coat_.lanes, both.pdf, direct.pdf)};
    }
  }
  return lobe.evaluate(wo, wi, diffuse_cos);
}

template <typename T>
template <typename Lobe, typename Slot>
BsdfSampleOf<T> ClosureOf<T>::sample_lobe(const Lobe& lobe, Slot, Vec3Of<T> wo, Vec2Of<T> u, T u_lobe) const {
  if constexpr (Slot::value == kCoatSlot) {
    if (any(turned_coat_.lanes)) {
      using std::fabs;
      BsdfSampleOf<T> sample = lobe.sample(to_coat(wo), u, u_lobe);
      const Vec3Of<T> wi = turned_coat_.frame.to_world(sample.wi_local);
      const Vec3Of<T> above{wi.x, wi.y, select(sample.delta, wi.z, fabs(wi.z))};
      sample.wi_local = select(turned_coat_.lanes, above, sample.wi_local);
      return sample;
    }
  }
  return lobe.sample(wo, u, u_lobe);
}

template <typename T>
MaskOf<T> ClosureOf<T>::is_delta() const {
  MaskOf<T> rough = last_ == WordOf<T>(kNoSlot);
  for_each_present(*this, [&](const auto& layer, std::size_t) {
    const MaskOf<T> delta = layer.lobe.is_delta();
    rough = rough | (layer.present & !delta);
  });
  return !rough;
}

template <typename T>
MaskOf<T> ClosureOf<T>::has_delta() const {
  MaskOf<T> found = false;
  for_each_present(*this, [&](const auto& layer, std::size_t) {
    const MaskOf<T> delta = layer.lobe.is_delta();
    found = found | (layer.present & delta);
  });
  return found;
}

template <typename T>
MaskOf<T> ClosureOf<T>::transmits() const {
  MaskOf<T> found = false;
  for_each_present(*this, [&](const auto& layer, std::size_t) {
    const MaskOf<T> passes = layer.lobe.transmits();
    found = found | (layer.present & passes);
  });
  return found;
}

template <typename T>
T ClosureOf<T>::transmitted_eta() const {
  const auto& glass = std::get<kGlassSlot>(layers_);
  return any(glass.present) ? select(glass.present, glass.lobe.eta(), T(1.0f)) : T(1.0f);
}

template <typename T>
void ClosureOf<T>::scale_diffuse(T factor) {
  for_each_present(*this, [&](auto& layer, std::size_t) {
    if (layer.lobe.kIsDiffuse) layer.weight *= factor;
  });
}

template <typename T>
typename ClosureOf<T>::Shares ClosureOf<T>::shares_at(T cos_o, T coat_cos_o) const {
  Shares shares;
  RgbOf<T> let_through = RgbOf<T>::gray(1);
  T sum{};
  for_each_present(*this, [&](const auto& layer, auto slot) {
    const T albedo = layer.lobe.albedo(slot == kCoatSlot ? coat_cos_o : cos_o);
    shares.light[slot] = layer.weight * let_through;
    shares.chance[slot] = select(layer.present, max_component(shares.light[slot]) * albedo, T(0.0f));
    sum = sum + shares.chance[slot];
    const RgbOf<T> passed =
        let_through * (layer.below.tint * larger(T(0.0f), 1 - layer.below.cover * albedo));
    let_through = select(layer.present, passed, let_through);
  });
  for_each_present(*this, [&](const auto&, std::size_t slot) {
    shares.chance[slot] = select(sum > 0, shares.chance[slot] / sum, T(0.0f));
  });
  return shares;
}

template <typename T>
BsdfValueOf<T> ClosureOf<T>::evaluate(const Shares& shares, Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const {
  BsdfValueOf<T> all_lobes{};
  for_each_present(*this, [&](const auto& layer, auto slot) {
    const MaskOf<T> seen = layer.present & (shares.chance[slot] > 0);
    if (!any(seen)) return;
    const BsdfValueOf<T> one = evaluate_lobe(layer.lobe, slot, wo, wi, diffuse_cos);
    all_lobes.value += select(seen, shares.light[slot] * one.value, RgbOf<T>{});
    all_lobes.pdf = all_lobes.pdf + select(seen, shares.chance[slot] * one.pdf, T(0.0f));
  });
  return all_lobes;
}

template <typename T>
BsdfValueOf<T> ClosureOf<T>::evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T diffuse_cos) const {
  const MaskOf<T> seen = !(wo_local.z <= 0);
  if (!any(seen)) return {};
  const Vec3Of<T> wo = to_tangents(wo_local), wi = to_tangents(wi_local);
  return only_where<T>(seen, viewed_ ? evaluate(shares_, wo, wi, diffuse_cos)
                                     : evaluate(shares_seen_from(wo), wo, wi, diffuse_cos));
}

template <typename T>
BsdfSampleOf<T> ClosureOf<T>::sample(Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const {
  return viewed_ ? sample(shares_, wo_local, u, u_lobe)
                 : sample(shares_seen_from(to_tangents(wo_local)), wo_local, u, u_lobe);
}

template <typename T>
BsdfSampleOf<T> ClosureOf<T>::sample(const Shares& shares, Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const {
  constexpr float kBelowOne = 1 - 0x1p-24f;
  BsdfSampleOf<T> sample;
  MaskOf<T> undecided = !(wo_local.z <= 0);
  if (!any(undecided)) return sample;
  const Vec3Of<T> wo = to_tangents(wo_local);
  T below{};  // the chance of the lobes before
  for_each_present(*this, [&](const auto& layer, auto slot) {
    const T chance = shares.chance[slot], next = below + chance;
    const MaskOf<T> is_last = last_ == WordOf<T>(static_cast<std::uint32_t>(slot));
    const MaskOf<T> chosen = undecided & layer.present & (is_last | !(u_lobe >= next));
    if (any(chosen)) {
      auto one = sample_lobe(layer.lobe, slot, wo, u, smaller((u_lobe - below) / chance, T(kBelowOne)));
      one.weight *= shares.light[slot] / chance;  // of a delta lobe
      one.found = one.found & (chance > 0);
      sample = select(chosen, one, sample);
      undecided = undecided & !chosen;
    }
    below = select(undecided & layer.present, next, below);
  });
  const MaskOf<T> rough = sample.found & !sample.delta;
  if (any(rough)) {
    const auto [value, pdf] = evaluate(shares, wo, sample.wi_local, sample.wi_local.z);
    sample.weight = select(sample.delta, sample.weight, value / pdf);
    sample.pdf = select(sample.delta, sample.pdf, pdf);
    sample.found = sample.found & (sample.delta | (pdf > 0));
  }
  sample.wi_local = from_tangents(sample.wi_local);
  return sample;
}

template <typename T>
DeltaBranches ClosureOf<T>::delta_branches(Vec3 wo_local) const {
  DeltaBranches all_lobes;
  if constexpr (std::is_same_v<T, float>) {
    if (wo_local.z <= 0) return all_lobes;
    const Vec3 wo = to_tangents(wo_local);
    const Shares shares = shares_seen_from(wo);
    const auto add = [&](std::optional<BsdfSample>& sum, const BsdfSample& branch, Rgb light) {
      if (!sum) {
        sum = branch;
        sum->weight = {};
      }
      sum->weight += branch.weight * light;
    };
    for_each_present(*this, [&](const auto& layer, auto slot) {
      const bool turned = slot == kCoatSlot && turned_coat_.lanes;
      auto branches = layer.lobe.delta_branches(turned ? to_coat(wo) : wo_local);
      if (turned && branches[0]) {
        branches[0]->wi_local = from_tangents(turned_coat_.frame.to_world(branches[0]->wi_local));
        return add(all_lobes.back(), *branches[0], shares.light[slot]);
      }
      for (std::size_t k = 0; k < branches.size(); ++k)
        if (branches[k]) add(all_lobes[k], *branches[k], shares.light[slot]);
    });
  }
  return all_lobes;
}

template class ClosureOf<float>;
template class ClosureOf<FloatN>;

}  // namespace tessera::core::shading
