// SPDX-License-Identifier: Apache-2.0
#include "core/accel/binary_bvh.hpp"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <utility>
#include <vector>

#include "core/accel/partition.hpp"
#include "core/base/top_down.hpp"

namespace tessera::core::accel {
namespace {

constexpr std::size_t kTaskSize = 2048;  // shorter ranges are not worth a task

// Allocates nodes in pairs. Each thread takes pairs from its own block.
class NodePairs {
 public:
  // The first pair is reserved for the root.
  explicit NodePairs(int threads) : blocks_(static_cast<std::size_t>(threads)) {}

  // An upper bound on the nodes of a tree over `primitives` primitives.
  static std::size_t capacity(std::size_t primitives, int threads) {
    return 2 * primitives + kBlock * (static_cast<std::size_t>(threads) + 1);
  }

  std::uint32_t take() {
    Block& block = blocks_[static_cast<std::size_t>(omp_get_thread_num())];
    if (block.next == block.end) {
      block.next = next_.fetch_add(kBlock, std::memory_order_relaxed);
      block.end = block.next + kBlock;
    }
    block.next += 2;
    return block.next - 2;
  }

  std::size_t used() const { return next_.load(); }

 private:
  static constexpr std::uint32_t kBlock = 4096;
  struct alignas(64) Block {
    std::uint32_t next = 0, end = 0;
  };

  std::vector<Block> blocks_;
  std::atomic<std::uint32_t> next_{2};
};

// A range of items with its bounds. OpenMP tasks copy it, so its alignment must not exceed the default.
struct Range {
  std::size_t begin, end;
  Aabb box, half_centroids;
  int depth;
  std::uint32_t node = 0;  // where it is stored

  Range(std::size_t begin_item, std::size_t end_item, const RangeBounds& bounds, int at_depth)
      : begin(begin_item),
        end(end_item),
        box(bounds.boxes.box()),
        half_centroids(bounds.half_centroids.box()),
        depth(at_depth) {}

  std::size_t size() const { return end - begin; }
};

class Builder {
 public:
  Builder(const Primitives& primitives, int threads)
      : primitives_(primitives),
        only_triangles_(has_only_triangles(primitives)),
        threads_(threads),
        pairs_(threads),
        items_(primitives.count()) {
    const Range all = make_items(primitives);
    items_.truncate(all.end);
    if (items_.empty()) return;
    tree_.nodes = HugePageArray<BinaryBvh::Node>(NodePairs::capacity(items_.size(), threads));
    build_top_down(all, kTaskSize, threads_, [this](const Range& range) { return divide(range); });
    tree_.nodes.truncate(pairs_.used());
    collect_order();
  }

  BinaryBvh take_tree() { return std::move(tree_); }

 private:
  // Ids are ordered by kind, with moving triangles behind others.
  static bool has_only_triangles(const Primitives& primitives) {
    return primitives.count() > 0 && primitives.kind(primitives.count() - 1) == GeometryKind::kTriangle;
  }

  // Fills items_ in parallel pieces and closes the gaps left by primitives that cannot be hit.
  Range make_items(const Primitives& primitives) {
    const std::size_t pieces = piece_count(items_.size());
    std::vector<std::size_t> counts(pieces);
    std::vector<RangeBounds> bounds(pieces);
#pragma omp parallel for num_threads(threads_) schedule(dynamic)
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const auto items = piece_of(items_.range(0, items_.size()), piece);
      std::size_t count = 0;  // a local counter: entries of `counts` share cache lines with other threads'
      for (std::size_t i = 0; i < items.size(); ++i) {
        const auto primitive = static_cast<std::uint32_t>(piece * kPiece + i);
        const Aabb box = primitives.bounds(primitive);
        if (!box.empty()) items[count++] = BuildItem(box, primitive);
      }
      counts[piece] = count;
      bounds[piece] = bounds_of(items.first(count));
    }
    std::size_t count = 0;
    RangeBounds all;
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const BuildItem* from = items_.data() + piece * kPiece;
      if (count < piece * kPiece) std::copy(from, from + counts[piece], items_.data() + count);
      count += counts[piece];
      all.include(bounds[piece]);
    }
    return {0, count, all, 0};
  }

  // Stores the range's node and returns its parts; none of a leaf.
  std::optional<std::pair<Range, Range>> divide(const Range& range) {
    BinaryBvh::Node& node = tree_.nodes[range.node];
    if (is_leaf(range)) {
      node = {range.box.lower, static_cast<std::uint32_t>(range.begin), range.box.upper,
              static_cast<std::uint32_t>(range.size())};
      return std::nullopt;
    }
    const std::uint32_t children = pairs_.take();
    node = {range.box.lower, children, range.box.upper, 0};
    std::optional parts = cut(range);
    parts->first.node = children;
    parts->second.node = children + 1;
    return parts;
  }

  // A leaf holds primitives of one kind, and a single instance, since entering one costs more than a box
  // test.
  bool is_leaf(const Range& range) const {
    if (range.size() > kMaxLeafSize) return false;
    if (range.size() == 1 || only_triangles_) return true;
    return kind_of(range.begin) != GeometryKind::kInstance && !has_several_kinds(range);
  }
  bool has_several_kinds(const Range& range) const {
    for (std::size_t i = range.begin + 1; i < range.end; ++i)
      if (kind_of(i) != kind_of(range.begin)) return true;
    return false;
  }
  GeometryKind kind_of(std::size_t item) const {
    return primitives_.kind(items_[item].primitive());
  }

  // Partitions the range in place; neither part is empty.
  std::pair<Range, Range> cut(const Range& range) {
    if (range.size() <= kMaxLeafSize && has_several_kinds(range)) return apart_by_kind(range);
    if (range.depth >= kMaxSahDepth) return halves(range);
    const auto items = items_.range(range.begin, range.end);
    const Binning binning(range.half_centroids);
    const bool in_parallel = range.size() >= kParallelSize;
    const Split split =
        (in_parallel ? bins_in_parallel(items, binning) : bins_of(items, binning)).best_split(range.box);
    if (split.axis < 0) return halves(range);
    const Parts parts =
        in_parallel ? partition_in_parallel(items, binning, split) : partition(items, binning, split);
    const std::size_t middle = range.begin + parts.left_count;
    return {{range.begin, middle, {split.left, parts.left_half_centroids}, range.depth + 1},
            {middle, range.end, {split.right, parts.right_half_centroids}, range.depth + 1}};
  }

  std::pair<Range, Range> halves(const Range& range) {
    return cut_at(range.begin + range.size() / 2, range);
  }

  // Makes as few leaves as possible of primitives that but for their kinds would be one.
  std::pair<Range, Range> apart_by_kind(const Range& range) {
    const GeometryKind kind = kind_of(range.begin);
    const auto items = items_.range(range.begin, range.end);
    auto others = items.begin();  // not std::stable_partition, whose buffer is not aligned as BuildItem is
    for (auto item = items.begin(); item != items.end(); ++item)
      if (primitives_.kind(item->primitive()) == kind) std::rotate(others++, item, item + 1);
    return cut_at(range.begin + static_cast<std::size_t>(others - items.begin()), range);
  }

  std::pair<Range, Range> cut_at(std::size_t middle, const Range& range) {
    return {{range.begin, middle, bounds_of(items_.range(range.begin, middle)), range.depth + 1},
            {middle, range.end, bounds_of(items_.range(middle, range.end)), range.depth + 1}};
  }

  static Bins bins_of(std::span<const BuildItem> items, const Binning& binning) {
    Bins bins;
    bins.add(binning, items);
    return bins;
  }

  static Bins bins_in_parallel(std::span<BuildItem> items, const Binning& binning) {
    std::vector<Bins> bins(piece_count(items.size()));
#pragma omp taskloop default(shared)
    for (std::size_t i = 0; i < bins.size(); ++i) bins[i].add(binning, piece_of(items, i));
    for (std::size_t i = 1; i < bins.size(); ++i) bins[0].add(bins[i]);
    return bins[0];
  }

  void collect_order() {
    tree_.order = HugePageArray<std::uint32_t>(items_.size());
#pragma omp parallel for num_threads(threads_)
    for (std::size_t i = 0; i < items_.size(); ++i) tree_.order[i] = items_[i].primitive();
  }

  const Primitives& primitives_;
  const bool only_triangles_;  // none of which moves
  int threads_;
  NodePairs pairs_;
  HugePageArray<BuildItem> items_;
  BinaryBvh tree_;
};

}  // namespace

BinaryBvh build_binary_bvh(const Primitives& primitives, int threads) {
  return Builder(primitives, threads).take_tree();
}

}  // namespace tessera::core::accel
