// SPDX-License-Identifier: Apache-2.0
// Image files as other programs write them, for the tests of decoders.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/image/image.hpp"

namespace tessera::core::test {

// `width` times `height` pixels of `channels` codes, that change smoothly from pixel to pixel.
std::vector<std::uint8_t> smooth_codes(int width, int height, int channels);

struct JpegOptions {
  int width = 40, height = 24;
  bool progressive = false, cmyk = false, adobe_marker = true, arithmetic = false;
  int restart_rows = 0;  // a restart marker after so many rows of blocks
};
// Of smooth_codes(); CMYK codes are stored as they are.
std::string jpeg_file(const JpegOptions& options = {});

struct TiffOptions {
  int width = 5, height = 4, samples = 3, bits = 8;
  bool is_float = false, tiled = false, planar = false;
  int compression = 5, photometric = 2, orientation = 1;  // LZW, RGB, from the top left
};
// Sample c of pixel i is 7 * i + 40 * c + 3, in the file's type; of floats of 16 bits, these are their bits.
std::string tiff_file(const TiffOptions& options = {});

std::string webp_file(int width, int height, const std::vector<std::uint8_t>& rgba);

// TGA and BMP of RGB codes.
std::string tga_file(int width, int height, const std::vector<std::uint8_t>& rgb);
std::string bmp_file(int width, int height, const std::vector<std::uint8_t>& rgb);

// One small file of every format, with its name.
std::vector<std::pair<std::string, std::string>> files_of_all_formats();

}  // namespace tessera::core::test
