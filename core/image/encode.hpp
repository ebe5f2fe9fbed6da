// SPDX-License-Identifier: Apache-2.0
// Encodes images: PNG for screens, and three formats that keep linear light. The bytes depend on the image
// only (no dates, no names) and are the same on every machine with the same zlib. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/image/display.hpp"
#include "core/image/image.hpp"

namespace tessera::core {

enum class ImageFormat {
  kPng,  // 8 bits, tone mapped (display.hpp), sRGB transfer function, clamped to [0, 1]
  kExr,  // OpenEXR, 32-bit floats, ZIP compression: loses nothing
  kHdr,  // Radiance RGBE: 8 bits of mantissa
  kPfm,  // portable float map, little-endian: loses nothing
};

// "png", "exr", "hdr" or "pfm", which are also the file extensions.
std::string_view image_format_name(ImageFormat format);

// Selects the format by file extension, case-insensitively. The error lists the known extensions.
Result<ImageFormat> image_format_from_path(std::string_view path);

// Checks that an image of this size fits the format. Call it before rendering.
Status check_encodable(ImageFormat format, int width, int height);

// Where an image lies in a larger one. Only OpenEXR files say so; others are images of their own.
struct ImagePosition {
  int x0 = 0, y0 = 0, image_width = 0, image_height = 0;
};

// The bytes of the file. `display` applies to PNG; the other formats store linear light. Fails only for
// sizes that check_encodable rejects, or if memory runs out.
Result<std::string> encode_image(const Image& image, ImageFormat format, const DisplaySettings& display = {},
                                 const std::optional<ImagePosition>& position = {},
                                 const std::vector<std::pair<std::string, std::string>>& attributes = {});

// An image that is read row by row, such as one that does not fit into memory.
struct RowSource {
  int width = 0, height = 0;
  // Returns row y, from 0 at the top: `width` pixels that stay valid until the next call. Called once for
  // each row, from the top down, and for PFM from the bottom up.
  std::function<Result<const Rgb*>(int y)> row;
  using Position = ImagePosition;
  std::optional<Position> position{};
  // Texts for the header of OpenEXR files.
  std::vector<std::pair<std::string, std::string>> attributes{};
};

// An image of any channels, the first of which are R, G and B.
struct ChannelRows {
  int width = 0, height = 0;
  std::vector<std::string> channels;  // their names, such as "Normal.X"
  // As RowSource::row(): the channels of each pixel side by side.
  std::function<Result<const float*>(int y)> row;
  std::optional<ImagePosition> position{};
  // Texts for the header of OpenEXR files.
  std::vector<std::pair<std::string, std::string>> attributes{};
};

// A file that is being written.
class ByteSink {
 public:
  virtual ~ByteSink() = default;
  // Most of the bytes are appended; only OpenEXR replaces some that were written before.
  virtual Status write_at(std::uint64_t offset, std::string_view bytes) = 0;
};

// Writes the file that encode_image() would make of these pixels. Needs memory for some rows. Returns the
// size of the file. Errors are those of the source, of the sink and of encode_image().
Result<std::uint64_t> write_image(const RowSource& source, ImageFormat format, const DisplaySettings& display,
                                  ByteSink& sink);

// Writes an image of any channels. OpenEXR files hold them all, as 32-bit floats. Of A and the colours,
// which it multiplies, PNG makes colours that alpha does not multiply, as the format asks; other channels are
// left out. HDR and PFM take R, G and B alone.
Result<std::uint64_t> write_channels(const ChannelRows& source, ImageFormat format,
                                     const DisplaySettings& display, ByteSink& sink);
// The same as the bytes of the file.
Result<std::string> encode_channels(const ChannelRows& source, ImageFormat format,
                                    const DisplaySettings& display);

// A bound on the memory that write_image() takes for an image of this width, besides source and sink.
std::uint64_t encoding_bytes(std::uint64_t width);

}  // namespace tessera::core
