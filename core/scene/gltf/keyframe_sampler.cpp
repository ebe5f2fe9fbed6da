// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/keyframe_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/math/quaternion.hpp"

namespace tessera::core::gltf {
namespace {

Quaternion unit_quaternion(const std::vector<float>& q) {
  const float norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(norm > 0) || !std::isfinite(norm)) return {};
  return {q[3] / norm, q[0] / norm, q[1] / norm, q[2] / norm};
}

std::vector<float> turned(const std::vector<float>& before, const std::vector<float>& after, float part) {
  const Quaternion q = slerp(unit_quaternion(before), unit_quaternion(after), part);
  return {q.x, q.y, q.z, q.w};
}

}  // namespace

KeyframeSampler::Interpolation KeyframeSampler::interpolation_of(const Value& sampler) {
  const std::string name = sampler.text("interpolation");
  if (name == "STEP") return Interpolation::kStep;
  return name == "CUBICSPLINE" ? Interpolation::kCubicSpline : Interpolation::kLinear;
}

KeyframeSampler::KeyframeSampler(const Value& sampler, Accessors& accessors, std::size_t components)
    : interpolation_(interpolation_of(sampler)),
      times_(accessors.read(sampler["input"], 1)),
      values_(accessors.read(sampler["output"], components)) {
  count_ = std::min(times_.count(), values_.count() / parts());
}

void KeyframeSampler::split_weights() {
  if (times_.count() == 0) return;
  row_ = values_.count() / times_.count() / parts();
  count_ = row_ == 0 ? 0 : times_.count();
}

KeyframeSampler::Between KeyframeSampler::locate(float seconds) const {
  std::size_t begin = 0, end = count_;  // of those among which the first later one is
  while (begin < end) {
    const std::size_t middle = begin + (end - begin) / 2;
    if (times_.number(middle, 0) > seconds)
      end = middle;
    else
      begin = middle + 1;
  }
  if (begin == 0) return {};
  if (begin == count_) return {count_ - 1, count_ - 1, 0, 0};
  const float from = times_.number(begin - 1, 0), span = times_.number(begin, 0) - from;
  const float part = (seconds - from) / span;
  return {begin - 1, begin, part >= 0 && part <= 1 ? part : 0, span};
}

std::vector<float> KeyframeSampler::at(float seconds, bool is_rotation) const {
  const Between between = locate(seconds);
  std::vector<float> before = numbers(between.before, kValue);
  if (between.part == 0 || interpolation_ == Interpolation::kStep) return before;
  const std::vector<float> after = numbers(between.after, kValue);
  if (interpolation_ == Interpolation::kCubicSpline) return spline(between, before, after);
  if (is_rotation) return turned(before, after, between.part);
  for (std::size_t c = 0; c < before.size(); ++c) before[c] += (after[c] - before[c]) * between.part;
  return before;
}

std::vector<float> KeyframeSampler::numbers(std::size_t keyframe, Part part) const {
  const std::size_t at = parts() == 1 ? keyframe : 3 * keyframe + part;
  std::vector<float> found;
  for (std::size_t i = 0; i < row_; ++i) found.push_back(values_.number(at * row_ + i, 0));
  for (std::size_t c = 0; row_ == 0 && c < values_.components(); ++c) found.push_back(values_.number(at, c));
  return found;
}

// Hermite's polynomials (appendix C.5 of the specification).
std::vector<float> KeyframeSampler::spline(const Between& between, const std::vector<float>& before,
                                           const std::vector<float>& after) const {
  const std::vector<float> leaving = numbers(between.before, kTangentBehind),
                           arriving = numbers(between.after, kTangentBefore);
  const float t = between.part, t2 = t * t, t3 = t2 * t;
  std::vector<float> values;
  for (std::size_t c = 0; c < before.size(); ++c)
    values.push_back((2 * t3 - 3 * t2 + 1) * before[c] + between.seconds * (t3 - 2 * t2 + t) * leaving[c] +
                     (3 * t2 - 2 * t3) * after[c] + between.seconds * (t3 - t2) * arriving[c]);
  return values;
}

}  // namespace tessera::core::gltf
