// SPDX-License-Identifier: Apache-2.0
// Every model that scatters into more than single directions, in every way of sampling it, for the tests that
// all of them must pass.
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "core/math/frame.hpp"
#include "core/shading/bsdf.hpp"

namespace tessera::core::test {

struct BsdfCase {
  std::string name;
  Material material;
  bool outside = true;
  std::optional<Frame> coat{};  // of its own

  shading::Bsdf bsdf() const {
    shading::Bsdf made(material, {}, {}, outside);
    if (coat) made.turn_coat(true, *coat, {});
    return made;
  }
};

inline void PrintTo(const BsdfCase& one, std::ostream* os) {
  *os << one.name;
}

std::vector<BsdfCase> bsdf_cases();

// A frame whose normal is above none of the viewers' horizons, and leans.
Frame leaning_frame();

// A viewer above, one aside and one at a low angle.
std::vector<Vec3> viewers();

// The i-th of independent points of the unit square and a third number.
struct Numbers {
  Vec2 u;
  float u_lobe;
};
Numbers random_numbers(int i);

inline Material material_of(MaterialModel model, Sampling sampling = Sampling::kBsdf) {
  return {.name = "", .model = std::move(model), .sampling = sampling};
}

}  // namespace tessera::core::test
