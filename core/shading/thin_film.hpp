// SPDX-License-Identifier: Apache-2.0
// The reflectance of a surface under a thin film, whose interference colours it (Belcour and Barla 2017). T
// is float for one point, or FloatN for one in each lane.
#pragma once

#include "core/math/rgb.hpp"
#include "core/math/simd_double.hpp"

namespace tessera::core::shading {

template <typename T>
class FilmReflectanceOf {
 public:
  FilmReflectanceOf() = default;  // black
  // `f0` is the reflectance of the bare surface at normal incidence. The film covers the share `weight` of
  // it; its thickness is in micrometres.
  FilmReflectanceOf(RgbOf<T> f0, T weight, T film_ior, T thickness);

  RgbOf<T> operator()(T cos_i) const;
  RgbOf<T> normal() const { return (*this)(T(1.0f)); }

 private:
  RgbOf<T> covered(T cos_i) const;

  RgbOf<T> f0_, base_ior_;
  T weight_ = 0.0f, film_ior_ = 1.0f, thickness_nm_ = 0.0f;
};
using FilmReflectance = FilmReflectanceOf<float>;
extern template class FilmReflectanceOf<float>;
extern template class FilmReflectanceOf<FloatN>;

}  // namespace tessera::core::shading
