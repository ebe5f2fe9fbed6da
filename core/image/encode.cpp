// SPDX-License-Identifier: Apache-2.0
#include "core/image/encode.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <new>
#include <utility>

#include "core/image/exr.hpp"
#include "core/image/hdr_encoder.hpp"
#include "core/image/limits.hpp"
#include "core/image/png_encoder.hpp"

namespace tessera::core {
namespace {

static_assert(sizeof(Rgb) == 3 * sizeof(float), "images are passed on as arrays of floats");

// Appends to a sink, and keeps the first error.
class Appender {
 public:
  explicit Appender(ByteSink& sink) : sink_(sink) {}

  Status append(std::string_view bytes) {
    if (!status_) return status_;
    status_ = sink_.write_at(size_, bytes);
    size_ += bytes.size();
    return status_;
  }
  std::uint64_t size() const { return size_; }

 private:
  ByteSink& sink_;
  std::uint64_t size_ = 0;
  Status status_;
};

class StringSink final : public ByteSink {
 public:
  Status write_at(std::uint64_t offset, std::string_view bytes) override {
    if (offset + bytes.size() > bytes_.size()) bytes_.resize(offset + bytes.size());
    bytes_.replace(offset, bytes.size(), bytes);
    return {};
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// Rows run from the bottom up; a negative scale marks little-endian numbers (Debevec's PFM).
Status write_pfm(const RowSource& source, Appender& file) {
  static_assert(std::endian::native == std::endian::little);
  if (auto begun = file.append(fmt::format("PF\n{} {}\n-1.0\n", source.width, source.height)); !begun)
    return begun;
  for (int y = source.height - 1; y >= 0; --y) {
    const auto row = source.row(y);
    if (!row) return fail(row.error());
    const std::string_view bytes(reinterpret_cast<const char*>(*row),
                                 static_cast<std::size_t>(source.width) * sizeof(Rgb));
    if (auto written = file.append(bytes); !written) return written;
  }
  return {};
}

Status write_hdr(const RowSource& source, Appender& file) {
  if (auto begun = file.append(hdr_file_header(source.width, source.height)); !begun) return begun;
  std::string bytes;
  for (int y = 0; y < source.height; ++y) {
    const auto row = source.row(y);
    if (!row) return fail(row.error());
    bytes.clear();
    append_hdr_row({*row, static_cast<std::size_t>(source.width)}, bytes);
    if (auto written = file.append(bytes); !written) return written;
  }
  return {};
}

Result<std::uint64_t> write_checked(const RowSource& source, ImageFormat format,
                                    const DisplaySettings& display, ByteSink& sink) {
  if (format == ImageFormat::kExr) return write_exr(source, sink);
  if (format == ImageFormat::kPng) return write_png(source, display, sink);
  Appender file(sink);
  const Status written = format == ImageFormat::kHdr ? write_hdr(source, file) : write_pfm(source, file);
  if (!written) return fail(written.error());
  return file.size();
}

}  // namespace

std::string_view image_format_name(ImageFormat format) {
  switch (format) {
    case ImageFormat::kPng:
      return "png";
    case ImageFormat::kExr:
      return "exr";
    case ImageFormat::kHdr:
      return "hdr";
    case ImageFormat::kPfm:
      return "pfm";
  }
  return "";
}

Result<ImageFormat> image_format_from_path(std::string_view path) {
  const std::string_view name = path.substr(path.find_last_of('/') + 1);
  const std::size_t dot = name.find_last_of('.');
  std::string ending(dot == std::string_view::npos ? "" : name.substr(dot + 1));
  for (char& c : ending) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  for (const ImageFormat format :
       {ImageFormat::kPng, ImageFormat::kExr, ImageFormat::kHdr, ImageFormat::kPfm}) {
    if (ending == image_format_name(format)) return format;
  }
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("'{}': the extension of an image file selects its format: .png, .exr, .hdr or .pfm", path));
}

Status check_encodable(ImageFormat format, int width, int height) {
  if (width < 1 || height < 1) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("an image of {}x{} pixels is empty", width, height));
  }
  const std::int64_t limit = format == ImageFormat::kHdr ? kMaxHdrPixels : kMaxImagePixels;
  if (static_cast<std::int64_t>(width) * height > limit) {
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("an image of {}x{} pixels is too large for .{} files, which hold at most {} million "
                    "pixels: use .exr",
                    width, height, image_format_name(format), limit / 1'000'000));
  }
  return {};
}

Result<std::uint64_t> write_image(const RowSource& source, ImageFormat format, const DisplaySettings& display,
                                  ByteSink& sink) {
  if (Status status = check_encodable(format, source.width, source.height); !status)
    return fail(status.error());
  try {
    return write_checked(source, format, display, sink);
  } catch (const std::bad_alloc&) {
    return fail(
        ErrorCode::kResourceExhausted,
        fmt::format("not enough memory to write an image of {}x{} pixels", source.width, source.height));
  }
}

std::uint64_t encoding_bytes(std::uint64_t width) {
  constexpr std::uint64_t kRows = 64, kTables = std::uint64_t{1} << 20;
  return kTables + width * kRows * sizeof(Rgb);
}

Result<std::string> encode_image(const Image& image, ImageFormat format, const DisplaySettings& display,
                                 const std::optional<ImagePosition>& position,
                                 const std::vector<std::pair<std::string, std::string>>& attributes) {
  StringSink sink;
  const RowSource source{image.width, image.height,
                         [&](int y) -> Result<const Rgb*> { return &image.at(0, y); }, position, attributes};
  const auto size = write_image(source, format, display, sink);
  if (!size) return fail(size.error());
  return sink.take();
}

Result<std::uint64_t> write_channels(const ChannelRows& source, ImageFormat format,
                                     const DisplaySettings& display, ByteSink& sink) {
  if (Status status = check_encodable(format, source.width, source.height); !status)
    return fail(status.error());
  const bool has_alpha = source.channels.size() > 3 && source.channels[3] == "A";
  std::vector<Rgb> colors;
  const RowSource beauty{source.width, source.height, [&](int y) -> Result<const Rgb*> {
                           const auto row = source.row(y);
                           if (!row) return fail(row.error());
                           colors.clear();
                           for (std::size_t x = 0; x < static_cast<std::size_t>(source.width); ++x) {
                             const float* const pixel = *row + x * source.channels.size();
                             colors.push_back({pixel[0], pixel[1], pixel[2]});
                           }
                           return colors.data();
                         }};
  try {
    if (format == ImageFormat::kExr) return write_exr(source, sink);
    if (format == ImageFormat::kPng && has_alpha) return write_png_with_alpha(source, display, sink);
    return write_checked(beauty, format, display, sink);
  } catch (const std::bad_alloc&) {
    return fail(
        ErrorCode::kResourceExhausted,
        fmt::format("not enough memory to write an image of {}x{} pixels", source.width, source.height));
  }
}

Result<std::string> encode_channels(const ChannelRows& source, ImageFormat format,
                                    const DisplaySettings& display) {
  StringSink sink;
  const auto size = write_channels(source, format, display, sink);
  if (!size) return fail(size.error());
  return sink.take();
}

}  // namespace tessera::core
