// SPDX-License-Identifier: Apache-2.0
// Indices of refraction by the names that Mitsuba knows. Stateless; thread-safe.
#pragma once

#include <optional>
#include <string_view>

#include "core/materials/conductor.hpp"
#include "core/scene/mitsuba/plugin.hpp"

namespace tessera::core::mitsuba {

// Of a dielectric, ignoring case: "water" (Hecht, Optics, 4th edition, at 589 nm). nullopt if it is unknown.
std::optional<float> refractive_index(std::string_view name);

// The index of `name`, a number or the name of a dielectric; that of `otherwise` if there is none.
float refractive_index(const Plugin& plugin, std::string_view name, std::string_view otherwise);

struct Metal {
  Conductor conductor = Conductor::kAluminium;
  bool is_substitute = false;  // another one, whose reflectance is near
};
// By the chemical symbol: "Au". nullopt if it is unknown.
std::optional<Metal> find_metal(std::string_view name);

// The boundary of a dielectric.
struct Boundary {
  float ratio = 1;           // of the index inside to that outside, or the reciprocal; 1 or more
  bool is_reversed = false;  // the denser side is outside
};
// By "int_ior" and "ext_ior".
Boundary boundary_of(const Plugin& plugin, std::string_view default_inside);

}  // namespace tessera::core::mitsuba
