// SPDX-License-Identifier: Apache-2.0
// Measures the difference of two images in linear light. Stateless; thread-safe.
#pragma once

#include "core/base/error.hpp"
#include "core/image/image.hpp"

namespace tessera::core {

// Sums are taken in double precision, row by row. A NaN has infinite difference from every other value, and
// none from a NaN with the same bits.
struct Comparison {
  bool identical = true;             // every float has the same bits (so 0 and -0 differ, by 0)
  double largest_difference = 0;     // absolute, over all channels
  int largest_x = 0, largest_y = 0;  // where it is; the first such pixel in reading order
  double mse = 0;                    // mean over pixels and channels of (a - b)^2
  double relative_mse = 0;           // mean over pixels and channels of (a - b)^2 / (b^2 + 0.01)
  double psnr_db = 0;                // 10 log10(1 / mse): the peak is 1 by convention; infinite for mse 0
  double reference_mean_square = 0;  // mean over pixels and channels of b^2: the scale of mse
};

// `b` is the reference. Errors: the sizes differ.
Result<Comparison> compare(const Image& a, const Image& b);

// Compares one region of both images; `b` may also be an image of just that region. Coordinates are those
// of the whole images. Further errors: the region is empty, or not inside both images.
Result<Comparison> compare(const Image& a, const Image& b, ImageRegion region);

}  // namespace tessera::core
