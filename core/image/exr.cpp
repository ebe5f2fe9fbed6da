// SPDX-License-Identifier: Apache-2.0
#include "core/image/exr.hpp"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/base/suggestion.hpp"
#include "core/image/codec.hpp"
#include "core/image/exr_header.hpp"
#include "core/image/exr_layers.hpp"

namespace tessera::core {
namespace exr {
namespace {

constexpr const char* kStreamName = "image";

// An error of the sink, on its way through OpenEXR.
struct SinkError : std::runtime_error {
  explicit SinkError(Error sink_error) : runtime_error(sink_error.message), error(std::move(sink_error)) {}
  Error error;
};

class SinkWriter : public Imf::OStream {
 public:
  explicit SinkWriter(ByteSink& sink) : OStream(kStreamName), sink_(sink) {}

  void write(const char* data, int size) override {
    const auto count = static_cast<std::size_t>(size);
    if (auto written = sink_.write_at(position_, {data, count}); !written) throw SinkError(written.error());
    position_ += count;
    size_ = std::max(size_, position_);
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }

  std::uint64_t size() const { return size_; }

 private:
  ByteSink& sink_;
  std::uint64_t position_ = 0, size_ = 0;
};

class StringReader : public Imf::IStream {
 public:
  // Reads `header` in place of the file's first bytes.
  StringReader(std::string_view header, std::string_view bytes)
      : IStream(kStreamName), header_(header), bytes_(bytes) {}

  bool read(char* data, int size) override {
    const auto count = static_cast<std::size_t>(size);
    if (size < 0 || position_ > bytes_.size() || count > bytes_.size() - position_) {
      throw std::runtime_error("the file ends too early");
    }
    const std::size_t of_header = std::min(count, header_.size() - std::min(position_, header_.size()));
    if (of_header > 0) std::memcpy(data, header_.data() + position_, of_header);
    std::memcpy(data + of_header, bytes_.data() + position_ + of_header, count - of_header);
    position_ += count;
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }
  void clear() override {}

 private:
  std::string_view header_, bytes_;
  std::size_t position_ = 0;
};

Imf::Header window_header(const ChannelRows& source) {
  if (!source.position) return Imf::Header(source.width, source.height);
  const ImagePosition& at = *source.position;
  const Imath::Box2i display({0, 0}, {at.image_width - 1, at.image_height - 1});
  const Imath::Box2i data({at.x0, at.y0}, {at.x0 + source.width - 1, at.y0 + source.height - 1});
  return Imf::Header(display, data);
}

Imf::Header header_of(const ChannelRows& source) {
  Imf::Header header = window_header(source);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const std::string& name : source.channels) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  for (const auto& [name, text] : source.attributes) header.insert(name, Imf::StringAttribute(text));
  return header;
}

// The slice through which OpenEXR addresses a channel of whatever row is in the buffer: rows have no distance
// from each other. OpenEXR adds the first column of the image to the pointer.
Imf::Slice row_slice(const std::vector<float>& row, std::size_t channel, std::size_t channels,
                     int first_column) {
  const std::size_t pixel_bytes = channels * sizeof(float);
  const char* const base = reinterpret_cast<const char*>(row.data() + channel);
  const std::ptrdiff_t before = first_column * static_cast<std::ptrdiff_t>(pixel_bytes);
  return Imf::Slice(Imf::FLOAT, const_cast<char*>(base) - before, pixel_bytes, 0);
}

// OpenEXR compresses some rows at a time.
void write_rows(const ChannelRows& source, Imf::OutputFile& file) {
  const std::size_t channels = source.channels.size();
  std::vector<float> buffer(static_cast<std::size_t>(source.width) * channels);
  Imf::FrameBuffer frame;
  for (std::size_t i = 0; i < channels; ++i)
    frame.insert(source.channels[i], row_slice(buffer, i, channels, file.header().dataWindow().min.x));
  file.setFrameBuffer(frame);
  for (int y = 0; y < source.height; ++y) {
    const auto row = source.row(y);
    if (!row) throw SinkError(row.error());
    std::copy_n(*row, buffer.size(), buffer.begin());
    file.writePixels(1);
  }
}

Result<DecodedImage> read_channels(Imf::InputFile& file, ImageSize size, const ChannelNames& names,
                                   bool keep_alpha) {
  const bool has_alpha = keep_alpha && file.header().channels().findChannel(names.alpha) != nullptr;
  const std::size_t channels = has_alpha ? 4 : 3;
  DecodedImage::Floats values(size.pixels() * channels);
  const Imath::Box2i window = file.header().dataWindow();
  Imf::FrameBuffer frame;
  const auto insert = [&](const std::string& name, std::size_t channel) {
    frame.insert(name, Imf::Slice::Make(Imf::FLOAT, values.data() + channel, window, channels * sizeof(float),
                                        channels * sizeof(float) * static_cast<std::size_t>(size.width)));
  };
  const bool is_gray = names.colors[0] == names.colors[1];
  for (std::size_t i = 0; i < (is_gray ? 1 : 3); ++i)
    if (!names.colors[i].empty()) insert(names.colors[i], i);
  if (has_alpha) insert(names.alpha, 3);
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  for (std::size_t i = 0; is_gray && i < values.size(); i += channels)
    values[i + 1] = values[i + 2] = values[i];
  return DecodedImage{.size = size, .channels = channels, .values = std::move(values), .warnings = {}};
}

// Luminance and subsampled chroma, which OpenEXR converts as half floats.
Result<DecodedImage> read_luminance_chroma(StringReader& stream, ImageSize size) {
  Imf::RgbaInputFile file(stream, 0);
  const Imath::Box2i window = file.dataWindow();
  std::vector<Imf::Rgba> pixels(size.pixels());
  const auto width = static_cast<std::ptrdiff_t>(size.width);
  file.setFrameBuffer(pixels.data() - window.min.x - window.min.y * width, 1,
                      static_cast<std::size_t>(width));
  file.readPixels(window.min.y, window.max.y);
  DecodedImage::Floats values;
  values.reserve(3 * size.pixels());
  for (const Imf::Rgba& pixel : pixels) values.insert(values.end(), {pixel.r, pixel.g, pixel.b});
  return DecodedImage{.size = size, .channels = 3, .values = std::move(values), .warnings = {}};
}

// Of a file without colours.
Result<DecodedImage> read_first_layer(Imf::InputFile& file, ImageSize size) {
  const Imf::ChannelList& channels = file.header().channels();
  const std::vector<std::string> layers = layers_of(channels);
  const auto names = layers.empty() ? std::nullopt : layer_channels(channels, layers.front());
  if (!names) return unsupported_image("an OpenEXR image without channels", "it needs one at least");
  auto image = read_channels(file, size, *names, false);
  if (image)
    image->warnings.push_back(
        fmt::format("has no colours; its first layer is read, {}", in_quotes(layers.front())));
  return image;
}

Result<DecodedImage> read_pixels(StringReader& stream, ImageSize size, const DecodeOptions& options) {
  const bool keep_alpha = options.keep_alpha;
  {
    Imf::InputFile file(stream, 0);  // 0: single-threaded
    const Imf::ChannelList& channels = file.header().channels();
    if (!options.layer.empty()) {
      const auto names = layer_channels(channels, std::string(options.layer));
      if (names) return read_channels(file, size, *names, false);
      return no_such_layer(channels, options.layer);
    }
    const auto names = color_channels(channels);
    if (!names) return read_first_layer(file, size);
    if (names->colors[0] != "Y" || !has_chroma(channels))
      return read_channels(file, size, *names, keep_alpha);
  }
  stream.seekg(0);
  return read_luminance_chroma(stream, size);
}

// OpenEXR quotes file contents verbatim, so they are escaped.
tl::unexpected<Error> broken_exr(const std::string& why) {
  return broken_image("OpenEXR", printable_reason(why));
}

bool matches(std::string_view bytes) {
  return bytes.starts_with("\x76\x2f\x31\x01");
}

Result<ExrHeader> header_of_file(std::string_view bytes) {
  const ExrStructure structure = exr_structure(bytes);
  if (structure != ExrStructure::kFlat)
    return unsupported_image(
        structure == ExrStructure::kDeep ? "a deep OpenEXR image" : "an OpenEXR image of several parts",
        "save it as one flat part");
  auto header = checked_exr_header(bytes);
  if (!header) return broken_exr(header.error().message);
  return header;
}

Result<ImageSize> read_size(std::string_view bytes) {
  const auto header = header_of_file(bytes);
  if (!header) return fail(header.error());
  return header->size;
}

// What `read` returns of the file, whose exceptions become errors.
template <typename Read>
auto with_stream(std::string_view bytes, const Read& read)
    -> decltype(read(std::declval<StringReader&>(), std::declval<const ExrHeader&>())) {
  const auto header = header_of_file(bytes);
  if (!header) return fail(header.error());
  try {
    StringReader stream(header->bytes, bytes);
    return read(stream, *header);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    return broken_exr(e.what());
  }
}

Result<DecodedImage> decode(std::string_view bytes, ImageSize size, const DecodeOptions& options) {
  return with_stream(bytes, [&](StringReader& stream, const ExrHeader& header) {
    auto image = read_pixels(stream, size, options);
    if (image) image->primaries = header.primaries;
    return image;
  });
}

}  // namespace
}  // namespace exr

Result<std::vector<std::string>> exr_layers(std::string_view bytes) {
  return exr::with_stream(
      bytes, [](exr::StringReader& stream, const ExrHeader&) -> Result<std::vector<std::string>> {
        return layers_of(Imf::InputFile(stream, 0).header().channels());
      });
}

Result<std::uint64_t> write_exr(const ChannelRows& source, ByteSink& sink) {
  try {
    const Imf::Header header = exr::header_of(source);
    exr::SinkWriter stream(sink);
    {
      Imf::OutputFile file(stream, header, 0);
      exr::write_rows(source, file);
    }  // completes the table of offsets
    return stream.size();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kResourceExhausted, "not enough memory to encode OpenEXR");
  } catch (const exr::SinkError& e) {
    return fail(e.error);
  } catch (const std::exception& e) {
    return fail(ErrorCode::kInternal, fmt::format("cannot encode OpenEXR: {}", e.what()));
  }
}

Result<std::uint64_t> write_exr(const RowSource& source, ByteSink& sink) {
  static_assert(sizeof(Rgb) == 3 * sizeof(float));
  const auto row = [&](int y) -> Result<const float*> {
    const auto pixels = source.row(y);
    if (!pixels) return fail(pixels.error());
    return &(*pixels)->r;
  };
  return write_exr(
      ChannelRows{source.width, source.height, {"R", "G", "B"}, row, source.position, source.attributes},
      sink);
}

const Codec kExrCodec{"OpenEXR", true, exr::matches, exr::read_size, exr::decode};

}  // namespace tessera::core
