// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/core_image/image_files.hpp"

#include <cstdio>  // jpeglib.h needs it

#include <jpeglib.h>
#include <stb_image_write.h>
#include <tiffio.h>
#include <webp/encode.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <gtest/gtest.h>

#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"
#include "tests/unit/core_image/test_image.hpp"

namespace tessera::core::test {
namespace {

void append(void* to, void* data, int size) {
  static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

template <typename T>
std::vector<std::uint8_t> tiff_samples(const TiffOptions& options, std::uint32_t x0, std::uint32_t y0,
                                       std::uint32_t width, std::uint32_t height, int plane) {
  std::vector<std::uint8_t> bytes;
  const int first = options.planar ? plane : 0, last = options.planar ? plane + 1 : options.samples;
  for (std::uint32_t y = y0; y < y0 + height; ++y)
    for (std::uint32_t x = x0; x < x0 + width; ++x)
      for (int c = first; c < last; ++c) {
        const auto value = static_cast<T>(7 * (y * static_cast<std::uint32_t>(options.width) + x) +
                                          40 * static_cast<std::uint32_t>(c) + 3);
        const auto* raw = reinterpret_cast<const std::uint8_t*>(&value);
        bytes.insert(bytes.end(), raw, raw + sizeof value);
      }
  return bytes;
}

std::vector<std::uint8_t> tiff_samples_of_type(const TiffOptions& options, std::uint32_t x, std::uint32_t y,
                                               std::uint32_t width, std::uint32_t height, int plane) {
  if (options.is_float && options.bits == 32) return tiff_samples<float>(options, x, y, width, height, plane);
  return options.bits == 16 ? tiff_samples<std::uint16_t>(options, x, y, width, height, plane)
                            : tiff_samples<std::uint8_t>(options, x, y, width, height, plane);
}

}  // namespace

std::vector<std::uint8_t> smooth_codes(int width, int height, int channels) {
  std::vector<std::uint8_t> codes;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c)
        codes.push_back(static_cast<std::uint8_t>(30 + (5 * x + 3 * y * (c + 1) + 50 * c) % 200));
  return codes;
}

std::string jpeg_file(const JpegOptions& options) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &data, &size);
  info.image_width = static_cast<unsigned>(options.width);
  info.image_height = static_cast<unsigned>(options.height);
  info.input_components = options.cmyk ? 4 : 3;
  info.in_color_space = options.cmyk ? JCS_CMYK : JCS_RGB;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, 95, TRUE);
  if (options.cmyk) info.write_Adobe_marker = options.adobe_marker ? TRUE : FALSE;
  info.arith_code = options.arithmetic ? TRUE : FALSE;
  info.restart_in_rows = options.restart_rows;
  if (options.progressive) jpeg_simple_progression(&info);
  jpeg_start_compress(&info, TRUE);
  std::vector<std::uint8_t> codes = smooth_codes(options.width, options.height, info.input_components);
  while (info.next_scanline < info.image_height) {
    JSAMPROW row = codes.data() + std::size_t{info.next_scanline} * info.image_width *
                                      static_cast<std::size_t>(info.input_components);
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  std::string file(reinterpret_cast<char*>(data), size);
  std::free(data);
  return file;
}

std::string tiff_file(const TiffOptions& options) {
  const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
  std::string path = testing::TempDir() + test.test_suite_name() + "." + test.name() + ".tif";
  std::replace(path.begin() + static_cast<std::ptrdiff_t>(testing::TempDir().size()), path.end(), '/', '_');
  TIFF* tiff = TIFFOpen(path.c_str(), "w");
  const auto width = static_cast<std::uint32_t>(options.width),
             height = static_cast<std::uint32_t>(options.height);
  constexpr std::uint32_t kTileSide = 16;
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, options.samples);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, options.bits);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, options.is_float ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, options.photometric);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, options.compression);
  TIFFSetField(tiff, TIFFTAG_ORIENTATION, options.orientation);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, options.planar ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
  const int colors = options.photometric == PHOTOMETRIC_RGB ? 3 : 1;
  if (options.samples > colors) {
    const std::vector<std::uint16_t> extras(static_cast<std::size_t>(options.samples - colors),
                                            EXTRASAMPLE_UNASSALPHA);
    TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, static_cast<int>(extras.size()), extras.data());
  }
  if (options.tiled) {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, kTileSide);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, kTileSide);
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 3);
  }
  for (int plane = 0; plane < (options.planar ? options.samples : 1); ++plane) {
    if (!options.tiled)
      for (std::uint32_t y = 0; y < height; y += 3) {
        auto bytes = tiff_samples_of_type(options, 0, y, width, std::min(3u, height - y), plane);
        TIFFWriteEncodedStrip(tiff, TIFFComputeStrip(tiff, y, static_cast<std::uint16_t>(plane)),
                              bytes.data(), static_cast<tmsize_t>(bytes.size()));
      }
    else
      for (std::uint32_t y = 0; y < height; y += kTileSide)
        for (std::uint32_t x = 0; x < width; x += kTileSide) {
          auto bytes = tiff_samples_of_type(options, x, y, kTileSide, kTileSide, plane);
          TIFFWriteEncodedTile(tiff, TIFFComputeTile(tiff, x, y, 0, static_cast<std::uint16_t>(plane)),
                               bytes.data(), static_cast<tmsize_t>(bytes.size()));
        }
  }
  TIFFClose(tiff);
  std::string bytes = read_file(path).value();
  std::filesystem::remove(path);
  return bytes;
}

std::string webp_file(int width, int height, const std::vector<std::uint8_t>& rgba) {
  std::uint8_t* data = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(rgba.data(), width, height, 4 * width, &data);
  std::string file(reinterpret_cast<char*>(data), size);
  WebPFree(data);
  return file;
}

std::string tga_file(int width, int height, const std::vector<std::uint8_t>& rgb) {
  std::string bytes;
  stbi_write_tga_to_func(append, &bytes, width, height, 3, rgb.data());
  return bytes;
}

std::string bmp_file(int width, int height, const std::vector<std::uint8_t>& rgb) {
  std::string bytes;
  stbi_write_bmp_to_func(append, &bytes, width, height, 3, rgb.data());
  return bytes;
}

std::vector<std::pair<std::string, std::string>> files_of_all_formats() {
  std::vector<std::pair<std::string, std::string>> files;
  for (const ImageFormat format :
       {ImageFormat::kPng, ImageFormat::kExr, ImageFormat::kHdr, ImageFormat::kPfm})
    files.emplace_back(image_format_name(format), encode_image(random_image(24, 18, 7), format).value());
  const std::vector<std::uint8_t> rgb = smooth_codes(24, 18, 3);
  files.emplace_back("jpeg", jpeg_file());
  files.emplace_back("progressive_jpeg", jpeg_file({.progressive = true}));
  files.emplace_back("tiff", tiff_file({.width = 24, .height = 18}));
  files.emplace_back("webp", webp_file(24, 18, smooth_codes(24, 18, 4)));
  files.emplace_back("tga", tga_file(24, 18, rgb));
  files.emplace_back("bmp", bmp_file(24, 18, rgb));
  return files;
}

}  // namespace tessera::core::test
