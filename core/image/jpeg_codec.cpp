// SPDX-License-Identifier: Apache-2.0
// JPEG by libjpeg-turbo: baseline, extended and progressive, Huffman or arithmetic codes, 8 bits.
//
// The same bytes give the same pixels on every machine: JDCT_ISLOW is exact integer arithmetic, and fancy
// upsampling and colour conversion are integer too, so libjpeg-turbo's SIMD code equals its C code.
// JDCT_FLOAT and JDCT_IFAST give no such guarantee. jpeg_codec_test compares both.
#include <csetjmp>
#include <cstdio>  // jpeglib.h needs it

#include <jerror.h>
#include <jpeglib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <new>
#include <type_traits>

#include "core/image/codec.hpp"
#include "core/image/limits.hpp"

namespace tessera::core {
namespace jpeg {
namespace {

// A progressive file may refine the same coefficients indefinitely, a few bytes at a time; typical files
// have about ten scans. Pixels times scans are limited too, because a scan of a large image takes long.
constexpr int kMaxScans = 500;
constexpr std::int64_t kMaxPixelScans = std::int64_t{1} << 34;

// Whether the file is long enough for its pixels: a block of 64 takes at least one bit (ITU-T T.81, annex
// F). Chroma may be subsampled by 16, but luma is not then.
bool is_long_enough(ImageSize size, std::size_t file_bytes) {
  return size.pixels() <= std::uint64_t{8} * 64 * file_bytes;
}

// libjpeg reports errors through a callback that must not return. The callback exits by longjmp, across C
// frames only.
class JpegDecoder {
 public:
  explicit JpegDecoder(std::string_view bytes) {
    info_.err = jpeg_std_error(&errors_);
    errors_.error_exit = [](j_common_ptr info) { std::longjmp(self(info).jump_, 1); };
    errors_.emit_message = [](j_common_ptr info, int level) { self(info).note_message(level); };
    errors_.output_message = [](j_common_ptr) {};
    info_.client_data = this;
    created_ = run([&] {
      jpeg_create_decompress(&info_);
      jpeg_mem_src(&info_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    });
  }
  ~JpegDecoder() {
    if (created_) jpeg_destroy_decompress(&info_);
  }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  bool read_header() {
    return created_ && run([this] { jpeg_read_header(&info_, TRUE); });
  }
  ImageSize size() const {
    return {static_cast<int>(info_.image_width), static_cast<int>(info_.image_height)};
  }
  int precision() const { return info_.data_precision; }
  bool is_cmyk() const { return info_.num_components == 4; }
  // Adobe's programs store inverted ink values (255 - ink).
  bool is_inverted() const { return info_.saw_Adobe_marker; }
  std::size_t channels() const { return is_cmyk() ? 4 : 3; }

  // Decodes into `values`, channels() per pixel.
  bool decode(std::uint8_t* values) {
    info_.out_color_space = is_cmyk() ? JCS_CMYK : JCS_RGB;
    info_.dct_method = JDCT_ISLOW;
    info_.do_fancy_upsampling = TRUE;
    info_.do_block_smoothing = FALSE;
    info_.mem->max_memory_to_use = max_memory();
    progress_.progress_monitor = [](j_common_ptr info) { self(info).check_scans(); };
    info_.progress = &progress_;
    return run([this, values] {
      jpeg_start_decompress(&info_);
      while (info_.output_scanline < info_.output_height) {
        JSAMPROW row = values + std::size_t{info_.output_scanline} * info_.output_width * channels();
        jpeg_read_scanlines(&info_, &row, 1);
      }
    });
  }

  // Whether image data is missing, not just the end marker.
  bool ends_too_early() const {
    if (!reached_end_) return false;
    return lacks_data_ || lacks_scans();
  }
  long warning_count() const { return errors_.num_warnings; }

  // The error message after a function has returned false.
  std::string reason() {
    if (too_many_scans_) return "it has too many scans";
    std::array<char, JMSG_LENGTH_MAX> text{};
    errors_.format_message(common(), text.data());
    return printable_reason(text.data());
  }
  std::string first_warning() const { return printable_reason(first_warning_.data()); }
  bool lacks_precision() const { return errors_.msg_code == JERR_BAD_PRECISION; }
  bool ran_out_of_memory() const { return errors_.msg_code == JERR_OUT_OF_MEMORY; }

 private:
  j_common_ptr common() { return reinterpret_cast<j_common_ptr>(&info_); }
  static JpegDecoder& self(j_common_ptr info) { return *static_cast<JpegDecoder*>(info->client_data); }

  // A longjmp must not skip destructors, so `step` must have no such objects.
  template <typename Step>
  bool run(Step step) {
    static_assert(std::is_trivially_destructible_v<Step>);
    if (setjmp(jump_) != 0) return false;
    step();
    return true;
  }

  void note_message(int level) {
    if (level >= 0) return;  // a trace message, not a warning
    if (errors_.num_warnings++ == 0) errors_.format_message(common(), first_warning_.data());
    if (errors_.msg_code == JWRN_JPEG_EOF) reached_end_ = true;
    if (errors_.msg_code == JWRN_HIT_MARKER) lacks_data_ = true;
  }

  void check_scans() {
    const std::int64_t scans = info_.input_scan_number;
    if (scans <= kMaxScans && scans * static_cast<std::int64_t>(size().pixels()) <= kMaxPixelScans) return;
    too_many_scans_ = true;
    std::longjmp(jump_, 1);
  }

  // Two bytes for each coefficient, in blocks padded to 32 pixels each way, and tables.
  long max_memory() const {
    constexpr std::int64_t kBytesPerPixel = 16, kPadding = 32, kTables = std::int64_t{1} << 24;
    return kBytesPerPixel * (size().width + kPadding) * (size().height + kPadding) + kTables;
  }

  // For a file without an end marker: whether a component has no scan, or a progressive one is incomplete.
  bool lacks_scans() const {
    for (int i = 0; i < info_.num_components; ++i) {
      if (info_.comp_info[i].quant_table == nullptr) return true;
      if (info_.coef_bits == nullptr) continue;
      const int* bits = info_.coef_bits[i];
      if (std::any_of(bits, bits + DCTSIZE2, [](int missing) { return missing != 0; })) return true;
    }
    return false;
  }

  jpeg_decompress_struct info_{};
  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
  std::jmp_buf jump_{};
  std::array<char, JMSG_LENGTH_MAX> first_warning_{};
  bool created_ = false, reached_end_ = false, lacks_data_ = false, too_many_scans_ = false;
};

bool matches(std::string_view bytes) {
  return bytes.starts_with("\xff\xd8\xff");
}

tl::unexpected<Error> jpeg_failure(JpegDecoder& decoder) {
  if (decoder.ran_out_of_memory()) throw std::bad_alloc();
  return broken_image("JPEG", decoder.reason());
}

Status check_header(JpegDecoder& decoder) {
  if (decoder.read_header()) return {};
  if (!decoder.lacks_precision()) return jpeg_failure(decoder);
  return unsupported_image(fmt::format("a JPEG image of {} bits", decoder.precision()),
                           "save it with 8 bits, or as PNG with 16");
}

Result<ImageSize> read_size(std::string_view bytes) {
  JpegDecoder decoder(bytes);
  if (const Status status = check_header(decoder); !status) return fail(status.error());
  return decoder.size();
}

// Converts without a colour profile, as most programs do: the result is the light absorbed by neither ink
// nor black.
void cmyk_to_rgb(DecodedImage::Bytes& values, bool inverted) {
  const std::size_t pixels = values.size() / 4;
  const auto light = [inverted](unsigned code) { return inverted ? code : 255 - code; };
  for (std::size_t i = 0; i < pixels; ++i) {
    const unsigned black = light(values[4 * i + 3]);
    for (std::size_t c = 0; c < 3; ++c)
      values[3 * i + c] = static_cast<std::uint8_t>((light(values[4 * i + c]) * black + 127) / 255);
  }
  values.resize(3 * pixels);
}

Result<DecodedImage> decode(std::string_view bytes, ImageSize size, const DecodeOptions&) {
  if (!is_long_enough(size, bytes.size())) return broken_image("JPEG", kEndsTooEarly);
  JpegDecoder decoder(bytes);
  if (const Status status = check_header(decoder); !status) return fail(status.error());
  DecodedImage::Bytes values(size.pixels() * decoder.channels());
  if (!decoder.decode(values.data())) return jpeg_failure(decoder);
  if (decoder.ends_too_early()) return broken_image("JPEG", kEndsTooEarly);
  if (decoder.is_cmyk()) cmyk_to_rgb(values, decoder.is_inverted());
  DecodedImage image{.size = size, .channels = 3, .values = std::move(values), .warnings = {}};
  if (const long count = decoder.warning_count(); count > 0)
    image.warnings.push_back(fmt::format("is a JPEG image with faults, which were passed over ({}: {})",
                                         count, decoder.first_warning()));
  return image;
}

}  // namespace
}  // namespace jpeg

const Codec kJpegCodec{"JPEG", false, jpeg::matches, jpeg::read_size, jpeg::decode};

}  // namespace tessera::core
