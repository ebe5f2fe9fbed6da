// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/nanovdb_file.hpp"

#include <libdeflate.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "core/scene/loader/bytes_at.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kHeaderBytes = 16, kDescriptionBytes = 176;
constexpr std::size_t kMaxExpansion = 1100;  // of the deflate algorithm, rounded up
constexpr std::uint64_t kMaxGridBytes = std::uint64_t{1} << 32;

enum class Codec : std::uint16_t { kNone = 0, kZip = 1, kBlosc = 2 };

tl::unexpected<Error> broken_nanovdb(std::string_view what) {
  return fail(ErrorCode::kInvalidArgument, "is a broken NanoVDB file: " + std::string(what));
}

struct StoredGrid {
  std::string_view name;
  std::uint64_t size = 0, stored_size = 0;  // bytes
  Codec codec = Codec::kNone;
};

// Takes `count` bytes off the front; nullopt if there are fewer.
std::optional<std::string_view> take_front(std::string_view& rest, std::uint64_t count) {
  if (count > rest.size()) return std::nullopt;
  const std::string_view front = rest.substr(0, count);
  rest.remove_prefix(count);
  return front;
}

std::optional<StoredGrid> take_description(std::string_view& rest) {
  const auto description = take_front(rest, kDescriptionBytes);
  if (!description) return std::nullopt;
  const auto name = take_front(rest, *bytes_at<std::uint32_t>(*description, 136));
  if (!name) return std::nullopt;
  StoredGrid entry;
  entry.name = name->substr(0, name->find('\0'));
  entry.size = *bytes_at<std::uint64_t>(*description, 0);
  entry.stored_size = *bytes_at<std::uint64_t>(*description, 8);
  entry.codec = static_cast<Codec>(*bytes_at<std::uint16_t>(*description, 168));
  return entry;
}

struct InflaterFree {
  void operator()(libdeflate_decompressor* inflater) const { libdeflate_free_decompressor(inflater); }
};

Result<std::string_view> unzip(std::string_view stored, std::uint64_t size, std::string& content) {
  const auto packed_size = bytes_at<std::uint64_t>(stored, 0);
  if (!packed_size || *packed_size > stored.size() - sizeof(std::uint64_t))
    return broken_nanovdb("a compressed grid is cut short");
  if (size / kMaxExpansion > *packed_size || size > kMaxGridBytes)
    return fail(ErrorCode::kResourceExhausted,
                "claims to expand more than 1100 times, or to more than 4 GiB");
  const std::unique_ptr<libdeflate_decompressor, InflaterFree> inflater(libdeflate_alloc_decompressor());
  if (!inflater) return fail(ErrorCode::kResourceExhausted, "does not fit into memory");
  content.assign(size, '\0');
  const auto result = libdeflate_zlib_decompress(inflater.get(), stored.data() + sizeof(std::uint64_t),
                                                 *packed_size, content.data(), content.size(), nullptr);
  if (result != LIBDEFLATE_SUCCESS) return broken_nanovdb("the compressed data of a grid are damaged");
  return std::string_view(content);
}

Result<std::string_view> plain_bytes(const StoredGrid& entry, std::string_view stored, std::string& content) {
  switch (entry.codec) {
    case Codec::kNone:
      return stored;
    case Codec::kZip:
      return unzip(stored, entry.size, content);
    case Codec::kBlosc:
      return fail(ErrorCode::kInvalidArgument, "is compressed by BLOSC, which is not read");
  }
  return broken_nanovdb("its compression is not known");
}

}  // namespace

Result<std::optional<std::string_view>> find_nanovdb_grid(std::string_view file, std::string_view name,
                                                          std::string& content) {
  std::string_view rest = file;
  if (!rest.starts_with("NanoVDB")) return broken_nanovdb("it does not begin with \"NanoVDB\"");
  while (!rest.empty()) {
    const auto header = take_front(rest, kHeaderBytes);
    if (!header || !header->starts_with("NanoVDB")) return broken_nanovdb("a segment has no header");
    std::vector<StoredGrid> entries;
    for (int left = *bytes_at<std::uint16_t>(*header, 12); left > 0; --left) {
      const auto entry = take_description(rest);
      if (!entry) return broken_nanovdb("the list of its grids is cut short");
      entries.push_back(*entry);
    }
    for (const StoredGrid& entry : entries) {
      const auto stored = take_front(rest, entry.stored_size);
      if (!stored) return broken_nanovdb("a grid is cut short");
      if (entry.name != name) continue;
      const auto plain = plain_bytes(entry, *stored, content);
      if (!plain) return fail(plain.error());
      return std::optional(*plain);
    }
  }
  return std::optional<std::string_view>();
}

}  // namespace tessera::core
