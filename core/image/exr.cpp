#include "core/image/exr.hpp"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "core/image/exr_header.hpp"
#include "core/image/limits.hpp"

namespace tessera::core {
namespace {

constexpr const char* kStreamName = "picture";

// Of a file whose pixels cannot be compressed: where the row is, and what is said of its block.
constexpr std::size_t kMostHeaderBytes = 1024, kMostBytesBesideARow = 16;

class StringWriter : public Imf::OStream {
 public:
  // Does not grow, and so takes no more memory, up to a file of this size.
  explicit StringWriter(std::size_t expected_bytes) : OStream(kStreamName) { bytes_.reserve(expected_bytes); }

  void write(const char* data, int size) override {
    const auto count = static_cast<std::size_t>(size);
    if (position_ + count > bytes_.size()) bytes_.resize(position_ + count);
    std::memcpy(bytes_.data() + position_, data, count);
    position_ += count;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::size_t position_ = 0;
};

class StringReader : public Imf::IStream {
 public:
  // Reads `header` in place of as many of the file's first bytes.
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

// Where OpenEXR finds channel `offset` of the pixel at the window's corner, and its neighbours.
Imf::Slice channel_slice(const Image& image, std::size_t channel, const Imath::Box2i& window) {
  const char* base = reinterpret_cast<const char*>(image.pixels.data()) + channel * sizeof(float);
  return Imf::Slice::Make(Imf::FLOAT, base, window, sizeof(Rgb),
                          sizeof(Rgb) * static_cast<std::size_t>(image.width));
}

Result<Image> image_for_window(const Imath::Box2i& window, std::size_t file_bytes) {
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (!is_plausible_size(width, height, file_bytes)) {
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("its size of {}x{} pixels is not plausible for a file of its length", width, height));
  }
  return Image(static_cast<int>(width), static_cast<int>(height));
}

Result<Image> read_pixels(Imf::InputFile& file, std::size_t file_bytes) {
  const Imath::Box2i window = file.header().dataWindow();
  const Imf::ChannelList& channels = file.header().channels();
  const bool colour = channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
  const bool gray = channels.findChannel("Y") && !channels.findChannel("RY") && !channels.findChannel("BY");
  if (!colour && !gray) {
    return fail(ErrorCode::kInvalidArgument, "it has neither the channels R, G and B nor Y alone");
  }
  Result<Image> image = image_for_window(window, file_bytes);
  if (!image) return image;
  Imf::FrameBuffer frame;
  for (std::size_t i = 0; i < (colour ? 3 : 1); ++i) {
    frame.insert(colour ? std::string(1, "RGB"[i]) : "Y", channel_slice(*image, i, window));
  }
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  if (!colour) {
    for (Rgb& pixel : image->pixels) pixel = Rgb::gray(pixel.r);
  }
  return image;
}

}  // namespace

Result<std::string> encode_exr(const Image& image) {
  try {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer frame;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::string name(1, "RGB"[i]);
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      frame.insert(name, channel_slice(image, i, header.dataWindow()));
    }
    StringWriter stream(kMostHeaderBytes + image.pixels.size() * sizeof(Rgb) +
                        static_cast<std::size_t>(image.height) * kMostBytesBesideARow);
    {
      Imf::OutputFile file(stream, header, 0);
      file.setFrameBuffer(frame);
      file.writePixels(image.height);
    }  // completes the table of offsets
    return stream.take();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kResourceExhausted, "not enough memory to encode OpenEXR");
  } catch (const std::exception& e) {
    return fail(ErrorCode::kInternal, fmt::format("cannot encode OpenEXR: {}", e.what()));
  }
}

Result<Image> decode_exr(std::string_view bytes) {
  // OpenEXR quotes what it read, whatever it was.
  const auto unreadable = [](std::string why) {
    std::ranges::replace_if(
        why, [](char c) { return c < ' ' || c > '~'; }, '?');
    return fail(ErrorCode::kInvalidArgument, fmt::format("not a readable OpenEXR picture: {}", why));
  };
  const Result<std::string> header = checked_exr_header(bytes);
  if (!header) return unreadable(header.error().message);
  try {
    StringReader stream(*header, bytes);
    Imf::InputFile file(stream, 0);
    return read_pixels(file, bytes.size());
  } catch (const std::exception& e) {
    return unreadable(e.what());
  }
}

}  // namespace tessera::core
