// SPDX-License-Identifier: Apache-2.0
// Which keys of a material model have an effect beside its others. The others are not written, and scenes of
// other programs have their defaults.
#pragma once

#include <string_view>

#include "core/materials/material.hpp"

namespace tessera::core {

template <typename Model>
bool has_effect(const Model&, std::string_view) {
  return true;
}
// A metal has its own reflectance.
inline bool has_effect(const CookTorrance& model, std::string_view key) {
  return !(model.conductor && key == "f0");
}
// Its parameter tells the pigment.
inline bool has_effect(const Hair& model, std::string_view key) {
  if (key == "reflectance") return model.pigment == HairPigment::kReflectance;
  if (key == "sigma_a") return model.pigment == HairPigment::kAbsorption;
  return !key.ends_with("melanin") || model.pigment == HairPigment::kMelanin;
}

}  // namespace tessera::core
