// SPDX-License-Identifier: Apache-2.0
// The reflectance of a surface under a thin film, whose interference colours it (Belcour and Barla 2017).
#pragma once

#include "core/math/rgb.hpp"

namespace tessera::core {

class FilmReflectance {
 public:
  // `f0` is the reflectance of the bare surface at normal incidence. The film covers the share `weight` of
  // it; its thickness is in micrometres.
  FilmReflectance(Rgb f0, float weight, float film_ior, float thickness);

  Rgb operator()(float cos_i) const;
  Rgb normal() const { return (*this)(1); }

 private:
  Rgb covered(float cos_i) const;

  Rgb f0_, base_ior_;
  float weight_, film_ior_, thickness_nm_;
};

}  // namespace tessera::core
