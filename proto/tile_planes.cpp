// SPDX-License-Identifier: Apache-2.0
#include "proto/tile_planes.hpp"

#include <emmintrin.h>
#include <fmt/format.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <new>
#include <numeric>

namespace tessera::proto {
namespace {

static_assert(std::endian::native == std::endian::little, "planes are made of bytes as they lie in memory");

// A fast level. The planes are noise or nearly constant, so higher levels do not compress them better.
constexpr int kZstdLevel = -5;
constexpr std::size_t kBytes = sizeof(std::uint64_t);

// Sixteen words, two in each register; or sixteen bytes of each plane, one plane in each register.
constexpr std::size_t kSumsPerBlock = 16;
using Block = std::array<__m128i, kBytes>;

// Interleaves the bytes of each register whose number has `bit` clear with those of the register that has it
// set. In terms of the register's number and the byte's position, this moves the highest bit of the position
// into `bit`, and the old `bit` to the lowest bit of the position.
template <std::size_t bit>
void interleave(Block& block) {
  for (std::size_t i = 0; i < block.size(); ++i) {
    if ((i & bit) != 0) continue;
    const __m128i low = _mm_unpacklo_epi8(block[i], block[i + bit]);
    block[i + bit] = _mm_unpackhi_epi8(block[i], block[i + bit]);
    block[i] = low;
  }
}

void load(Block& block, const void* from, std::size_t stride) {
  for (std::size_t i = 0; i < block.size(); ++i)
    block[i] = _mm_loadu_si128(reinterpret_cast<const __m128i*>(static_cast<const char*>(from) + i * stride));
}

// Writes words to the planes, of `total` bytes each, from position `begin` on.
void scatter(const std::vector<std::uint64_t>& sums, std::size_t begin, std::size_t total, char* planes) {
  char* to = planes + begin;
  std::size_t i = 0;
  for (; i + kSumsPerBlock <= sums.size(); i += kSumsPerBlock, to += kSumsPerBlock) {
    Block block;
    load(block, sums.data() + i, sizeof(__m128i));
    interleave<4>(block);
    interleave<2>(block);
    interleave<1>(block);
    interleave<4>(block);
    for (std::size_t plane = 0; plane < kBytes; ++plane) {
      const std::size_t of_plane = (plane & 1) << 2 | plane >> 1;
      _mm_storeu_si128(reinterpret_cast<__m128i*>(to + plane * total), block[of_plane]);
    }
  }
  for (; i < sums.size(); ++i, ++to)
    for (std::size_t plane = 0; plane < kBytes; ++plane)
      to[plane * total] = static_cast<char>(sums[i] >> (8 * plane) & 0xff);
}

std::vector<std::uint64_t> gather(const char* planes, std::size_t begin, std::size_t total,
                                  std::size_t count) {
  std::vector<std::uint64_t> sums(count);
  const char* from = planes + begin;
  std::size_t i = 0;
  for (; i + kSumsPerBlock <= sums.size(); i += kSumsPerBlock, from += kSumsPerBlock) {
    Block block;
    load(block, from, total);
    interleave<4>(block);
    interleave<2>(block);
    interleave<1>(block);
    std::memcpy(sums.data() + i, block.data(), sizeof block);
  }
  for (; i < sums.size(); ++i, ++from)
    for (std::size_t plane = 0; plane < kBytes; ++plane)
      sums[i] |= std::uint64_t{static_cast<unsigned char>(from[plane * total])} << (8 * plane);
  return sums;
}

// What a thread keeps between tiles: the words of a tile with most layers.
constexpr std::size_t kKeptBytes = std::size_t{2} << 20;

// Kept by each thread between tiles, since allocating so much memory takes as long as the work.
struct Workspace {
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> compressor{ZSTD_createCCtx(), &ZSTD_freeCCtx};
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> decompressor{ZSTD_createDCtx(), &ZSTD_freeDCtx};
  std::string planes, frame;

  Workspace() {
    if (!compressor || !decompressor) throw std::bad_alloc();
  }

  void shrink() {
    for (std::string* buffer : {&planes, &frame})
      if (buffer->capacity() > kKeptBytes) std::string().swap(*buffer);
  }
};

Workspace& workspace() {
  thread_local Workspace of_this_thread;
  return of_this_thread;
}

}  // namespace

std::string encode_planes(const std::vector<std::uint64_t>& sums, const std::vector<std::uint64_t>& odd_sums,
                          const core::Planes& planes) {
  Workspace& work = workspace();
  std::vector<const std::vector<std::uint64_t>*> lists{&sums, &odd_sums};
  for (const core::Plane& plane : planes) lists.push_back(&plane);
  std::size_t total = 0;
  for (const auto* list : lists) total += list->size();
  work.planes.resize(total * kBytes);
  std::size_t begin = 0;
  for (const auto* list : lists) {
    scatter(*list, begin, total, work.planes.data());
    begin += list->size();
  }
  work.frame.resize(ZSTD_compressBound(work.planes.size()));
  const std::size_t size = ZSTD_compressCCtx(work.compressor.get(), work.frame.data(), work.frame.size(),
                                             work.planes.data(), work.planes.size(), kZstdLevel);
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // no other failure is possible if the frame has room
  std::string frame = work.frame.substr(0, size);
  work.shrink();
  return frame;
}

core::Result<TilePlanes> decode_planes(std::string_view frame, std::size_t count,
                                       const PlaneSizes& plane_words) {
  Workspace& work = workspace();
  const std::size_t total = std::accumulate(plane_words.begin(), plane_words.end(), 2 * count);
  work.planes.resize(total * kBytes);
  const std::size_t size = ZSTD_decompressDCtx(work.decompressor.get(), work.planes.data(),
                                               work.planes.size(), frame.data(), frame.size());
  if (ZSTD_getErrorCode(size) == ZSTD_error_memory_allocation) throw std::bad_alloc();
  if (ZSTD_isError(size) != 0 || size != work.planes.size()) {
    work.shrink();
    return core::fail(core::ErrorCode::kDataLoss,
                      fmt::format("its sums are no complete frame of {} bytes", total * kBytes));
  }
  TilePlanes decoded{gather(work.planes.data(), 0, total, count),
                     gather(work.planes.data(), count, total, count)};
  std::size_t begin = 2 * count;
  for (const std::uint32_t words : plane_words) {
    decoded.planes.push_back(gather(work.planes.data(), begin, total, words));
    begin += words;
  }
  work.shrink();
  return decoded;
}

void add_plane_words(const core::Planes& planes, PlaneSizes& plane_words) {
  for (const core::Plane& plane : planes) plane_words.Add(static_cast<std::uint32_t>(plane.size()));
}

core::Status check_plane_words(const PlaneSizes& plane_words, const core::FilmLayout& layout,
                               std::size_t pixels, std::uint32_t samples) {
  const auto count = static_cast<std::size_t>(plane_words.size());
  if (count != layout.planes())
    return core::fail(core::ErrorCode::kDataLoss,
                      fmt::format("it has {} planes of layers instead of {}", count, layout.planes()));
  for (std::size_t i = 0; i < count; ++i) {
    const core::FilmChannel& channel = layout.plane(i);
    const std::size_t words = plane_words[static_cast<int>(i)];
    const bool is_list = channel.encoding == core::ChannelEncoding::kIds;
    const std::size_t most_ids = std::min<std::size_t>(core::kMaxIdsPerPixel, samples);
    const bool fits =
        is_list ? words % 2 == 0 && words <= 2 * pixels * most_ids : words == 0 || words == pixels;
    if (!fits)
      return core::fail(core::ErrorCode::kDataLoss,
                        fmt::format("its plane {} has {} words of {} pixels", channel.name, words, pixels));
  }
  return {};
}

}  // namespace tessera::proto
