// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/nanovdb_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "core/scene/loader/bytes_at.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kTreeOffset = 672, kRootTiles = 64, kRootTileBytes = 32;
constexpr std::uint32_t kGridOfFloats = 1;
constexpr std::int64_t kMaxCoordinate = 1 << 30;

// A level of nodes: where its parts are, and how it divides space.
struct NodeLevel {
  std::size_t bytes, child_mask, values;
  int side_log2;   // of its children or voxels, in voxels
  int count_log2;  // of its children or voxels along an axis
};
constexpr NodeLevel kUpper{270400, 4128, 8256, 7, 5}, kLower{33856, 544, 1088, 3, 4},
    kLeaf{2144, 0, 96, 0, 3};

using GridIndex = std::array<std::int64_t, 3>;

tl::unexpected<Error> broken_grid(std::string_view what) {
  return fail(ErrorCode::kInvalidArgument, fmt::format("has a broken grid: {}", what));
}

// The smallest factor by which a box has at most so many voxels.
std::uint32_t reduction_of(const IndexBox& box, std::uint64_t max_voxels) {
  for (std::int64_t factor = 1;; ++factor) {
    double voxels = 1;
    bool fits = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t side = (box.side(axis) + factor - 1) / factor;
      voxels *= static_cast<double>(side);
      fits &= side <= std::int64_t{kMaxGridSide};
    }
    if (fits && voxels <= static_cast<double>(max_voxels)) return static_cast<std::uint32_t>(factor);
  }
}

// Adds the values of a tree to the voxels of a regular grid.
class TreeReader {
 public:
  TreeReader(std::string_view grid, DenseGrid& dense) : grid_(grid), box_(dense.box), dense_(dense) {}

  Status read(std::size_t root) {
    const auto tiles = bytes_at<std::uint32_t>(grid_, root + 24);
    if (!tiles || *tiles > grid_.size() / kRootTileBytes) return broken_grid("it has no table");
    for (std::uint32_t i = 0; i < *tiles; ++i)
      if (auto done = read_tile(root, root + kRootTiles + i * kRootTileBytes); !done) return done;
    return {};
  }

 private:
  Status read_tile(std::size_t root, std::size_t tile) {
    const auto key = bytes_at<std::uint64_t>(grid_, tile);
    const auto child = bytes_at<std::int64_t>(grid_, tile + 8);
    const auto value = bytes_at<float>(grid_, tile + 20);
    if (!value) return broken_grid("its table is cut short");
    if (!keys_.insert(*key).second) return broken_grid("a part of space appears twice");
    constexpr int kSideLog2 = kUpper.side_log2 + kUpper.count_log2;
    constexpr std::uint64_t kMask = (1u << 21) - 1;
    GridIndex origin{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto bits = static_cast<std::uint32_t>(*key >> (42 - 21 * axis) & kMask);
      origin[axis] = static_cast<std::int32_t>(bits << kSideLog2);
    }
    if (*child == 0) return fill(origin, kSideLog2, *value), Status();
    return read_node(root + static_cast<std::size_t>(*child), kUpper, origin);
  }

  // A node that is damaged so that several parents share it costs no more than one that is not.
  Status count(const NodeLevel& level) {
    std::uint64_t& counted = counts_[static_cast<std::size_t>(level.count_log2)];
    if (++counted > grid_.size() / level.bytes) return broken_grid("nodes have several parents");
    return {};
  }

  Status read_node(std::size_t node, const NodeLevel& level, const GridIndex& origin) {
    if (node > grid_.size() || grid_.size() - node < level.bytes)
      return broken_grid("a node is beyond its end");
    if (auto counted = count(level); !counted) return counted;
    const std::size_t children = std::size_t{1} << 3 * level.count_log2;
    for (std::size_t i = 0; i < children; ++i) {
      const GridIndex place = child_origin(origin, level, i);
      const bool is_child = level.child_mask != 0 &&
                            (*bytes_at<std::uint8_t>(grid_, node + level.child_mask + i / 8) >> i % 8 & 1);
      const std::size_t entry = node + level.values + i * (level.child_mask != 0 ? 8 : 4);
      if (is_child) {
        const auto child = node + static_cast<std::size_t>(*bytes_at<std::int64_t>(grid_, entry));
        if (auto done = read_node(child, level.side_log2 == kUpper.side_log2 ? kLower : kLeaf, place); !done)
          return done;
      } else {
        fill(place, level.side_log2, *bytes_at<float>(grid_, entry));
      }
    }
    return {};
  }

  static GridIndex child_origin(const GridIndex& origin, const NodeLevel& level, std::size_t i) {
    const std::size_t mask = (std::size_t{1} << level.count_log2) - 1;
    GridIndex place = origin;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t along = i >> (2 - axis) * static_cast<std::size_t>(level.count_log2) & mask;
      place[axis] += static_cast<std::int64_t>(along << level.side_log2);
    }
    return place;
  }

  // Adds `value` to the voxels that a cube overlaps, by its share of each.
  void fill(const GridIndex& origin, int side_log2, float value) {
    if (!std::isfinite(value) || value <= 0) return;
    IndexBox part;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      part.min[axis] = std::max(origin[axis], box_.min[axis]) - box_.min[axis];
      part.max[axis] =
          std::min(origin[axis] + (std::int64_t{1} << side_log2), box_.max[axis]) - box_.min[axis];
      if (part.side(axis) <= 0) return;
    }
    const auto factor = std::int64_t{dense_.reduction};
    const auto overlap = [&](std::size_t axis, std::int64_t voxel) {
      return static_cast<float>(std::min(part.max[axis], (voxel + 1) * factor) -
                                std::max(part.min[axis], voxel * factor)) /
             static_cast<float>(factor);
    };
    const auto& size = dense_.voxels.size;
    for (std::int64_t z = part.min[2] / factor; z * factor < part.max[2]; ++z)
      for (std::int64_t y = part.min[1] / factor; y * factor < part.max[1]; ++y)
        for (std::int64_t x = part.min[0] / factor; x * factor < part.max[0]; ++x) {
          const auto voxel = static_cast<std::size_t>((z * size[1] + y) * size[0] + x);
          dense_.voxels.values[voxel] += value * overlap(0, x) * overlap(1, y) * overlap(2, z);
        }
  }

  std::string_view grid_;
  IndexBox box_;
  DenseGrid& dense_;
  std::set<std::uint64_t> keys_;
  std::array<std::uint64_t, 6> counts_{};  // of nodes, by count_log2
};

Result<IndexBox> index_box(std::string_view grid, std::size_t root) {
  IndexBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto min = bytes_at<std::int32_t>(grid, root + 4 * axis);
    const auto max = bytes_at<std::int32_t>(grid, root + 12 + 4 * axis);
    if (!min || !max) return broken_grid("it has no root");
    box.min[axis] = *min;
    box.max[axis] = std::int64_t{*max} + 1;
    if (box.side(axis) <= 0) return fail(ErrorCode::kInvalidArgument, "has a grid without voxels");
    if (box.min[axis] < -kMaxCoordinate || box.max[axis] > kMaxCoordinate)
      return broken_grid("its bounds are beyond all bounds");
  }
  return box;
}

// The map of the file takes indices, which are the centres of voxels, to space.
Status place_grid(std::string_view grid, const IndexBox& box, DenseGrid& dense) {
  constexpr std::size_t kMatrix = 296 + 88, kTranslation = 296 + 232;
  for (std::size_t row = 0; row < 3; ++row) {
    double offset = *bytes_at<double>(grid, kTranslation + 8 * row);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double step = *bytes_at<double>(grid, kMatrix + 8 * (3 * row + axis));
      offset += step * (static_cast<double>(box.min[axis]) - 0.5);
      dense.to_world[row][axis] = step * static_cast<double>(dense.voxels.size[axis]) * dense.reduction;
      if (!std::isfinite(dense.to_world[row][axis])) return broken_grid("its map is not finite");
    }
    dense.to_world[row][3] = offset;
    if (!std::isfinite(offset)) return broken_grid("its map is not finite");
  }
  return {};
}

// Where the root is.
Result<std::size_t> root_of(std::string_view grid) {
  if (!grid.starts_with("NanoVDB") || grid.size() < kTreeOffset + 64) return broken_grid("it has no header");
  if (*bytes_at<std::uint32_t>(grid, 636) != kGridOfFloats)
    return fail(ErrorCode::kInvalidArgument, "has a grid of other values than 32-bit floats");
  return kTreeOffset + static_cast<std::size_t>(*bytes_at<std::uint64_t>(grid, kTreeOffset + 24));
}

}  // namespace

Result<DenseGrid> dense_grid(std::string_view grid, std::uint64_t max_voxels) {
  const auto root = root_of(grid);
  if (!root) return fail(root.error());
  const auto box = index_box(grid, *root);
  if (!box) return fail(box.error());
  DenseGrid shape;
  shape.box = *box;
  shape.reduction = reduction_of(*box, max_voxels);
  for (std::size_t axis = 0; axis < 3; ++axis)
    shape.voxels.size[axis] =
        static_cast<std::uint32_t>((box->side(axis) + shape.reduction - 1) / shape.reduction);
  shape.voxels.border = GridBorder::kZero;
  if (auto placed = place_grid(grid, *box, shape); !placed) return fail(placed.error());
  return dense_grid(grid, shape);
}

Result<DenseGrid> dense_grid(std::string_view grid, const DenseGrid& other) {
  const auto root = root_of(grid);
  if (!root) return fail(root.error());
  DenseGrid dense = other;
  dense.voxels.values.assign(dense.voxels.voxel_count(), 0);
  if (auto read = TreeReader(grid, dense).read(*root); !read) return fail(read.error());
  return dense;
}

}  // namespace tessera::core
