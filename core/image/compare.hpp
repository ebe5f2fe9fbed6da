// SPDX-License-Identifier: Apache-2.0
// How much two pictures differ, in linear light. Stateless; thread-safe.
#pragma once

#include "core/base/error.hpp"
#include "core/image/image.hpp"

namespace tessera::core {

// Sums are taken in double precision, row by row. A value that is not a number differs infinitely from
// everything else, and not at all from one with the same bits.
struct Comparison {
  bool identical = true;             // every float has the same bits (so 0 and -0 differ, by 0)
  double largest_difference = 0;     // absolute, over all channels
  int largest_x = 0, largest_y = 0;  // where; the first such pixel in reading order
  double mse = 0;                    // mean over pixels and channels of (a - b)^2
  double relative_mse = 0;           // mean over pixels and channels of (a - b)^2 / (b^2 + 0.01)
  double psnr_db =
      0;  // 10 log10(1 / mse): the peak is 1 by convention, whatever the pictures hold; infinite for mse 0
  double reference_mean_square =
      0;  // mean over pixels and channels of b^2: what mse is small or large beside
};

// `b` is the reference. Errors: the sizes differ.
Result<Comparison> compare(const Image& a, const Image& b);

// The same of one part of both; `b` may also be a picture of nothing else than that part. Places are those in
// the whole pictures. Errors also: the part is empty, or not wholly within them.
Result<Comparison> compare(const Image& a, const Image& b, ImageRegion region);

}  // namespace tessera::core
