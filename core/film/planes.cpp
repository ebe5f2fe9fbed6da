// SPDX-License-Identifier: Apache-2.0
#include "core/film/planes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/film/fixed_point.hpp"

namespace tessera::core {
namespace {

constexpr std::uint32_t kLowest = 0xffffffffu;

struct IdEntry {
  std::uint64_t key, count;  // the two words
};

IdEntry entry_at(const Plane& plane, std::size_t index) {
  return {plane[2 * index], plane[2 * index + 1]};
}

void push_entry(Plane& plane, const IdEntry& entry) {
  plane.push_back(entry.key);
  plane.push_back(entry.count);
}

std::uint32_t pixel_of(std::uint64_t key) {
  return static_cast<std::uint32_t>(key >> 32);
}

// The finaliser of MurmurHash3 (Appleby 2011).
std::uint64_t mixed(std::uint64_t bits) {
  bits = (bits ^ bits >> 33) * 0xff51afd7ed558ccdu;
  bits = (bits ^ bits >> 33) * 0xc4ceb9fe1a85ec53u;
  return bits ^ bits >> 33;
}

// The place of an id in the pixel's order: the smaller, the more likely it is kept.
std::uint64_t rank(std::uint64_t key, const PixelRect& rect) {
  const auto width = static_cast<std::uint32_t>(rect.width());
  const auto x = static_cast<std::uint32_t>(rect.x0) + pixel_of(key) % width;
  const auto y = static_cast<std::uint32_t>(rect.y0) + pixel_of(key) / width;
  return mixed(mixed(std::uint64_t{y} << 32 | x) ^ static_cast<std::uint32_t>(key));
}

// Appends the entries of one pixel, sorted by id, but no more than a pixel keeps.
void append_pixel(std::span<const IdEntry> entries, const PixelRect& rect, Plane& plane) {
  std::uint64_t last_kept = std::numeric_limits<std::uint64_t>::max();
  if (entries.size() > kMaxIdsPerPixel) {
    std::vector<std::uint64_t> ranks;
    for (const IdEntry& entry : entries) ranks.push_back(rank(entry.key, rect));
    const auto last = ranks.begin() + (kMaxIdsPerPixel - 1);
    std::nth_element(ranks.begin(), last, ranks.end());
    last_kept = *last;
  }
  for (const IdEntry& entry : entries)
    if (last_kept == std::numeric_limits<std::uint64_t>::max() || rank(entry.key, rect) <= last_kept)
      push_entry(plane, entry);
}

// The plane of entries that are sorted, and each of which has a key of its own.
Plane limited(std::span<const IdEntry> entries, const PixelRect& rect) {
  Plane plane;
  plane.reserve(2 * entries.size());
  for (std::size_t begin = 0; begin < entries.size();) {
    std::size_t end = begin + 1;
    while (end < entries.size() && pixel_of(entries[end].key) == pixel_of(entries[begin].key)) ++end;
    append_pixel(entries.subspan(begin, end - begin), rect, plane);
    begin = end;
  }
  return plane;
}

// The entries of a plane of `from_rect` that lie in `to_rect`, with their places there.
std::vector<IdEntry> entries_within(const Plane& from, const PixelRect& from_rect, const PixelRect& to_rect) {
  std::vector<IdEntry> entries;
  entries.reserve(from.size() / 2);
  const auto from_width = static_cast<std::uint32_t>(from_rect.width());
  for (std::size_t i = 0; i < from.size() / 2; ++i) {
    const IdEntry entry = entry_at(from, i);
    const int x = from_rect.x0 + static_cast<int>(pixel_of(entry.key) % from_width) - to_rect.x0;
    const int y = from_rect.y0 + static_cast<int>(pixel_of(entry.key) / from_width) - to_rect.y0;
    if (x < 0 || y < 0 || x >= to_rect.width() || y >= to_rect.height()) continue;
    const auto pixel = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(to_rect.width()) +
                       static_cast<std::uint64_t>(x);
    entries.push_back({pixel << 32 | static_cast<std::uint32_t>(entry.key), entry.count});
  }
  return entries;
}

void add_ids(Plane& to, const PixelRect& rect, std::span<const IdEntry> from) {
  std::vector<IdEntry> all;
  all.reserve(to.size() / 2 + from.size());
  std::size_t next = 0;
  const auto append_before = [&](std::uint64_t key) {
    for (; next < to.size() / 2 && to[2 * next] < key; ++next) all.push_back(entry_at(to, next));
  };
  for (const IdEntry& entry : from) {
    append_before(entry.key);
    const bool both = next < to.size() / 2 && to[2 * next] == entry.key;
    all.push_back({entry.key, entry.count + (both ? to[2 * next++ + 1] : 0)});
  }
  for (; next < to.size() / 2; ++next) all.push_back(entry_at(to, next));
  to = limited(all, rect);
}

void add_words(ChannelEncoding encoding, Plane& to, const PixelRect& to_rect, const Plane& from,
               const PixelRect& from_rect) {
  to.resize(to_rect.pixel_count());
  const auto to_width = static_cast<std::size_t>(to_rect.width()),
             from_width = static_cast<std::size_t>(from_rect.width());
  for (int y = to_rect.y0; y < to_rect.y1; ++y) {
    std::uint64_t* const to_row = to.data() + static_cast<std::size_t>(y - to_rect.y0) * to_width;
    const std::uint64_t* const from_row = from.data() +
                                          static_cast<std::size_t>(y - from_rect.y0) * from_width +
                                          static_cast<std::size_t>(to_rect.x0 - from_rect.x0);
    for (std::size_t x = 0; x < to_width; ++x) to_row[x] = combine(encoding, to_row[x], from_row[x]);
  }
}

tl::unexpected<Error> impossible(const FilmChannel& channel, std::string_view why) {
  return fail(ErrorCode::kInvalidArgument, fmt::format("{}: {}", channel.name, why));
}

Status check_ids(const FilmChannel& channel, const Plane& plane, const PixelRect& rect,
                 std::uint32_t samples) {
  if (plane.size() % 2 != 0) return impossible(channel, "has half an entry");
  std::uint64_t in_pixel = 0;
  std::size_t ids = 0;
  for (std::size_t i = 0; i < plane.size() / 2; ++i) {
    const auto [key, count] = entry_at(plane, i);
    if (i > 0 && plane[2 * (i - 1)] >= key) return impossible(channel, "its entries are not sorted");
    if (pixel_of(key) >= rect.pixel_count() || static_cast<std::uint32_t>(key) == 0)
      return impossible(channel, "has an entry of no pixel, or without an id");
    const bool is_first = i == 0 || pixel_of(plane[2 * (i - 1)]) != pixel_of(key);
    ids = is_first ? 1 : ids + 1;
    in_pixel = is_first ? 0 : in_pixel;
    if (count == 0 || count > samples - in_pixel || ids > kMaxIdsPerPixel)
      return impossible(channel, "counts more samples or ids than there can be");
    in_pixel += count;
  }
  return {};
}

Status check_words(const FilmChannel& channel, const Plane& plane, std::uint32_t samples) {
  const auto most_signed = static_cast<std::uint64_t>(kMaxSignedSample) * samples;
  for (const std::uint64_t word : plane) {
    const bool possible = channel.encoding == ChannelEncoding::kCount ? word <= samples
                          : channel.encoding == ChannelEncoding::kSigned
                              ? word + most_signed <= 2 * most_signed
                          : channel.encoding == ChannelEncoding::kNearest
                              ? word == 0 || (word >> 32 >= kLowest - 0x7f800000u && samples > 0)
                              : samples > 0 || word == 0;
    if (!possible) return impossible(channel, "has a sum that no samples have");
  }
  return {};
}

}  // namespace

std::uint64_t to_signed_word(double value) {
  if (std::isnan(value)) return 0;
  constexpr auto kMaxUnits = static_cast<double>(kMaxSignedSample);
  const double units = std::clamp(std::floor(value / kSignedUnit + 0.5), -kMaxUnits, kMaxUnits);
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(units));
}

double mean_signed(std::uint64_t sum, std::uint32_t samples) {
  return samples == 0 ? 0 : static_cast<double>(static_cast<std::int64_t>(sum)) * kSignedUnit / samples;
}

std::uint64_t to_nearest_word(float distance, std::uint32_t number) {
  assert(distance >= 0);
  return std::uint64_t{kLowest - std::bit_cast<std::uint32_t>(distance + 0.0f)} << 32 | number;
}

float nearest_distance(std::uint64_t word) {
  if (word == 0) return std::numeric_limits<float>::infinity();
  return std::bit_cast<float>(kLowest - static_cast<std::uint32_t>(word >> 32));
}

std::uint64_t combine(ChannelEncoding encoding, std::uint64_t a, std::uint64_t b) {
  switch (encoding) {
    case ChannelEncoding::kSigned:
      return a + b;
    case ChannelEncoding::kNearest:
      return std::max(a, b);
    default:
      return add_saturating(a, b);
  }
}

void drop_zeros(Plane& plane) {
  if (std::all_of(plane.begin(), plane.end(), [](std::uint64_t word) { return word == 0; })) plane.clear();
}

void add_planes(const FilmLayout& layout, Planes& to, const PixelRect& to_rect, const Planes& from,
                const PixelRect& from_rect) {
  assert(from_rect.contains(to_rect));
  if (from.empty()) return;
  assert(from.size() == layout.planes());
  to.resize(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (from[i].empty()) continue;
    const ChannelEncoding encoding = layout.plane(i).encoding;
    if (encoding == ChannelEncoding::kIds)
      add_ids(to[i], to_rect, entries_within(from[i], from_rect, to_rect));
    else
      add_words(encoding, to[i], to_rect, from[i], from_rect);
    drop_zeros(to[i]);
  }
}

Status check_planes(const FilmLayout& layout, const Planes& planes, const PixelRect& rect,
                    std::uint32_t samples) {
  if (planes.empty()) return {};
  if (planes.size() != layout.planes())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("planes: must be {}, got {}", layout.planes(), planes.size()));
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const FilmChannel& channel = layout.plane(i);
    const bool has_ids = channel.encoding == ChannelEncoding::kIds;
    if (!has_ids && !planes[i].empty() && planes[i].size() != rect.pixel_count())
      return impossible(channel, "has not a sum for each pixel");
    const Status possible =
        has_ids ? check_ids(channel, planes[i], rect, samples) : check_words(channel, planes[i], samples);
    if (!possible) return possible;
  }
  return {};
}

void IdCounter::add(std::uint32_t pixel, std::uint32_t id) {
  if (id == 0) return;
  const std::uint64_t key = std::uint64_t{pixel} << 32 | id;
  if (!entries_.empty() && entries_.back().key == key) {
    ++entries_.back().count;
    return;
  }
  entries_.push_back({key, 1});
  if (entries_.size() >= compact_at_) compact();
}

void IdCounter::compact() {
  const Plane plane = take();
  for (std::size_t i = 0; i < plane.size(); i += 2) entries_.push_back({plane[i], plane[i + 1]});
  compact_at_ = std::max(compact_at_, 2 * entries_.size());
}

Plane IdCounter::take() {
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.key < b.key; });
  std::vector<IdEntry> merged;
  for (const Entry& entry : entries_) {
    if (!merged.empty() && merged.back().key == entry.key)
      merged.back().count += entry.count;
    else
      merged.push_back({entry.key, entry.count});
  }
  entries_.clear();
  return limited(merged, rect_);
}

}  // namespace tessera::core
