// SPDX-License-Identifier: Apache-2.0
// The parameters of a material's model at a point, or of a model in each lane at the lane's point. Keeps
// references.
#pragma once

#include <array>

#include "core/math/lane_array.hpp"
#include "core/shading/layered_materials.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

template <typename T, typename Model>
class ModelAt;

template <typename Model>
class ModelAt<float, Model> {
 public:
  ModelAt(const Model& model, const MaterialPoint& at) : model_(model), at_(at) {}

  const Model& first() const { return model_; }
  const MaterialPoint& at() const { return at_; }
  float operator()(ScalarParameter Model::*parameter) const {
    return (model_.*parameter).evaluate(at_.textures, at_.uv);
  }
  Rgb operator()(ColorParameter Model::*parameter) const {
    return (model_.*parameter).evaluate(at_.textures, at_.uv);
  }
  template <typename Predicate>
  bool holds(const Predicate& predicate) const {
    return predicate(model_);
  }

 private:
  const Model& model_;
  const MaterialPoint& at_;
};

template <typename Model>
class ModelAt<Float8, Model> {
 public:
  using Models = std::array<const Model*, kLaneCount>;

  ModelAt(const Models& models, const MaterialPointOf<Float8>& at) : models_(models), at_(at) {
    for (const Model* model : models_) is_one_ &= model == models_[0];
  }

  const Model& first() const { return *models_[0]; }
  const MaterialPointOf<Float8>& at() const { return at_; }
  Float8 operator()(ScalarParameter Model::*parameter) const { return evaluated<Float8>(parameter); }
  RgbOf<Float8> operator()(ColorParameter Model::*parameter) const {
    return evaluated<RgbOf<Float8>>(parameter);
  }
  template <typename Predicate>
  Mask8 holds(const Predicate& predicate) const {
    unsigned lanes = 0;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane)
      lanes |= (predicate(*models_[lane]) ? 1u : 0u) << lane;
    return Mask8::from_bits(lanes);
  }

 private:
  template <typename Result, typename Parameter>
  Result evaluated(Parameter Model::*parameter) const {
    const Parameter& first = models_[0]->*parameter;
    if (is_one_ && first.texture < 0) return in_every_lane(first.value);
    std::array<const Parameter*, kLaneCount> parameters;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) parameters[lane] = &(models_[lane]->*parameter);
    return evaluate(parameters, at_.textures, at_.uv);
  }
  static Float8 in_every_lane(float value) { return value; }
  static RgbOf<Float8> in_every_lane(Rgb value) { return {value.r, value.g, value.b}; }

  const Models& models_;
  const MaterialPointOf<Float8>& at_;
  bool is_one_ = true;  // the same model in all lanes
};

}  // namespace tessera::core
