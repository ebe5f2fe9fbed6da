// SPDX-License-Identifier: Apache-2.0
#include "core/accel/partition.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace tessera::core::accel {
namespace {

// Items on the wrong side of the border, as runs.
using Runs = std::vector<std::span<BuildItem>>;

std::size_t total(const Runs& runs) {
  std::size_t size = 0;
  for (const auto& run : runs) size += run.size();
  return size;
}

// Iterates over the items of several runs.
class RunCursor {
 public:
  RunCursor(const Runs& runs, std::size_t skip) : run_(runs.begin()) {
    while (skip >= run_->size()) skip -= (run_++)->size();
    next_ = skip;
  }

  // Swaps `count` items with those of `other`.
  void swap(RunCursor& other, std::size_t count) {
    while (count > 0) {
      const std::size_t n = std::min({count, run_->size() - next_, other.run_->size() - other.next_});
      std::swap_ranges(run_->data() + next_, run_->data() + next_ + n, other.run_->data() + other.next_);
      advance(n);
      other.advance(n);
      count -= n;
    }
  }

 private:
  void advance(std::size_t count) {
    next_ += count;
    if (next_ == run_->size()) ++run_, next_ = 0;
  }

  Runs::const_iterator run_;
  std::size_t next_;
};

void swap_runs(const Runs& a, const Runs& b) {
  const std::size_t size = total(a);
#pragma omp taskloop default(shared)
  for (std::size_t piece = 0; piece < piece_count(size); ++piece) {
    const std::size_t begin = piece * kPiece;
    RunCursor from(a, begin), to(b, begin);
    from.swap(to, std::min(kPiece, size - begin));
  }
}

void add_unless_empty(Runs& runs, std::span<BuildItem> run) {
  if (!run.empty()) runs.push_back(run);
}

}  // namespace

RangeBounds bounds_of(std::span<const BuildItem> items) {
  RangeBounds bounds;
  for (const BuildItem& item : items) bounds.include(item.box());
  return bounds;
}

// Branch-free, because a branch would be mispredicted for every other item.
Parts partition(std::span<BuildItem> items, const Binning& binning, const Split& split) {
  Parts parts;
  const BuildBox none;
  const U32xN border(static_cast<std::uint32_t>(split.first_right_bin));
  for (BuildItem& item : items) {
    const BuildItem moved = item;
    item = items[parts.left_count];
    items[parts.left_count] = moved;
    const BuildBox box = moved.box(), centroid = box.half_centroid();
    const MaskN is_left = less_if_small(in_every_lane(binning.bins(box, box), split.axis), border);
    parts.left_half_centroids.include({select(is_left, centroid.v, none.v)});
    parts.right_half_centroids.include({select(is_left, none.v, centroid.v)});
    parts.left_count += is_left.bits() & 1;
  }
  return parts;
}

Parts partition_in_parallel(std::span<BuildItem> items, const Binning& binning, const Split& split) {
  const std::size_t pieces = piece_count(items.size());
  std::vector<Parts> parts(pieces);
#pragma omp taskloop default(shared)
  for (std::size_t i = 0; i < pieces; ++i) parts[i] = partition(piece_of(items, i), binning, split);

  Parts all;
  for (const Parts& part : parts) {
    all.left_count += part.left_count;
    all.left_half_centroids.include(part.left_half_centroids);
    all.right_half_centroids.include(part.right_half_centroids);
  }
  // Each piece has its left items first. Items on the wrong side of the global border are exchanged.
  Runs right_before_border, left_behind_border;
  for (std::size_t i = 0; i < pieces; ++i) {
    const auto piece = piece_of(items, i);
    const auto [left, right] =
        std::pair(piece.first(parts[i].left_count), piece.subspan(parts[i].left_count));
    const std::size_t begin = i * kPiece, middle = begin + left.size();
    const std::size_t border = std::clamp(all.left_count, begin, begin + piece.size());
    add_unless_empty(right_before_border, right.first(border > middle ? border - middle : 0));
    add_unless_empty(left_behind_border, left.subspan(std::min(border - begin, left.size())));
  }
  swap_runs(right_before_border, left_behind_border);
  return all;
}

}  // namespace tessera::core::accel
