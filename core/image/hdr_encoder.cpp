// SPDX-License-Identifier: Apache-2.0
#include "core/image/hdr_encoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace tessera::core {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

constexpr int kBias = 128, kMaxExponent = 255 - kBias;
constexpr std::size_t kMinPackedPixels = 8, kMaxPackedPixels = 32767;

float storable(float value) {
  const float largest = std::ldexp(255.0f, kMaxExponent - 8);
  return value > 0 ? std::min(value, largest) : 0;
}

// The mantissa of `value` for the shared `exponent`, rounded to nearest.
int mantissa(float value, int exponent) {
  return static_cast<int>(std::floor(std::ldexp(static_cast<double>(value), 8 - exponent) + 0.5));
}

// The number of equal bytes from `begin` on, at most 127.
std::size_t run_length(const std::vector<std::uint8_t>& bytes, std::size_t begin) {
  std::size_t end = begin + 1;
  while (end < bytes.size() && end - begin < 127 && bytes[end] == bytes[begin]) ++end;
  return end - begin;
}

// Runs of at least 3 are encoded in two bytes; everything else is stored literally.
void append_packed(const std::vector<std::uint8_t>& bytes, std::string& file) {
  constexpr std::size_t kMinRun = 3, kMaxLiterals = 128;
  for (std::size_t i = 0; i < bytes.size();) {
    if (const std::size_t run = run_length(bytes, i); run >= kMinRun) {
      file.push_back(static_cast<char>(128 + run));
      file.push_back(static_cast<char>(bytes[i]));
      i += run;
      continue;
    }
    std::size_t end = i;
    while (end < bytes.size() && end - i < kMaxLiterals && run_length(bytes, end) < kMinRun) ++end;
    file.push_back(static_cast<char>(end - i));
    for (; i < end; ++i) file.push_back(static_cast<char>(bytes[i]));
  }
}

void append_packed_row(const std::vector<Rgbe>& row, std::string& file) {
  for (const std::size_t byte : {std::size_t{2}, std::size_t{2}, row.size() / 256, row.size() % 256})
    file.push_back(static_cast<char>(byte));
  std::vector<std::uint8_t> channel_bytes(row.size());
  for (std::size_t channel = 0; channel < 4; ++channel) {
    std::ranges::transform(row, channel_bytes.begin(), [&](const Rgbe& pixel) { return pixel[channel]; });
    append_packed(channel_bytes, file);
  }
}

void append_flat_row(const std::vector<Rgbe>& row, std::string& file) {
  for (const Rgbe& pixel : row)
    for (const std::uint8_t byte : pixel) file.push_back(static_cast<char>(byte));
}

}  // namespace

Rgbe encode_rgbe(Rgb color) {
  const Rgb stored{storable(color.r), storable(color.g), storable(color.b)};
  const float largest = max_component(stored);
  int exponent = 0;
  std::frexp(largest, &exponent);
  if (mantissa(largest, exponent) == 256) ++exponent;  // rounded up to the next power of two
  if (largest == 0 || exponent <= -kBias) return {};
  const auto code = [&](float value) { return static_cast<std::uint8_t>(mantissa(value, exponent)); };
  return {code(stored.r), code(stored.g), code(stored.b), static_cast<std::uint8_t>(exponent + kBias)};
}

std::string hdr_file_header(int width, int height) {
  return fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", height, width);
}

void append_hdr_row(std::span<const Rgb> pixels, std::string& file) {
  std::vector<Rgbe> row(pixels.size());
  std::ranges::transform(pixels, row.begin(), encode_rgbe);
  const bool packed = pixels.size() >= kMinPackedPixels && pixels.size() <= kMaxPackedPixels;
  packed ? append_packed_row(row, file) : append_flat_row(row, file);
}

}  // namespace tessera::core
