// SPDX-License-Identifier: Apache-2.0
#include "core/materials/lobe_mixture.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace tessera::core {

LobeMixture& LobeMixture::operator=(const LobeMixture& other) {
  std::copy_n(other.layers_.begin(), other.count_, layers_.begin());
  count_ = other.count_;
  tangent_ = other.tangent_;
  return *this;
}

void LobeMixture::add(const Lobe& lobe, Rgb weight, const Below& below) {
  if (is_black(weight) && below.cover == 0 && below.tint == Rgb::gray(1)) return;
  assert(count_ < kMaxLobes);
  layers_[count_++] = {lobe, weight, below};
}

void LobeMixture::orient(Vec3 tangent_local) {
  const float length2 = tangent_local.x * tangent_local.x + tangent_local.y * tangent_local.y;
  if (!(length2 > 0)) return;
  const float scale = 1 / std::sqrt(length2);
  tangent_ = {tangent_local.x * scale, tangent_local.y * scale};
}

Vec3 LobeMixture::to_tangents(Vec3 w) const {
  return {tangent_.x * w.x + tangent_.y * w.y, tangent_.x * w.y - tangent_.y * w.x, w.z};
}

Vec3 LobeMixture::from_tangents(Vec3 w) const {
  return {tangent_.x * w.x - tangent_.y * w.y, tangent_.x * w.y + tangent_.y * w.x, w.z};
}

template <typename Predicate>
bool LobeMixture::any_lobe(const Predicate& predicate) const {
  return std::any_of(layers_.begin(), layers_.begin() + static_cast<std::ptrdiff_t>(count_),
                     [&](const Layer& layer) { return std::visit(predicate, layer.lobe); });
}

bool LobeMixture::is_delta() const {
  return count_ > 0 && !any_lobe([](const auto& lobe) { return !lobe.is_delta(); });
}

bool LobeMixture::has_delta() const {
  return any_lobe([](const auto& lobe) { return lobe.is_delta(); });
}

bool LobeMixture::transmits() const {
  return any_lobe([](const auto& lobe) { return lobe.transmits(); });
}

float LobeMixture::transmitted_eta() const {
  for (std::size_t i = 0; i < count_; ++i)
    if (const auto* glass = std::get_if<GlassLobe>(&layers_[i].lobe)) return glass->eta();
  return 1;
}

void LobeMixture::scale_diffuse(float factor) {
  for (std::size_t i = 0; i < count_; ++i)
    if (std::visit([](const auto& lobe) { return lobe.kIsDiffuse; }, layers_[i].lobe))
      layers_[i].weight *= factor;
}

LobeMixture::Shares LobeMixture::shares_at(float cos_o) const {
  Shares shares;
  Rgb let_through = Rgb::gray(1);
  float sum = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Layer& layer = layers_[i];
    const float albedo = std::visit([&](const auto& lobe) { return lobe.albedo(cos_o); }, layer.lobe);
    shares.light[i] = layer.weight * let_through;
    shares.chance[i] = max_component(shares.light[i]) * albedo;
    sum += shares.chance[i];
    let_through *= layer.below.tint * std::max(0.0f, 1 - layer.below.cover * albedo);
  }
  for (std::size_t i = 0; i < count_; ++i) shares.chance[i] = sum > 0 ? shares.chance[i] / sum : 0;
  return shares;
}

BsdfValue LobeMixture::evaluate(const Shares& shares, Vec3 wo, Vec3 wi, float diffuse_cos) const {
  BsdfValue all{};
  for (std::size_t i = 0; i < count_; ++i) {
    if (!(shares.chance[i] > 0)) continue;
    const BsdfValue one =
        std::visit([&](const auto& lobe) { return lobe.evaluate(wo, wi, diffuse_cos); }, layers_[i].lobe);
    all.value += shares.light[i] * one.value;
    all.pdf += shares.chance[i] * one.pdf;
  }
  return all;
}

BsdfValue LobeMixture::evaluate(Vec3 wo_local, Vec3 wi_local, float diffuse_cos) const {
  if (wo_local.z <= 0) return {};
  return evaluate(shares_at(wo_local.z), to_tangents(wo_local), to_tangents(wi_local), diffuse_cos);
}

std::optional<BsdfSample> LobeMixture::sample(Vec3 wo_local, Vec2 u, float u_lobe) const {
  if (wo_local.z <= 0) return std::nullopt;
  const Shares shares = shares_at(wo_local.z);
  std::size_t chosen = 0;
  float below = 0;  // the chance of the lobes before the chosen one
  while (chosen + 1 < count_ && u_lobe >= below + shares.chance[chosen]) below += shares.chance[chosen++];
  if (count_ == 0 || !(shares.chance[chosen] > 0)) return std::nullopt;
  constexpr float kBelowOne = 1 - 0x1p-24f;
  const float u_inside = std::min((u_lobe - below) / shares.chance[chosen], kBelowOne);
  const Vec3 wo = to_tangents(wo_local);
  auto sample =
      std::visit([&](const auto& lobe) { return lobe.sample(wo, u, u_inside); }, layers_[chosen].lobe);
  if (!sample) return std::nullopt;
  if (sample->delta) {
    sample->weight *= shares.light[chosen] / shares.chance[chosen];
  } else {
    const BsdfValue all = evaluate(shares, wo, sample->wi_local, sample->wi_local.z);
    if (!(all.pdf > 0)) return std::nullopt;
    sample->weight = all.value / all.pdf;
    sample->pdf = all.pdf;
  }
  sample->wi_local = from_tangents(sample->wi_local);
  return sample;
}

std::array<std::optional<BsdfSample>, 2> LobeMixture::delta_branches(Vec3 wo_local) const {
  if (wo_local.z <= 0) return {};
  const Shares shares = shares_at(wo_local.z);
  std::array<std::optional<BsdfSample>, 2> all;
  for (std::size_t i = 0; i < count_; ++i) {
    const auto branches =
        std::visit([&](const auto& lobe) { return lobe.delta_branches(wo_local); }, layers_[i].lobe);
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (!branches[k]) continue;
      const Rgb weight = branches[k]->weight * shares.light[i];
      if (!all[k]) {
        all[k] = branches[k];
        all[k]->weight = {};
      }
      all[k]->weight += weight;
    }
  }
  return all;
}

}  // namespace tessera::core
