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

// u of choices by place from that of all choices.
template <typename Wide>
Wide by_place_u(Wide u) {
  return (u - kUniformShare) / (1 - kUniformShare);
}

// `value_of` the word in each lane.
template <typename ValueOf>
double look_up(const ValueOf& value_of, std::uint32_t word) {
  return value_of(word);
}
template <typename ValueOf>
DoubleN look_up(const ValueOf& value_of, U32xN words) {
  const WordLanes of_lanes(words);
  return DoubleN::of([&](std::size_t lane) { return value_of(of_lanes[lane]); });
}

}  // namespace

// Of a light that has its part of the even choices wherever it contributes.
template <typename T>
LightSampler::WeightOf<T> LightSampler::weight(WideOf<T> irradiance) {
  using Wide = WideOf<T>;
  return {irradiance, select(irradiance > 0, Wide(1), Wide(0))};
}

// The probability of a candidate in choices by place.
template <typename T>
WideOf<T> LightSampler::share(const WeightOf<T>& sum, const WeightOf<T>& weight) {
  using Wide = WideOf<T>;
  return select(weight.irradiance > 0,
                (1 - kEvenShare) * weight.irradiance / sum.irradiance + kEvenShare * weight.even / sum.even,
                Wide(0));
}

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

template <typename T>
LightSampler::ShadingPointOf<T> LightSampler::shading_point(const LightSampleContextOf<T>& context,
                                                            MisCompensation compensation) const {
  return {context, tree_.weigh_root(context),
          environment_ ? normal_bin(context.normal) : WordOf<T>(std::uint32_t{kAllSides}), compensation};
}

template <typename T>
LightSampler::WeightOf<T> LightSampler::weight(const Distant& distant, const ShadingPointOf<T>& at) {
  const Vec3Of<T>& normal = at.context.normal;
  const Vec3Of<T> wi{distant.wi.x, distant.wi.y, distant.wi.z};
  const MaskOf<T> no_normal = (normal.x == 0) & (normal.y == 0) & (normal.z == 0);
  return weight<T>(distant.irradiance *
                   widened(select(no_normal, T(1.0f), larger(T(0.0f), dot(wi, normal)))));
}

// `others` is the irradiance from all other lights. With MIS compensation, the environment's part of the even
// choices is what light samples add to its light.
template <typename T>
LightSampler::WeightOf<T> LightSampler::environment_weight(const ShadingPointOf<T>& at,
                                                           WideOf<T> others) const {
  using Wide = WideOf<T>;
  using Importance = EnvironmentDistribution::Importance;
  const auto importance = [&](double Importance::*part) {
    return look_up([&](std::uint32_t facing) { return environment_->by_facing[facing].*part; }, at.facing);
  };
  if (at.compensation == MisCompensation::kOff) return weight<T>(importance(&Importance::uncompensated));
  const Wide total = importance(&Importance::total), excess = importance(&Importance::excess);
  const Wide uniform = larger(Wide(0), kUniformWeight * (total - 2 * excess) - others) / 2;
  const Wide irradiance = excess + uniform;
  return {irradiance, select(irradiance > 0, smaller(Wide(1), irradiance / total), Wide(0))};
}

template <typename T>
LightSampler::WeightsOf<T> LightSampler::weights(const ShadingPointOf<T>& at) const {
  WeightsOf<T> all{};
  const auto add = [&all](const WeightOf<T>& weight) {
    all.sum.irradiance = all.sum.irradiance + weight.irradiance;
    all.sum.even = all.sum.even + weight.even;
    return weight;
  };
  all.tree = add(weight<T>(tree_.irradiance(at.root)));
  for (const Distant& distant : distant_) add(weight(distant, at));
  if (environment_) all.environment = add(environment_weight(at, all.sum.irradiance));
  return all;
}

template <typename T>
LightSampler::PlaceChoiceOf<T> LightSampler::choose_by_place(const ShadingPointOf<T>& at, WideOf<T> u) const {
  if (distant_.empty() && !environment_) return {kNoLight, 1.0f, true, u};
  const WeightsOf<T> all = weights(at);
  const WideOf<T> of_tree = share<T>(all.sum, all.tree);
  const MaskOf<T> in_tree = u < of_tree;
  PlaceChoiceOf<T> choice{kNoLight, select(in_tree, to_float(of_tree), T(0.0f)), in_tree, u / of_tree};
  MaskOf<T> chosen = in_tree;
  u = u - of_tree;
  // If rounding leaves u beyond the last candidate, that is taken which is the last with power.
  const auto offer = [&](std::uint32_t light, const WeightOf<T>& weight) {
    const WideOf<T> of_light = share<T>(all.sum, weight);
    const MaskOf<T> taken = (of_light > 0) & !chosen;
    choice.light = select(taken, WordOf<T>(light), choice.light);
    choice.pmf = select(taken, to_float(of_light), choice.pmf);
    chosen = chosen | (u < of_light);
    u = u - of_light;
  };
  for (const Distant& distant : distant_) offer(distant.light, weight(distant, at));
  if (environment_) offer(environment_->light, all.environment);
  return choice;
}

std::optional<float> LightSampler::pmf_by_place(const ShadingPoint& at, std::uint32_t light) const {
  if (tree_.contains(light)) {
    const float pmf = tree_.pmf(at.root, at.context, light);
    if (distant_.empty() && !environment_) return pmf;
    const WeightsOf<float> all = weights(at);
    return pmf * static_cast<float>(share<float>(all.sum, all.tree));
  }
  const WeightsOf<float> all = weights(at);
  if (environment_ && environment_->light == light)
    return static_cast<float>(share<float>(all.sum, all.environment));
  const auto distant = std::find_if(distant_.begin(), distant_.end(),
                                    [light](const Distant& each) { return each.light == light; });
  if (distant == distant_.end()) return std::nullopt;
  return static_cast<float>(share<float>(all.sum, weight(*distant, at)));
}

LightSampler::Choice LightSampler::sample(const LightSampleContext& point, double u,
                                          MisCompensation compensation) const {
  if (members_.size() == 1) return {members_[0], 1};
  const ShadingPoint at = shading_point(point, compensation);
  Choice choice;
  if (u < kUniformShare) {
    choice.light = uniform_light(u, compensation);
    choice.pmf = *pmf_by_place(at, choice.light);
  } else {
    const auto by_place = choose_by_place(at, by_place_u(u));
    choice = {by_place.light, by_place.pmf};
    if (by_place.in_tree) {
      choice = tree_.sample(at.root, at.context, by_place.u);
      choice.pmf *= by_place.pmf;
    }
  }
  return {choice.light, with_uniform(choice.light, choice.pmf, compensation)};
}

LightSampler::ChoicesInLanes LightSampler::sample(const LightSampleContexts& points, const DoubleLanes& u,
                                                  unsigned asked, MisCompensation compensation) const {
  if (members_.size() == 1) return {members_[0], 1.0f};
  const ShadingPointOf<FloatN> at = shading_point(points, compensation);
  const auto by_place = choose_by_place(at, by_place_u(u.all()));
  ChoicesInLanes choices{by_place.light, by_place.pmf};
  const unsigned uniform = (u.all() < DoubleN(kUniformShare)).bits() & asked;
  if (const unsigned in_tree = by_place.in_tree.bits() & asked & ~uniform; in_tree != 0) {
    const auto [light, pmf] = tree_.sample(at.root, points, by_place.u, in_tree);
    choices.light = select(by_place.in_tree, light, choices.light);
    choices.pmf = select(by_place.in_tree, pmf * choices.pmf, choices.pmf);
  }
  if (uniform != 0) choose_uniformly(at, u, uniform, choices);
  return {choices.light, with_uniform(choices.light, choices.pmf, compensation)};
}

// In lanes whose bits are set. The probabilities are those of choosing by place.
void LightSampler::choose_uniformly(const ShadingPointOf<FloatN>& at, const DoubleLanes& u, unsigned lanes,
                                    ChoicesInLanes& choices) const {
  const Vec3Lanes positions(at.context.position), normals(at.context.normal);
  const WordLanes facings(at.facing);
  WordLanes lights(choices.light);
  FloatLanes pmf(choices.pmf);
  for (; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
    const ShadingPoint point{{positions[lane], normals[lane]}, at.root[lane], facings[lane], at.compensation};
    const std::uint32_t light = uniform_light(u[lane], at.compensation);
    lights.set(lane, light);
    pmf.set(lane, *pmf_by_place(point, light));
  }
  choices = {lights.all(), pmf.all()};
}

// Whether uniform choices leave the light out: with MIS compensation, BSDF samples find all of the
// environment.
bool LightSampler::spares_environment(MisCompensation compensation) const {
  return compensation == MisCompensation::kOn && environment_;
}

std::size_t LightSampler::uniform_count(MisCompensation compensation) const {
  return members_.size() - (spares_environment(compensation) ? 1 : 0);
}

double LightSampler::uniform_pmf(MisCompensation compensation) const {
  return kUniformShare / static_cast<double>(uniform_count(compensation));
}

std::uint32_t LightSampler::uniform_light(double u, MisCompensation compensation) const {
  const auto index = static_cast<std::size_t>(u / uniform_pmf(compensation));
  return members_[std::min(index, uniform_count(compensation) - 1)];
}

// The probability of a light from that of choosing it by place.
template <typename T>
T LightSampler::with_uniform(WordOf<T> light, T pmf_by_place, MisCompensation compensation) const {
  using Wide = WideOf<T>;
  Wide uniform = uniform_pmf(compensation);
  if (spares_environment(compensation))
    uniform = select(light == WordOf<T>(environment_->light), Wide(0), uniform);
  return select(light == WordOf<T>(kNoLight), T(0.0f),
                to_float((1 - kUniformShare) * widened(pmf_by_place) + uniform));
}

float LightSampler::pmf(const LightSampleContext& point, std::uint32_t light,
                        MisCompensation compensation) const {
  if (members_.size() == 1) return members_[0] == light ? 1 : 0;
  const auto by_place = pmf_by_place(shading_point(point, compensation), light);
  return by_place ? with_uniform(light, *by_place, compensation) : 0;
}

template <typename T>
T LightSampler::environment_pmf(const LightSampleContextOf<T>& point, MisCompensation compensation) const {
  if (members_.size() == 1) return 1.0f;
  const WeightsOf<T> all = weights(shading_point(point, compensation));
  return with_uniform(WordOf<T>(environment_->light), to_float(share<T>(all.sum, all.environment)),
                      compensation);
}

template float LightSampler::environment_pmf(const LightSampleContext&, MisCompensation) const;
template FloatN LightSampler::environment_pmf(const LightSampleContexts&, MisCompensation) const;

}  // namespace tessera::core::lights
