// SPDX-License-Identifier: Apache-2.0
#include "core/lights/light_sampler.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/lights/normal_bins.hpp"

namespace tessera::core::lights {
namespace {

// Fraction of the choices that are uniform over all lights.
constexpr double kUniformShare = 0.1;
// Fraction of the other choices that are uniform over the tree and the lights at infinity, because the
// bounds of the whole tree may be inaccurate for a point among its lights.
constexpr double kEvenShare = 0.25;
// What a uniform environment counts beside lamps, for the same irradiance: found by experiment
// (docs/notebook/paths.md).
constexpr double kUniformWeight = 0.25;

}  // namespace

LightSampler::LightSampler(const std::vector<Light>& lights, Among among, int threads) {
  std::vector<LightTree::Item> placed;
  for (std::uint32_t i = 0; i < lights.size(); ++i) {
    if (among == Among::kDelta && !is_delta(lights[i])) continue;
    if (const auto* environment = std::get_if<Environment>(&lights[i])) {
      environment_ = EnvironmentLight{i, environment->importance_by_normal()};
      continue;
    }
    members_.push_back(i);
    if (const auto of_light = bounds(lights[i]))
      placed.push_back({*of_light, i});
    else if (const auto* directional = std::get_if<DirectionalLight>(&lights[i]))
      distant_.push_back({i, directional->wi(), directional->irradiance()});
  }
  if (environment_) members_.push_back(environment_->light);
  tree_ = LightTree::build(std::move(placed), threads);
}

LightSampler::ShadingPointCache LightSampler::shading_point_cache(const LightSampleContext& point,
                                                                  MisCompensation compensation) const {
  return {point, tree_.weigh_root(point), environment_ ? normal_bin(point.normal) : kAllSides, compensation};
}

LightSampler::Weight LightSampler::weight(const Distant& distant, const ShadingPointCache& at) {
  if (at.point.normal == Vec3{}) return weight(distant.irradiance);
  return weight(distant.irradiance * static_cast<double>(std::max(0.0f, dot(distant.wi, at.point.normal))));
}

// `others` is the irradiance from all other lights. With MIS compensation, the environment's part of the even
// choices is what light samples add to its light.
LightSampler::Weight LightSampler::environment_weight(const ShadingPointCache& at, double others) const {
  const auto& [uncompensated, total, excess] = environment_->by_facing[at.facing];
  if (at.compensation == MisCompensation::kOff) return weight(uncompensated);
  const double uniform = std::max(0.0, kUniformWeight * (total - 2 * excess) - others) / 2;
  const double irradiance = excess + uniform;
  return {irradiance, irradiance > 0 ? std::min(1.0, irradiance / total) : 0};
}

LightSampler::Weights LightSampler::weights(const ShadingPointCache& at) const {
  Weights all;
  const auto add = [&all](const Weight& weight) {
    all.sum.irradiance += weight.irradiance;
    all.sum.even += weight.even;
    return weight;
  };
  all.tree = add(weight(tree_.irradiance(at.root)));
  for (const Distant& distant : distant_) add(weight(distant, at));
  if (environment_) all.environment = add(environment_weight(at, all.sum.irradiance));
  return all;
}

double LightSampler::share(const Weights& all, const Weight& weight) {
  if (!(weight.irradiance > 0)) return 0;
  return (1 - kEvenShare) * weight.irradiance / all.sum.irradiance + kEvenShare * weight.even / all.sum.even;
}

LightSampler::Choice LightSampler::sample_by_place(const ShadingPointCache& at, double u) const {
  if (distant_.empty() && !environment_) return tree_.sample(at.root, at.point, u);
  const Weights all = weights(at);
  const double of_tree = share(all, all.tree);
  if (u < of_tree) {
    Choice choice = tree_.sample(at.root, at.point, u / of_tree);
    choice.pmf *= static_cast<float>(of_tree);
    return choice;
  }
  u -= of_tree;
  Choice choice{kNoLight, 0};  // the last candidate with power, in case rounding leaves u beyond it
  for (const Distant& distant : distant_) {
    const double of_light = share(all, weight(distant, at));
    if (of_light > 0) choice = {distant.light, static_cast<float>(of_light)};
    if (u < of_light) return choice;
    u -= of_light;
  }
  const double of_environment = share(all, all.environment);
  if (of_environment > 0) choice = {environment_->light, static_cast<float>(of_environment)};
  return choice;
}

std::optional<float> LightSampler::pmf_by_place(const ShadingPointCache& at, std::uint32_t light) const {
  if (tree_.contains(light)) {
    const float pmf = tree_.pmf(at.root, at.point, light);
    if (distant_.empty() && !environment_) return pmf;
    const Weights all = weights(at);
    return pmf * static_cast<float>(share(all, all.tree));
  }
  const Weights all = weights(at);
  if (environment_ && environment_->light == light) return static_cast<float>(share(all, all.environment));
  const auto distant = std::find_if(distant_.begin(), distant_.end(),
                                    [light](const Distant& each) { return each.light == light; });
  if (distant == distant_.end()) return std::nullopt;
  return static_cast<float>(share(all, weight(*distant, at)));
}

LightSampler::Choice LightSampler::sample(const LightSampleContext& point, double u,
                                          MisCompensation compensation) const {
  if (members_.size() == 1) return {members_[0], 1};
  return sample_at(shading_point_cache(point, compensation), u);
}

std::array<LightSampler::Choice, kLaneCount> LightSampler::sample(const LightSampleContexts& points,
                                                                  const std::array<double, kLaneCount>& u,
                                                                  unsigned asked,
                                                                  MisCompensation compensation) const {
  std::array<Choice, kLaneCount> choices;
  choices.fill(members_.size() == 1 ? Choice{members_[0], 1} : Choice{kNoLight, 0});
  if (members_.size() == 1) return choices;
  const Vec3Lanes position(points.position), normal(points.normal);
  const auto roots = tree_.weigh_root(points);
  const WordLanes facing(environment_ ? normal_bin(points.normal) : U32xN(kAllSides));
  for (; asked != 0; asked &= asked - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(asked));
    choices[lane] =
        sample_at({{position[lane], normal[lane]}, roots[lane], facing[lane], compensation}, u[lane]);
  }
  return choices;
}

// Whether uniform choices leave the light out: with MIS compensation, BSDF samples find all of the
// environment.
bool LightSampler::spared(std::uint32_t light, MisCompensation compensation) const {
  return compensation == MisCompensation::kOn && environment_ && environment_->light == light;
}

std::size_t LightSampler::uniform_count(MisCompensation compensation) const {
  return members_.size() - (spared(members_.back(), compensation) ? 1 : 0);
}

double LightSampler::uniform_pmf(MisCompensation compensation) const {
  return kUniformShare / static_cast<double>(uniform_count(compensation));
}

LightSampler::Choice LightSampler::sample_at(const ShadingPointCache& at, double u) const {
  const double uniform = uniform_pmf(at.compensation);
  Choice choice;
  if (u < kUniformShare) {
    const auto index = static_cast<std::size_t>(u / uniform);
    choice.light = members_[std::min(index, uniform_count(at.compensation) - 1)];
    choice.pmf = *pmf_by_place(at, choice.light);
  } else {
    choice = sample_by_place(at, (u - kUniformShare) / (1 - kUniformShare));
    if (choice.light == kNoLight) return choice;
  }
  return {choice.light, with_uniform(at, choice)};
}

// The probability of a light from that of choosing it by place.
float LightSampler::with_uniform(const ShadingPointCache& at, const Choice& by_place) const {
  const double uniform = spared(by_place.light, at.compensation) ? 0 : uniform_pmf(at.compensation);
  return static_cast<float>((1 - kUniformShare) * static_cast<double>(by_place.pmf) + uniform);
}

float LightSampler::pmf(const LightSampleContext& point, std::uint32_t light,
                        MisCompensation compensation) const {
  if (members_.size() == 1) return members_[0] == light ? 1 : 0;
  const ShadingPointCache at = shading_point_cache(point, compensation);
  const auto by_place = pmf_by_place(at, light);
  return by_place ? with_uniform(at, {light, *by_place}) : 0;
}

}  // namespace tessera::core::lights
