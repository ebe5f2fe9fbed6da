// SPDX-License-Identifier: Apache-2.0
// LightTree::build: builds a binary tree by the surface area orientation heuristic, then merges nodes until
// they have eight children.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "core/base/top_down.hpp"
#include "core/lights/light_tree.hpp"

namespace tessera::core::lights {
namespace {

constexpr std::size_t kBins = 12;
constexpr int kMaxHeuristicDepth = 64;   // sets deeper in the tree are halved
constexpr std::size_t kTaskSize = 4096;  // shorter ranges are not worth a task

using Item = LightTree::Item;

// A squared length, in proportion to the area of the bounding sphere. Unlike the area of the box, it is not
// 0 for lights in a row.
double squared_diagonal(const Aabb& box) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) sum += box.extent(axis) * box.extent(axis);
  return sum;
}

float middle(const Aabb& box, int axis) {
  return 0.5f * box.lower[axis] + 0.5f * box.upper[axis];
}

// The cost of a set: by power, spatial extent and directional extent (Conty Estevez and Kulla 2018, eq. 1).
double cost(const LightBounds& bounds) {
  return bounds.power() > 0 ? bounds.power() * bounds.orientation_measure() * squared_diagonal(bounds.box())
                            : 0;
}

// Divides the extent of the lights' centres along one axis into bins of equal length.
class Binning {
 public:
  Binning(const Aabb& middles, int axis)
      : axis_(axis),
        lower_(static_cast<double>(middles.lower[axis])),
        bins_per_length_(static_cast<double>(kBins) / middles.extent(axis)) {}

  std::size_t bin(const Item& item) const {
    const double position =
        (static_cast<double>(middle(item.bounds.box(), axis_)) - lower_) * bins_per_length_;
    return std::min(static_cast<std::size_t>(position), kBins - 1);
  }

 private:
  int axis_;
  double lower_, bins_per_length_;
};

struct Split {
  double cost = std::numeric_limits<double>::infinity();
  int axis = -1;
  std::size_t first_right_bin = 0;
};

Split best_split_along(std::span<const Item> items, const Aabb& middles, int axis) {
  const Binning binning(middles, axis);
  std::array<LightBounds, kBins> bins;
  for (const Item& item : items) bins[binning.bin(item)].include(item.bounds);

  std::array<double, kBins> right_cost{};
  LightBounds right;
  for (std::size_t i = kBins - 1; i > 0; --i) {
    right.include(bins[i]);
    right_cost[i] = cost(right);
  }
  Split best;
  LightBounds left;
  for (std::size_t i = 1; i < kBins; ++i) {
    left.include(bins[i - 1]);
    const double both = cost(left) + right_cost[i];
    if (both < best.cost) best = {both, axis, i};
  }
  return best;
}

// Splits along a short axis make slices; their cost is scaled by the ratio of the longest axis to it.
Split best_split(std::span<const Item> items, const Aabb& middles) {
  const double longest = std::max({middles.extent(0), middles.extent(1), middles.extent(2)});
  Split best;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(middles.extent(axis) > 0)) continue;
    Split split = best_split_along(items, middles, axis);
    split.cost *= longest / middles.extent(axis);
    if (split.cost < best.cost) best = split;
  }
  return best;
}

// Moves the items that belong left to the front and returns their number. The order, in which bounds are
// merged, does not depend on the standard library, as that of std::partition may.
template <typename IsLeft>
std::size_t partitioned(std::span<Item> items, const IsLeft& is_left) {
  std::size_t begin = 0, end = items.size();
  for (;; ++begin) {
    while (begin < end && is_left(items[begin])) ++begin;
    while (begin < end && !is_left(items[end - 1])) --end;
    if (begin == end) return begin;
    std::swap(items[begin], items[--end]);
  }
}

// A node of the binary tree. A leaf is one light.
struct BinaryNode {
  LightBounds bounds;
  std::uint32_t light = kNoLight;
  std::uint32_t right = 0;  // the left child follows its parent
};

class BinaryBuilder {
 public:
  explicit BinaryBuilder(std::vector<Item> items) : items_(std::move(items)), nodes_(2 * items_.size() - 1) {}

  std::vector<BinaryNode> build(int threads) {
    build_top_down(Range{0, 0, items_.size(), 0}, kTaskSize, threads,
                   [this](const Range& range) { return divide(range); });
    add_bounds();
    return std::move(nodes_);
  }

 private:
  struct Range {
    std::size_t size() const { return end - begin; }

    std::size_t node;  // where it is stored
    std::size_t begin, end;
    int depth;
  };

  // Stores the range's node, without the bounds of inner ones, and returns its parts; none of a leaf. A
  // subtree of n lights has 2n - 1 nodes, so node positions do not depend on other tasks.
  std::optional<std::pair<Range, Range>> divide(const Range& range) {
    const auto [node, begin, end, depth] = range;
    if (range.size() == 1) {
      nodes_[node] = {items_[begin].bounds, items_[begin].light};
      return std::nullopt;
    }
    const std::size_t cut = partition(begin, end, depth);
    const std::size_t left = node + 1, right = node + 2 * (cut - begin);
    nodes_[node].right = static_cast<std::uint32_t>(right);
    return std::pair(Range{left, begin, cut, depth + 1}, Range{right, cut, end, depth + 1});
  }

  // Children follow their parents.
  void add_bounds() {
    for (std::size_t node = nodes_.size(); node-- > 0;) {
      if (nodes_[node].light != kNoLight) continue;
      nodes_[node].bounds = nodes_[node + 1].bounds;
      nodes_[node].bounds.include(nodes_[nodes_[node].right].bounds);
    }
  }

  // Reorders the range and returns where its right part begins; neither part is empty.
  std::size_t partition(std::size_t begin, std::size_t end, int depth) {
    const std::size_t half = begin + (end - begin) / 2;
    if (depth >= kMaxHeuristicDepth) return half;
    const auto items = std::span(items_).subspan(begin, end - begin);
    Aabb middles;
    for (const Item& item : items) {
      const Aabb& box = item.bounds.box();
      middles.include(Vec3{middle(box, 0), middle(box, 1), middle(box, 2)});
    }
    const Split split = best_split(items, middles);
    if (split.axis < 0) return half;  // all are at the same position
    const Binning binning(middles, split.axis);
    const std::size_t cut = begin + partitioned(items, [&](const Item& item) {
                              return binning.bin(item) < split.first_right_bin;
                            });
    return cut == begin || cut == end ? half : cut;
  }

  std::vector<Item> items_;
  std::vector<BinaryNode> nodes_;
};

}  // namespace

// Collapses a binary tree.
class LightTreeBuilder {
 public:
  LightTreeBuilder(const std::vector<BinaryNode>& binary, std::uint32_t most_lights) : binary_(binary) {
    tree_.power_ = binary[0].bounds.power();
    tree_.leaves_.assign(most_lights, LightTree::kNoLeaf);
    add_node(0, 0);
  }

  LightTree take() { return std::move(tree_); }

 private:
  // Appends the node for binary node `root` and its subtree. The recursion is at most as deep as the binary
  // tree.
  std::uint32_t add_node(std::uint32_t root, std::uint32_t parent) {
    const auto index = static_cast<std::uint32_t>(tree_.nodes_.size());
    tree_.nodes_.emplace_back().parent = parent;
    std::uint32_t lane = 0;
    for (const std::uint32_t child : children(root)) {
      const BinaryNode& node = binary_[child];
      const auto place = static_cast<std::uint32_t>(index * LightTree::kWidth + lane);
      set_lane(tree_.nodes_[index], lane, node.bounds);
      if (node.light == kNoLight) {
        tree_.nodes_[index].children[lane] = static_cast<std::int32_t>(add_node(child, place));
      } else {
        tree_.nodes_[index].children[lane] = ~static_cast<std::int32_t>(node.light);
        tree_.leaves_[node.light] = place;
      }
      ++lane;
    }
    return index;
  }

  // Up to eight nodes below `root` that contain all its lights. Repeatedly replaces the node of highest
  // cost by its two children. The order of the binary tree is kept, so that neighbours stay neighbours.
  std::vector<std::uint32_t> children(std::uint32_t root) const {
    std::vector<std::uint32_t> chosen{root};
    while (chosen.size() < LightTree::kWidth) {
      auto worst = chosen.end();
      for (auto it = chosen.begin(); it != chosen.end(); ++it)
        if (binary_[*it].light == kNoLight &&
            (worst == chosen.end() || cost(binary_[*it].bounds) > cost(binary_[*worst].bounds)))
          worst = it;
      if (worst == chosen.end()) break;
      const std::uint32_t opened = *worst;
      *worst = opened + 1;
      chosen.insert(worst + 1, binary_[opened].right);
    }
    return chosen;
  }

  // The sphere and cone are enlarged by more than the sum of all roundings.
  void set_lane(LightTree::Node& node, std::size_t lane, const LightBounds& bounds) const {
    constexpr float kPadding = 1e-5f;
    for (int axis = 0; axis < 3; ++axis) {
      node.center[axis][lane] = middle(bounds.box(), axis);
      node.axis[axis][lane] = bounds.normals().axis[axis];
    }
    node.radius2[lane] = static_cast<float>(squared_diagonal(bounds.box()) / 4) * (1 + kPadding);
    node.disk2[lane] = static_cast<float>(bounds.area() / std::numbers::pi);
    const float cos_o = bounds.normals().is_all() ? -1 : std::max(0.0f, bounds.normals().cos_o - kPadding);
    node.cos_o[lane] = cos_o;
    node.sin_o[lane] = std::sqrt(1 - cos_o * cos_o);
    node.cos_e[lane] = bounds.cos_e();
    node.back[lane] = bounds.two_sided() ? -1 : 1;
    node.intensity[lane] = static_cast<float>(bounds.intensity() / tree_.power_);
  }

  const std::vector<BinaryNode>& binary_;
  LightTree tree_;
};

LightTree LightTree::build(std::vector<Item> items, int threads) {
  if (items.empty()) return {};
  std::uint32_t most_lights = 0;
  for (const Item& item : items) most_lights = std::max(most_lights, item.light + 1);
  return LightTreeBuilder(BinaryBuilder(std::move(items)).build(threads), most_lights).take();
}

}  // namespace tessera::core::lights
