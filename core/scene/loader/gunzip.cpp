// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/gunzip.hpp"

#include <libdeflate.h>

#include <cstdint>
#include <memory>

namespace tessera::core {
namespace {

constexpr std::size_t kMaxRatio = 256, kSmallestGzip = 18;

struct DecompressorFree {
  void operator()(libdeflate_decompressor* decompressor) const { libdeflate_free_decompressor(decompressor); }
};

tl::unexpected<Error> broken_gzip() {
  return fail(ErrorCode::kInvalidArgument, "is a broken gzip file");
}

// From the last four bytes, which hold it modulo 2^32.
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
  const std::size_t size = size_of_content(bytes);
  if (size / kMaxRatio > bytes.size())
    return fail(ErrorCode::kResourceExhausted, "holds more than 256 times its own size; decompress it first");
  content.assign(size, '\0');
  const std::unique_ptr<libdeflate_decompressor, DecompressorFree> decompressor(
      libdeflate_alloc_decompressor());
  if (!decompressor) return fail(ErrorCode::kResourceExhausted, "does not fit into memory");
  const libdeflate_result result = libdeflate_gzip_decompress(decompressor.get(), bytes.data(), bytes.size(),
                                                              content.data(), content.size(), nullptr);
  if (result != LIBDEFLATE_SUCCESS) return broken_gzip();
  return std::string_view(content);
}

}  // namespace tessera::core
