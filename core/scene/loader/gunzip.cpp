// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/gunzip.hpp"

#include <libdeflate.h>

#include <algorithm>
#include <cstdint>
#include <memory>

namespace tessera::core {
namespace {

constexpr std::size_t kMaxRatio = 256, kMaxContent = 0xffffffff, kSmallestGzip = 18;

struct DecompressorFree {
  void operator()(libdeflate_decompressor* decompressor) const { libdeflate_free_decompressor(decompressor); }
};

tl::unexpected<Error> broken_gzip() {
  return fail(ErrorCode::kInvalidArgument, "is a broken gzip file");
}

// Of the last member, from the last four bytes, which hold it modulo 2^32. Files have one member as a rule.
std::size_t size_of_content(std::string_view bytes) {
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < 4; ++i)
    size |= std::uint32_t{static_cast<unsigned char>(bytes[bytes.size() - 4 + i])} << 8 * i;
  return size;
}

}  // namespace

bool is_gzip(std::string_view bytes) {
  return bytes.starts_with("\x1f\x8b\x08");
}

Result<std::string_view> gunzipped(std::string_view bytes, std::string& content) {
  if (!is_gzip(bytes)) return bytes;
  if (bytes.size() < kSmallestGzip) return broken_gzip();
  const std::unique_ptr<libdeflate_decompressor, DecompressorFree> decompressor(
      libdeflate_alloc_decompressor());
  if (!decompressor) return fail(ErrorCode::kResourceExhausted, "does not fit into memory");
  const std::size_t most = std::min(kMaxRatio * bytes.size(), kMaxContent);
  content.assign(std::min(size_of_content(bytes), most), '\0');
  std::size_t done = 0;
  while (bytes.find_first_not_of('\0') != std::string_view::npos) {  // else it is padding
    std::size_t read = 0, written = 0;
    const libdeflate_result result =
        libdeflate_gzip_decompress_ex(decompressor.get(), bytes.data(), bytes.size(), content.data() + done,
                                      content.size() - done, &read, &written);
    if (result == LIBDEFLATE_INSUFFICIENT_SPACE && content.size() < most) {
      content.resize(std::min(most, 2 * content.size() + kMaxRatio));
    } else if (result == LIBDEFLATE_INSUFFICIENT_SPACE) {
      return fail(ErrorCode::kResourceExhausted,
                  "holds more than 256 times its own size; decompress it first");
    } else if (result != LIBDEFLATE_SUCCESS) {
      return broken_gzip();
    } else {
      bytes.remove_prefix(read);
      done += written;
    }
  }
  content.resize(done);
  return std::string_view(content);
}

}  // namespace tessera::core
