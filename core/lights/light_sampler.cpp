// SPDX-License-Identifier: Apache-2.0
#include "core/lights/light_sampler.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/lights/normal_bins.hpp"

namespace tessera::core {
namespace {

// Fraction of the choices that are uniform over all lights.
constexpr double kUniformShare = 0.1;
// Fraction of the other choices that are uniform over the tree and the lights at infinity, because the
// bounds of the whole tree may be inaccurate for a point among its lights.
constexpr double kEvenShare = 0.25;

}  // namespace

LightSampler::LightSampler(const std::vector<Light>& lights, Among among, int threads) {
  std::vector<LightTree::Item> placed;
  for (std::uint32_t i = 0; i < lights.size(); ++i) {
    if (among == Among::kDelta && !is_delta(lights[i])) continue;
    members_.push_back(i);
    if (const auto of_light = bounds(lights[i]))
      placed.push_back({*of_light, i});
    else if (const auto* directional = std::get_if<DirectionalLight>(&lights[i]))
      distant_.push_back({.light = i, .wi = directional->wi(), .irradiance = directional->irradiance()});
    else
      distant_.push_back(
          {.light = i, .by_facing = std::get_if<Environment>(&lights[i])->importance_by_normal()});
  }
  any_all_around_ = std::any_of(distant_.begin(), distant_.end(),
                                [](const Distant& distant) { return !distant.by_facing.empty(); });
  tree_ = LightTree::build(std::move(placed), threads);
}

LightSampler::ShadingPointCache LightSampler::shading_point_cache(const LightSampleContext& point) const {
  return {point, tree_.weigh_root(point), any_all_around_ ? normal_bin(point.normal) : kAllSides};
}

double LightSampler::irradiance(const Distant& distant, const ShadingPointCache& at) {
  if (!distant.by_facing.empty()) return distant.by_facing[at.facing];
  if (at.point.normal == Vec3{}) return distant.irradiance;
  return distant.irradiance * static_cast<double>(std::max(0.0f, dot(distant.wi, at.point.normal)));
}

LightSampler::Total LightSampler::total(const ShadingPointCache& at) const {
  Total total;
  const auto add = [&](double irradiance) {
    total.irradiance += irradiance;
    total.alternatives += irradiance > 0 ? 1 : 0;
    return irradiance;
  };
  total.tree = add(tree_.irradiance(at.root));
  for (const Distant& distant : distant_) add(irradiance(distant, at));
  return total;
}

double LightSampler::share(const Total& total, double irradiance) {
  if (!(irradiance > 0)) return 0;
  return (1 - kEvenShare) * irradiance / total.irradiance + kEvenShare / total.alternatives;
}

LightSampler::Choice LightSampler::sample_by_place(const ShadingPointCache& at, double u) const {
  if (distant_.empty()) return tree_.sample(at.root, at.point, u);
  const Total all = total(at);
  const double of_tree = share(all, all.tree);
  if (u < of_tree) {
    Choice choice = tree_.sample(at.root, at.point, u / of_tree);
    choice.pmf *= static_cast<float>(of_tree);
    return choice;
  }
  u -= of_tree;
  Choice choice{kNoLight, 0};  // the last candidate with power, in case rounding leaves u beyond it
  for (const Distant& distant : distant_) {
    const double of_light = share(all, irradiance(distant, at));
    if (of_light > 0) choice = {distant.light, static_cast<float>(of_light)};
    if (u < of_light) break;
    u -= of_light;
  }
  return choice;
}

std::optional<float> LightSampler::pmf_by_place(const ShadingPointCache& at, std::uint32_t light) const {
  if (tree_.contains(light)) {
    const float pmf = tree_.pmf(at.root, at.point, light);
    if (distant_.empty()) return pmf;
    const Total all = total(at);
    return pmf * static_cast<float>(share(all, all.tree));
  }
  const auto distant = std::find_if(distant_.begin(), distant_.end(),
                                    [light](const Distant& each) { return each.light == light; });
  if (distant == distant_.end()) return std::nullopt;
  return static_cast<float>(share(total(at), irradiance(*distant, at)));
}

LightSampler::Choice LightSampler::sample(const LightSampleContext& point, double u) const {
  return members_.size() == 1 ? Choice{members_[0], 1} : sample_at(shading_point_cache(point), u);
}

std::array<LightSampler::Choice, kLaneCount> LightSampler::sample(const LightSampleContexts& points,
                                                                  const std::array<double, kLaneCount>& u,
                                                                  unsigned asked) const {
  std::array<Choice, kLaneCount> choices;
  choices.fill(members_.size() == 1 ? Choice{members_[0], 1} : Choice{kNoLight, 0});
  if (members_.size() == 1) return choices;
  const Vec3Lanes position(points.position), normal(points.normal);
  const auto roots = tree_.weigh_root(points);
  const WordLanes facing(any_all_around_ ? normal_bin(points.normal) : U32x8(kAllSides));
  for (; asked != 0; asked &= asked - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(asked));
    choices[lane] = sample_at({{position[lane], normal[lane]}, roots[lane], facing[lane]}, u[lane]);
  }
  return choices;
}

LightSampler::Choice LightSampler::sample_at(const ShadingPointCache& at, double u) const {
  const double uniform = kUniformShare / static_cast<double>(members_.size());
  Choice choice;
  if (u < kUniformShare) {
    const auto index = static_cast<std::size_t>(u / uniform);
    choice.light = members_[std::min(index, members_.size() - 1)];
    choice.pmf = *pmf_by_place(at, choice.light);
  } else {
    choice = sample_by_place(at, (u - kUniformShare) / (1 - kUniformShare));
    if (choice.light == kNoLight) return choice;
  }
  choice.pmf = static_cast<float>((1 - kUniformShare) * static_cast<double>(choice.pmf) + uniform);
  return choice;
}

float LightSampler::pmf(const LightSampleContext& point, std::uint32_t light) const {
  if (members_.size() == 1) return members_[0] == light ? 1 : 0;
  const auto by_place = pmf_by_place(shading_point_cache(point), light);
  if (!by_place) return 0;
  return static_cast<float>((1 - kUniformShare) * static_cast<double>(*by_place) +
                            kUniformShare / static_cast<double>(members_.size()));
}

}  // namespace tessera::core
