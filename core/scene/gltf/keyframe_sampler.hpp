// SPDX-License-Identifier: Apache-2.0
// A sampler of an animation (Khronos Group 2021, glTF 2.0 specification, section 3.11 and appendix C). Not
// thread-safe; functions throw Refusals.
#pragma once

#include <cstddef>
#include <vector>

#include "core/scene/gltf/accessor.hpp"

namespace tessera::core::gltf {

// Each keyframe has some numbers, in elements of an accessor or one in each; with a cubic spline it has them
// three times: the tangent before it, the value, and the tangent behind it.
class KeyframeSampler {
 public:
  KeyframeSampler(const Value& sampler, Accessors& accessors, std::size_t components);

  // Of weights of morph targets, which are numbers in a row.
  void split_weights();

  bool empty() const { return count_ == 0; }
  std::size_t keyframes() const { return count_; }
  std::vector<float> value_of(std::size_t keyframe) const { return numbers(keyframe, kValue); }
  // How many numbers a keyframe has.
  std::size_t width() const { return row_ > 0 ? row_ : values_.components(); }
  // The value at a time; rotations are quaternions. Before the first keyframe and after the last one it is
  // constant.
  std::vector<float> at(float seconds, bool is_rotation) const;

 private:
  enum class Interpolation { kStep, kLinear, kCubicSpline };
  enum Part : std::size_t { kTangentBefore, kValue, kTangentBehind };
  // The keyframes around a time.
  struct Between {
    std::size_t before = 0, after = 0;
    float part = 0;     // of the way from one to the other, from 0 to 1
    float seconds = 0;  // from one to the other
  };

  static Interpolation interpolation_of(const Value& sampler);
  // Times increase. Of a damaged file, some keyframes are found.
  Between locate(float seconds) const;
  std::size_t parts() const { return interpolation_ == Interpolation::kCubicSpline ? 3 : 1; }
  std::vector<float> numbers(std::size_t keyframe, Part part) const;
  std::vector<float> spline(const Between& between, const std::vector<float>& before,
                            const std::vector<float>& after) const;

  Interpolation interpolation_;
  Accessor times_, values_;
  std::size_t count_ = 0;  // of keyframes
  std::size_t row_ = 0;    // numbers of a keyframe that are elements of their own; 0: they are one element
};

}  // namespace tessera::core::gltf
