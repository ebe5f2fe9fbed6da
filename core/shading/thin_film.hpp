// SPDX-License-Identifier: Apache-2.0
// What a thin film changes in the reflectance of a surface, which its interference colours (Belcour and Barla
// 2017). T is float for one point, or FloatN for one in each lane.
#pragma once

#include "core/math/rgb.hpp"
#include "core/math/simd_double.hpp"

namespace tessera::core::shading {

template <typename T>
class ThinFilmOf {
 public:
  ThinFilmOf() = default;  // no film
  // `f0` is the reflectance of the bare surface at normal incidence. The film covers the share `weight` of
  // it; its thickness is in micrometres.
  ThinFilmOf(RgbOf<T> f0, T weight, T film_ior, T thickness);

  // The reflectance less that of the bare surface, both as of dielectrics of the index that reflects f0. It
  // is zero for a film of no thickness, of air, or of the surface's own index.
  RgbOf<T> change(T cos_i) const;

 private:
  RgbOf<T> base_ior_ = RgbOf<T>::gray(1);
  T weight_ = 0.0f, film_ior_ = 1.0f, thickness_nm_ = 0.0f;
};
using ThinFilm = ThinFilmOf<float>;
extern template class ThinFilmOf<float>;
extern template class ThinFilmOf<FloatN>;

}  // namespace tessera::core::shading
