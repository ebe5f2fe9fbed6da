// SPDX-License-Identifier: Apache-2.0
// The film's sensor: the factor between the radiance of the scene and the values of the image. Our images
// hold radiance, so it is applied to everything that emits.
#pragma once

#include <optional>

#include "core/math/rgb.hpp"
#include "core/spectra/color_space.hpp"

namespace tessera::core::pbrt {

struct Exposure {
  float imaging_ratio = 1;
  std::optional<spectra::ColorMatrix> white_balance{};

  // The colour in the image of an emitted one.
  Rgb operator()(Rgb emitted) const {
    return (white_balance ? (*white_balance)(emitted) : emitted) * imaging_ratio;
  }
};

}  // namespace tessera::core::pbrt
