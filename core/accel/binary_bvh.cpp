#include "core/accel/binary_bvh.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

namespace tessera::core {
namespace {

constexpr int kBins = 16;
constexpr std::size_t kTaskSize = 4096;  // ranges shorter than this are not worth a task

struct Item {
  Aabb box;
  std::uint32_t primitive;

  float centroid(int axis) const { return 0.5f * box.lower[axis] + 0.5f * box.upper[axis]; }
};

struct RangeBounds {
  Aabb boxes, centroids;
};

RangeBounds bound(std::span<const Item> items) {
  RangeBounds bounds;
  for (const Item& item : items) {
    bounds.boxes.include(item.box);
    bounds.centroids.include(Vec3{item.centroid(0), item.centroid(1), item.centroid(2)});
  }
  return bounds;
}

// Cuts the centroids' extent along one axis into bins of equal length.
class Binning {
 public:
  Binning(const Aabb& centroids, int axis)
      : axis_(axis), lower_(centroids.lower[axis]), bins_per_length_(kBins / centroids.extent(axis)) {}

  int bin(const Item& item) const {
    const double position = (static_cast<double>(item.centroid(axis_)) - lower_) * bins_per_length_;
    return std::min(static_cast<int>(position), kBins - 1);
  }

 private:
  int axis_;
  double lower_, bins_per_length_;
};

// How many packets a leaf of these primitives would take, times the chance that a ray meets it.
struct Cost {
  Aabb box;
  std::size_t count = 0;

  void add(const Cost& other) {
    box.include(other.box);
    count += other.count;
  }
  double value() const {
    return box.half_area() * static_cast<double>((count + kMaxLeafSize - 1) / kMaxLeafSize);
  }
};

struct Split {
  double cost = std::numeric_limits<double>::infinity();
  int axis = -1;
  int first_right_bin = 0;
};

Split best_split_along(std::span<const Item> items, const Aabb& centroids, int axis) {
  const Binning binning(centroids, axis);
  std::array<Cost, kBins> bins;
  for (const Item& item : items) bins[static_cast<std::size_t>(binning.bin(item))].add({item.box, 1});

  std::array<double, kBins> right_cost{};
  Cost right;
  for (std::size_t i = kBins - 1; i > 0; --i) {
    right.add(bins[i]);
    right_cost[i] = right.value();
  }
  Split best;
  Cost left;
  for (std::size_t i = 1; i < kBins; ++i) {
    left.add(bins[i - 1]);
    const double cost = left.value() + right_cost[i];
    if (cost < best.cost) best = {cost, axis, static_cast<int>(i)};
  }
  return best;
}

Split best_split(std::span<const Item> items, const Aabb& centroids) {
  Split best;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(centroids.extent(axis) > 0)) continue;
    const Split split = best_split_along(items, centroids, axis);
    if (split.cost < best.cost) best = split;
  }
  return best;
}

class Builder {
 public:
  explicit Builder(const Primitives& primitives) {
    items_.reserve(primitives.count());
    for (std::uint32_t i = 0; i < primitives.count(); ++i) {
      const Aabb box = primitives.bounds(i);
      if (!box.empty()) items_.push_back({box, i});
    }
    if (!items_.empty()) nodes_.resize(2 * items_.size() - 1);
  }

  BinaryBvh build(int threads) {
    if (!items_.empty()) {
#pragma omp parallel num_threads(threads)
#pragma omp single
      build_subtree(0, 0, items_.size(), 0);
    }
    BinaryBvh tree;
    tree.nodes = std::move(nodes_);
    tree.order.reserve(items_.size());
    for (const Item& item : items_) tree.order.push_back(item.primitive);
    return tree;
  }

 private:
  // A subtree of n primitives has at most 2n - 1 nodes, and they are numbered from `node`: where a node goes
  // depends on nothing that other tasks do.
  void build_subtree(std::size_t node, std::size_t begin, std::size_t end, int depth) {
    const RangeBounds bounds = bound(range(begin, end));
    nodes_[node] = {bounds.boxes, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), 0};
    if (end - begin <= kMaxLeafSize) return;

    const std::size_t middle = partition(begin, end, bounds.centroids, depth);
    const std::size_t left = node + 1, right = node + 2 * (middle - begin);
    nodes_[node].right = static_cast<std::uint32_t>(right);
#pragma omp task if (end - begin > kTaskSize) default(shared) firstprivate(left, begin, middle, depth)
    build_subtree(left, begin, middle, depth + 1);
    build_subtree(right, middle, end, depth + 1);
  }

  // Reorders the range and returns where its right part begins; neither part is empty.
  std::size_t partition(std::size_t begin, std::size_t end, const Aabb& centroids, int depth) {
    const std::size_t half = begin + (end - begin) / 2;
    if (depth >= kMaxSahDepth) return half;
    const auto items = range(begin, end);
    const Split split = best_split(items, centroids);
    if (split.axis < 0) return half;  // all centroids are the same
    const Binning binning(centroids, split.axis);
    const auto right = std::partition(items.begin(), items.end(), [&](const Item& item) {
      return binning.bin(item) < split.first_right_bin;
    });
    const auto middle = begin + static_cast<std::size_t>(right - items.begin());
    return middle == begin || middle == end ? half : middle;
  }

  std::span<Item> range(std::size_t begin, std::size_t end) {
    return std::span(items_).subspan(begin, end - begin);
  }

  std::vector<Item> items_;
  std::vector<BinaryBvh::Node> nodes_;
};

}  // namespace

BinaryBvh build_binary_bvh(const Primitives& primitives, int threads) {
  return Builder(primitives).build(threads);
}

}  // namespace tessera::core
