// SPDX-License-Identifier: Apache-2.0
// TIFF by libtiff: the first image of a file. Gray and RGB of 8 or 16 bits or floats keep their precision;
// palettes, bilevel, YCbCr, CMYK and others are converted to 8 bits.
#include <half.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <type_traits>

#include "core/image/codec.hpp"
#include "core/image/limits.hpp"

namespace tessera::core {
namespace tiff {
namespace {

// Only these compressions are allowed, so that untrusted bytes reach fewer decoders.
constexpr std::array<std::uint16_t, 9> kCompressions{
    COMPRESSION_NONE,     COMPRESSION_LZW,       COMPRESSION_ADOBE_DEFLATE,
    COMPRESSION_DEFLATE,  COMPRESSION_PACKBITS,  COMPRESSION_JPEG,
    COMPRESSION_CCITTRLE, COMPRESSION_CCITTFAX3, COMPRESSION_CCITTFAX4};
constexpr unsigned kMaxSamples = 64;

// An in-memory file for libtiff, and libtiff's messages about it.
class TiffFile {
 public:
  explicit TiffFile(std::string_view bytes) : bytes_(bytes) {
    const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(),
                                                                                   TIFFOpenOptionsFree);
    if (!options) throw std::bad_alloc();
    TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), kMaxAllocation);
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), note_error, this);
    TIFFOpenOptionsSetWarningHandlerExtR(
        options.get(), [](TIFF*, void*, const char*, const char*, va_list) { return 1; }, nullptr);
    // "m" disables memory mapping.
    tiff_ = TIFFClientOpenExt("image", "rm", this, read, write, seek, close, size, nullptr, nullptr,
                              options.get());
  }
  ~TiffFile() {
    if (tiff_ != nullptr) TIFFClose(tiff_);
  }
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;

  TIFF* tiff() const { return tiff_; }
  tl::unexpected<Error> failure() const {
    const std::string reason = printable_reason(error_.data());
    return broken_image("TIFF", reason.empty() ? "libtiff cannot read it" : reason);
  }
  // The value of a tag, or its default.
  unsigned number(std::uint32_t tag) const {
    std::uint16_t value = 0;
    TIFFGetFieldDefaulted(tiff_, tag, &value);
    return value;
  }

 private:
  static constexpr tmsize_t kMaxAllocation = tmsize_t{1} << 32;

  static TiffFile& self(thandle_t handle) { return *static_cast<TiffFile*>(handle); }
  static tmsize_t read(thandle_t handle, void* to, tmsize_t count) {
    TiffFile& file = self(handle);
    if (count < 0 || file.position_ > file.bytes_.size()) return 0;
    const auto taken = std::min(static_cast<std::size_t>(count), file.bytes_.size() - file.position_);
    if (taken > 0) std::memcpy(to, file.bytes_.data() + file.position_, taken);
    file.position_ += taken;
    return static_cast<tmsize_t>(taken);
  }
  static tmsize_t write(thandle_t, void*, tmsize_t) { return 0; }
  static toff_t seek(thandle_t handle, toff_t offset, int whence) {
    TiffFile& file = self(handle);
    const std::size_t base = whence == SEEK_SET   ? 0
                             : whence == SEEK_CUR ? file.position_
                                                  : file.bytes_.size();
    file.position_ = base + offset;
    return file.position_;
  }
  static int close(thandle_t) { return 0; }
  static toff_t size(thandle_t handle) { return self(handle).bytes_.size(); }
  // Keeps the first message: later ones are consequences.
  static int note_error(TIFF*, void* file, const char*, const char* format, va_list arguments) {
    auto& text = static_cast<TiffFile*>(file)->error_;
    if (text[0] == '\0') std::vsnprintf(text.data(), text.size(), format, arguments);
    return 1;
  }

  std::string_view bytes_;
  std::size_t position_ = 0;
  std::array<char, 256> error_{};
  TIFF* tiff_ = nullptr;
};

struct Layout {
  ImageSize size;
  unsigned bits = 0, samples = 0, sample_format = 0, photometric = 0, orientation = 0;
  bool is_planar = false, has_alpha = false;

  bool is_rgb() const { return photometric == PHOTOMETRIC_RGB; }
  unsigned colors() const { return is_rgb() ? 3 : 1; }
};

Layout layout_of(const TiffFile& file, ImageSize size) {
  std::uint16_t extra_count = 0;
  const std::uint16_t* extras = nullptr;
  TIFFGetFieldDefaulted(file.tiff(), TIFFTAG_EXTRASAMPLES, &extra_count, &extras);
  return {.size = size,
          .bits = file.number(TIFFTAG_BITSPERSAMPLE),
          .samples = file.number(TIFFTAG_SAMPLESPERPIXEL),
          .sample_format = file.number(TIFFTAG_SAMPLEFORMAT),
          .photometric = file.number(TIFFTAG_PHOTOMETRIC),
          .orientation = file.number(TIFFTAG_ORIENTATION),
          .is_planar = file.number(TIFFTAG_PLANARCONFIG) == PLANARCONFIG_SEPARATE,
          .has_alpha = extra_count > 0 && extras[0] != EXTRASAMPLE_UNSPECIFIED};
}

// Whether the samples can be used without conversion.
bool is_direct(const Layout& layout) {
  const bool is_number =
      layout.sample_format == SAMPLEFORMAT_UINT || layout.sample_format == SAMPLEFORMAT_VOID;
  const bool is_float = layout.sample_format == SAMPLEFORMAT_IEEEFP;
  const bool is_color = layout.is_rgb() || layout.photometric == PHOTOMETRIC_MINISBLACK ||
                        (layout.photometric == PHOTOMETRIC_MINISWHITE && is_number);
  const unsigned fewest = is_float ? 16 : 8;
  const bool has_type = (is_float || is_number) && (layout.bits == fewest || layout.bits == 2 * fewest);
  return is_color && has_type && layout.samples >= layout.colors();
}

// A strip or a tile.
struct Chunk {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

template <typename T>
class DirectReader {
 public:
  DirectReader(TiffFile& file, const Layout& layout, bool keep_alpha)
      : file_(file),
        layout_(layout),
        channels_(keep_alpha && layout.has_alpha && layout.samples > layout.colors() ? 4 : 3),
        values_(layout.size.pixels() * channels_) {}

  Result<DecodedImage> read() {
    const Chunk first = first_chunk();
    const auto bytes =
        static_cast<std::uint64_t>(is_tiled() ? TIFFTileSize64(tiff()) : TIFFStripSize64(tiff()));
    if (first.width == 0 || first.height == 0 || bytes > max_chunk_bytes())
      return broken_image("TIFF", "its strips or tiles have no plausible size");
    buffer_.resize(bytes);
    const auto width = static_cast<std::uint32_t>(layout_.size.width);
    const auto height = static_cast<std::uint32_t>(layout_.size.height);
    for (std::uint32_t y = 0; y < height; y += first.height)
      for (std::uint32_t x = 0; x < width; x += first.width)
        for (unsigned plane = 0; plane < (layout_.is_planar ? layout_.samples : 1); ++plane)
          if (!read_chunk({x, y, first.width, first.height}, plane)) return file_.failure();
    return DecodedImage{
        .size = layout_.size, .channels = channels_, .values = std::move(values_), .warnings = {}};
  }

 private:
  TIFF* tiff() const { return file_.tiff(); }
  bool is_tiled() const { return TIFFIsTiled(tiff()) != 0; }
  unsigned samples_in_chunk() const { return layout_.is_planar ? 1 : layout_.samples; }

  Chunk first_chunk() const {
    Chunk chunk;
    if (is_tiled()) {
      TIFFGetField(tiff(), TIFFTAG_TILEWIDTH, &chunk.width);
      TIFFGetField(tiff(), TIFFTAG_TILELENGTH, &chunk.height);
    } else {
      chunk.width = static_cast<std::uint32_t>(layout_.size.width);
      TIFFGetFieldDefaulted(tiff(), TIFFTAG_ROWSPERSTRIP, &chunk.height);
      chunk.height = std::min(chunk.height, static_cast<std::uint32_t>(layout_.size.height));
    }
    return chunk;
  }

  std::uint64_t max_chunk_bytes() const {
    constexpr std::uint64_t kAlwaysAllowed = std::uint64_t{1} << 26;
    return kAlwaysAllowed + 4 * layout_.size.pixels() * samples_in_chunk() * sizeof(T);
  }

  bool read_chunk(Chunk chunk, unsigned plane) {
    const auto size = static_cast<tmsize_t>(buffer_.size());
    const auto sample = static_cast<std::uint16_t>(plane);
    const tmsize_t got =
        is_tiled()
            ? TIFFReadEncodedTile(tiff(), TIFFComputeTile(tiff(), chunk.x, chunk.y, 0, sample),
                                  buffer_.data(), size)
            : TIFFReadEncodedStrip(tiff(), TIFFComputeStrip(tiff(), chunk.y, sample), buffer_.data(), size);
    const std::uint32_t rows =
        std::min(chunk.height, static_cast<std::uint32_t>(layout_.size.height) - chunk.y);
    const std::size_t row_bytes = std::size_t{chunk.width} * samples_in_chunk() * sizeof(T);
    if (got < 0 || static_cast<std::size_t>(got) < row_bytes * rows) return false;
    for (std::uint32_t row = 0; row < rows; ++row) copy_row(chunk, row, row_bytes, plane);
    return true;
  }

  void copy_row(Chunk chunk, std::uint32_t row, std::size_t row_bytes, unsigned plane) {
    const std::uint32_t columns =
        std::min(chunk.width, static_cast<std::uint32_t>(layout_.size.width) - chunk.x);
    for (std::uint32_t column = 0; column < columns; ++column) {
      T* to = pixel(chunk.x + column, chunk.y + row);
      for (unsigned i = 0; i < samples_in_chunk(); ++i) {
        T value;
        std::memcpy(
            &value,
            buffer_.data() + row * row_bytes + (std::size_t{column} * samples_in_chunk() + i) * sizeof(T),
            sizeof(T));
        store(to, plane + i, value);
      }
    }
  }

  void store(T* to, unsigned sample, T value) const {
    if constexpr (!std::is_same_v<T, float>)
      if (layout_.photometric == PHOTOMETRIC_MINISWHITE && sample == 0)
        value = static_cast<T>(std::numeric_limits<T>::max() - value);
    if (sample < layout_.colors())
      layout_.is_rgb() ? void(to[sample] = value) : void(to[0] = to[1] = to[2] = value);
    else if (sample == layout_.colors() && channels_ == 4)
      to[3] = value;
  }

  T* pixel(std::uint32_t x, std::uint32_t y) {
    const auto width = static_cast<std::uint32_t>(layout_.size.width);
    const auto height = static_cast<std::uint32_t>(layout_.size.height);
    const unsigned o = layout_.orientation;
    if (o == ORIENTATION_TOPRIGHT || o == ORIENTATION_BOTRIGHT) x = width - 1 - x;
    if (o == ORIENTATION_BOTLEFT || o == ORIENTATION_BOTRIGHT) y = height - 1 - y;
    return values_.data() + channels_ * (std::size_t{y} * width + x);
  }

  TiffFile& file_;
  const Layout& layout_;
  std::size_t channels_;
  std::vector<T> values_;
  std::vector<std::uint8_t> buffer_;
};

// Floats of 16 bits.
Result<DecodedImage> read_halves(TiffFile& file, const Layout& layout, bool keep_alpha) {
  auto image = DirectReader<std::uint16_t>(file, layout, keep_alpha).read();
  if (!image) return image;
  const auto& words = std::get<DecodedImage::Words>(image->values);
  DecodedImage::Floats values(words.size());
  std::transform(words.begin(), words.end(), values.begin(), imath_half_to_float);
  image->values = std::move(values);
  return image;
}

// Uses libtiff's own conversion, which premultiplies colours by alpha.
Result<DecodedImage> decode_converted(TiffFile& file, ImageSize size, const DecodeOptions& options) {
  std::array<char, 1024> reason{};
  if (TIFFRGBAImageOK(file.tiff(), reason.data()) == 0)
    return unsupported_image(
        fmt::format("a TIFF image of an unusual kind ({})", printable_reason(reason.data())),
        "save it as RGB of 8 or 16 bits or of 32-bit floats, or as PNG");
  std::vector<std::uint32_t> raster(size.pixels());
  if (TIFFReadRGBAImageOriented(file.tiff(), static_cast<std::uint32_t>(size.width),
                                static_cast<std::uint32_t>(size.height), raster.data(), ORIENTATION_TOPLEFT,
                                1) == 0)
    return file.failure();
  const std::size_t channels = options.keep_alpha ? 4 : 3;
  DecodedImage::Bytes values;
  values.reserve(size.pixels() * channels);
  for (const std::uint32_t pixel : raster)
    for (std::size_t c = 0; c < channels; ++c) values.push_back(static_cast<std::uint8_t>(pixel >> (8 * c)));
  return DecodedImage{.size = size, .channels = channels, .values = std::move(values), .warnings = {}};
}

bool matches(std::string_view bytes) {
  constexpr std::array<std::string_view, 4> kSignatures{
      std::string_view("II*\0", 4), std::string_view("MM\0*", 4), std::string_view("II+\0", 4),
      std::string_view("MM\0+", 4)};
  return std::ranges::any_of(kSignatures, [&](std::string_view s) { return bytes.starts_with(s); });
}

Result<ImageSize> size_of(const TiffFile& file) {
  if (file.tiff() == nullptr) return file.failure();
  std::uint32_t width = 0, height = 0;
  TIFFGetField(file.tiff(), TIFFTAG_IMAGEWIDTH, &width);
  TIFFGetField(file.tiff(), TIFFTAG_IMAGELENGTH, &height);
  constexpr std::uint32_t kMax = std::numeric_limits<int>::max();
  if (width > kMax || height > kMax) return broken_image("TIFF", "its size is damaged");
  return ImageSize{static_cast<int>(width), static_cast<int>(height)};
}

Result<ImageSize> read_size(std::string_view bytes) {
  return size_of(TiffFile(bytes));
}

Result<DecodedImage> decode(std::string_view bytes, ImageSize size, const DecodeOptions& options) {
  TiffFile file(bytes);
  if (file.tiff() == nullptr) return file.failure();
  if (!is_plausible_size(size.width, size.height, bytes.size()))
    return broken_image("TIFF", implausible_size(size.width, size.height));
  const auto compression = static_cast<std::uint16_t>(file.number(TIFFTAG_COMPRESSION));
  if (std::ranges::find(kCompressions, compression) == kCompressions.end())
    return unsupported_image(fmt::format("a TIFF image of compression {}", compression),
                             "save it uncompressed, with LZW or with Deflate");
  const Layout layout = layout_of(file, size);
  if (layout.samples > kMaxSamples) return broken_image("TIFF", "it has too many samples in a pixel");
  if (!is_direct(layout)) return decode_converted(file, size, options);
  if (layout.bits == 16 && layout.sample_format == SAMPLEFORMAT_IEEEFP)
    return read_halves(file, layout, options.keep_alpha);
  if (layout.bits == 8) return DirectReader<std::uint8_t>(file, layout, options.keep_alpha).read();
  if (layout.bits == 16) return DirectReader<std::uint16_t>(file, layout, options.keep_alpha).read();
  return DirectReader<float>(file, layout, options.keep_alpha).read();
}

}  // namespace
}  // namespace tiff

const Codec kTiffCodec{"TIFF", false, tiff::matches, tiff::read_size, tiff::decode};

}  // namespace tessera::core
