// SPDX-License-Identifier: Apache-2.0
// PNG by libspng, which compresses with zlib.
#include "core/image/png_encoder.hpp"

#include <fmt/format.h>
#include <spng.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <new>
#include <string_view>
#include <vector>

#include "core/image/srgb.hpp"

namespace tessera::core {
namespace {

// Of zlib. Higher ones take several times as long, and save a few percent of noisy images.
constexpr int kCompressionLevel = 4;

struct SpngFree {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};

// A file that takes rows of codes, from the top down. Throws std::bad_alloc.
class PngFile {
 public:
  PngFile(int width, int height, spng_color_type color_type, ByteSink& sink);
  PngFile(const PngFile&) = delete;
  PngFile& operator=(const PngFile&) = delete;

  // The last row completes the file.
  Status write_row(const std::vector<std::uint8_t>& codes);
  std::uint64_t size() const { return size_; }

 private:
  static int append(spng_ctx* context, void* file, void* bytes, std::size_t count);
  Status status_of(int code) const;

  ByteSink& sink_;
  std::uint64_t size_ = 0;
  Status written_;  // the first error of the sink
  bool out_of_memory_ = false;
  int begun_ = 0;  // libspng's result of what comes before the rows
  std::unique_ptr<spng_ctx, SpngFree> context_;
};

PngFile::PngFile(int width, int height, spng_color_type color_type, ByteSink& sink)
    : sink_(sink), context_(spng_ctx_new(SPNG_CTX_ENCODER)) {
  if (!context_) throw std::bad_alloc();
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(width);
  header.height = static_cast<std::uint32_t>(height);
  header.bit_depth = 8;
  header.color_type = static_cast<std::uint8_t>(color_type);
  spng_set_png_stream(context_.get(), append, this);
  spng_set_option(context_.get(), SPNG_IMG_COMPRESSION_LEVEL, kCompressionLevel);
  begun_ = spng_set_ihdr(context_.get(), &header);
  if (begun_ != 0) return;
  begun_ = spng_encode_image(context_.get(), nullptr, 0, SPNG_FMT_PNG,
                             SPNG_ENCODE_PROGRESSIVE | SPNG_ENCODE_FINALIZE);
}

// Called by C code, which no exception may pass.
int PngFile::append(spng_ctx*, void* file, void* bytes, std::size_t count) {
  auto& self = *static_cast<PngFile*>(file);
  try {
    self.written_ = self.sink_.write_at(self.size_, {static_cast<const char*>(bytes), count});
  } catch (const std::bad_alloc&) {
    self.out_of_memory_ = true;
  }
  self.size_ += count;
  return self.written_ && !self.out_of_memory_ ? 0 : SPNG_IO_ERROR;
}

Status PngFile::write_row(const std::vector<std::uint8_t>& codes) {
  if (begun_ != 0) return status_of(begun_);
  return status_of(spng_encode_row(context_.get(), codes.data(), codes.size()));
}

Status PngFile::status_of(int code) const {
  if (code == 0 || code == SPNG_EOI) return {};
  if (code == SPNG_EMEM || out_of_memory_) throw std::bad_alloc();
  if (!written_) return written_;
  return fail(ErrorCode::kInternal, fmt::format("cannot encode the PNG file: {}", spng_strerror(code)));
}

}  // namespace

Result<std::uint64_t> write_png(const RowSource& source, const DisplaySettings& display, ByteSink& sink) {
  const DisplayTransform to_screen(display);
  const auto width = static_cast<std::size_t>(source.width);
  std::vector<std::uint8_t> codes(3 * width);
  PngFile file(source.width, source.height, SPNG_COLOR_TYPE_TRUECOLOR, sink);
  for (int y = 0; y < source.height; ++y) {
    const auto row = source.row(y);
    if (!row) return fail(row.error());
    for (std::size_t x = 0; x < width; ++x) {
      const Rgb shown = to_screen((*row)[x]);
      for (int channel = 0; channel < 3; ++channel)
        codes[3 * x + static_cast<std::size_t>(channel)] = srgb_encode(shown[channel]);
    }
    if (const Status written = file.write_row(codes); !written) return fail(written.error());
  }
  return file.size();
}

Result<std::uint64_t> write_png_with_alpha(const ChannelRows& source, const DisplaySettings& display,
                                           ByteSink& sink) {
  constexpr std::size_t kChannels = 4;
  const DisplayTransform to_screen(display);
  const auto width = static_cast<std::size_t>(source.width);
  std::vector<std::uint8_t> codes(kChannels * width);
  PngFile file(source.width, source.height, SPNG_COLOR_TYPE_TRUECOLOR_ALPHA, sink);
  for (int y = 0; y < source.height; ++y) {
    const auto row = source.row(y);
    if (!row) return fail(row.error());
    for (std::size_t x = 0; x < width; ++x) {
      const float* const pixel = *row + x * source.channels.size();
      const float alpha = pixel[3] > 0 ? std::min(pixel[3], 1.0f) : 0;
      const Rgb shown = to_screen(Rgb{pixel[0], pixel[1], pixel[2]} * (alpha > 0 ? 1 / alpha : 1));
      std::uint8_t* const code = codes.data() + kChannels * x;
      for (int channel = 0; channel < 3; ++channel) code[channel] = srgb_encode(shown[channel]);
      code[3] = static_cast<std::uint8_t>(alpha * 255 + 0.5f);
    }
    if (const Status written = file.write_row(codes); !written) return fail(written.error());
  }
  return file.size();
}

}  // namespace tessera::core
