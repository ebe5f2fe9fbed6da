// SPDX-License-Identifier: Apache-2.0
#include "core/image/compare.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tessera::core {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

double absolute_difference(float a, float b) {
  if (same_bits(a, b)) return 0;
  const double difference = std::fabs(static_cast<double>(a) - static_cast<double>(b));
  return std::isnan(difference) ? kInfinity : difference;
}

double relative_square(double difference, double reference) {
  const double ratio = difference * difference / (reference * reference + 0.01);
  return std::isnan(ratio) ? kInfinity : ratio;
}

// Adds the three channels of one pixel to the sums, which are divided into means later.
void add_pixel(Comparison& sums, Rgb a, Rgb b, int x, int y) {
  for (int channel = 0; channel < 3; ++channel) {
    sums.reference_mean_square += static_cast<double>(b[channel]) * static_cast<double>(b[channel]);
    if (!same_bits(a[channel], b[channel])) sums.identical = false;
    const double difference = absolute_difference(a[channel], b[channel]);
    if (difference == 0) continue;
    sums.mse += difference * difference;
    sums.relative_mse += relative_square(difference, b[channel]);
    if (difference > sums.largest_difference) {
      sums.largest_difference = difference;
      sums.largest_x = x;
      sums.largest_y = y;
    }
  }
}

Status check_region(const Image& image, ImageRegion region) {
  const bool within = region.width > 0 && region.height > 0 && region.x >= 0 && region.y >= 0 &&
                      region.width <= image.width - region.x && region.height <= image.height - region.y;
  if (within) return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("the region of {}x{} pixels from ({}, {}) does not lie within the images of {}x{}",
                          region.width, region.height, region.x, region.y, image.width, image.height));
}

Status check_sizes(const Image& a, const Image& b) {
  if (a.width == b.width && a.height == b.height) return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("the images have different sizes: {}x{} and {}x{} pixels", a.width, a.height,
                          b.width, b.height));
}

}  // namespace

Result<Comparison> compare(const Image& a, const Image& b) {
  if (Status status = check_sizes(a, b); !status) return fail(status.error());
  return compare(a, b, {0, 0, b.width, b.height});
}

Result<Comparison> compare(const Image& a, const Image& b, ImageRegion region) {
  const bool b_is_the_part = b.width == region.width && b.height == region.height;
  const int b_x = b_is_the_part ? region.x : 0, b_y = b_is_the_part ? region.y : 0;
  if (Status status = check_sizes(a, b); !status && !b_is_the_part) return fail(status.error());
  if (Status status = check_region(a, region); !status) return fail(status.error());
  Comparison result;
  for (int y = region.y; y < region.y + region.height; ++y) {
    for (int x = region.x; x < region.x + region.width; ++x)
      add_pixel(result, a.at(x, y), b.at(x - b_x, y - b_y), x, y);
  }
  const double values = 3.0 * region.width * region.height;
  result.mse /= values;
  result.relative_mse /= values;
  result.reference_mean_square /= values;
  result.psnr_db = result.mse == 0 ? kInfinity : -10 * std::log10(result.mse);
  return result;
}

}  // namespace tessera::core
