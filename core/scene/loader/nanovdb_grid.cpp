// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/nanovdb_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "core/math/elementary.hpp"
#include "core/scene/loader/bytes_at.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kTreeOffset = 672, kRootTiles = 64, kRootTileBytes = 32;
constexpr std::uint32_t kVersion = 32, kGridOfFloats = 1, kUnknownClass = 0, kFogVolume = 2;
constexpr std::int64_t kMaxCoordinate = 1 << 30;
constexpr float kMaxValue = 1e15f;

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

// The voxels of a box, each of `factor` along each axis.
std::array<std::int64_t, 3> reduced(const IndexBox& box, std::int64_t factor) {
  std::array<std::int64_t, 3> size{};
  for (std::size_t axis = 0; axis < 3; ++axis) size[axis] = (box.side(axis) + factor - 1) / factor;
  return size;
}

// The smallest factor by which a box has at most so many voxels.
std::int64_t reduction_of(const IndexBox& box, std::uint64_t max_voxels) {
  const auto wide = [](std::int64_t count) { return static_cast<double>(count); };
  const double volume = wide(box.side(0)) * wide(box.side(1)) * wide(box.side(2));
  auto factor = std::max<std::int64_t>(
      1, static_cast<std::int64_t>(pow(volume / static_cast<double>(max_voxels), 1.0 / 3)));
  for (;; ++factor) {
    const auto size = reduced(box, factor);
    const bool fits = std::max({size[0], size[1], size[2]}) <= std::int64_t{kMaxGridSide};
    if (fits && wide(size[0]) * wide(size[1]) * wide(size[2]) <= static_cast<double>(max_voxels))
      return factor;
  }
}

// Adds the values of a tree to the voxels of a regular grid.
class TreeReader {
 public:
  TreeReader(std::string_view grid, const GridShape& shape, VoxelGrid& voxels)
      : grid_(grid), shape_(shape), voxels_(voxels) {}

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
    constexpr int kSideLog2 = kUpper.side_log2 + kUpper.count_log2;
    constexpr std::uint64_t kMask = (1u << 21) - 1;
    GridIndex origin{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto bits = static_cast<std::uint32_t>(*key >> (42 - 21 * axis) & kMask);
      origin[axis] = static_cast<std::int32_t>(bits << kSideLog2);
    }
    if (!origins_.insert(origin).second) return broken_grid("a part of space appears twice");
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
    value = std::min(value, kMaxValue);
    IndexBox part;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      part.min[axis] = std::max(origin[axis], shape_.box.min[axis]) - shape_.box.min[axis];
      part.max[axis] = std::min(origin[axis] + (std::int64_t{1} << side_log2), shape_.box.max[axis]) -
                       shape_.box.min[axis];
      if (part.side(axis) <= 0) return;
    }
    const auto factor = std::int64_t{shape_.reduction};
    const auto overlap = [&](std::size_t axis, std::int64_t voxel) {
      return static_cast<float>(std::min(part.max[axis], (voxel + 1) * factor) -
                                std::max(part.min[axis], voxel * factor)) /
             static_cast<float>(factor);
    };
    const auto& size = shape_.size;
    for (std::int64_t z = part.min[2] / factor; z * factor < part.max[2]; ++z)
      for (std::int64_t y = part.min[1] / factor; y * factor < part.max[1]; ++y)
        for (std::int64_t x = part.min[0] / factor; x * factor < part.max[0]; ++x) {
          const auto voxel = static_cast<std::size_t>((z * size[1] + y) * size[0] + x);
          voxels_.values[voxel] += value * overlap(0, x) * overlap(1, y) * overlap(2, z);
        }
  }

  std::string_view grid_;
  const GridShape& shape_;
  VoxelGrid& voxels_;
  std::set<GridIndex> origins_;            // of the parts of the table
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
Status place_grid(std::string_view grid, GridShape& shape) {
  constexpr std::size_t kMatrix = 296 + 88, kTranslation = 296 + 232;
  for (std::size_t row = 0; row < 3; ++row) {
    double offset = *bytes_at<double>(grid, kTranslation + 8 * row);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double step = *bytes_at<double>(grid, kMatrix + 8 * (3 * row + axis));
      offset += step * (static_cast<double>(shape.box.min[axis]) - 0.5);
      shape.to_world[row][axis] = step * static_cast<double>(shape.size[axis]) * shape.reduction;
    }
    shape.to_world[row][3] = offset;
    for (const double entry : shape.to_world[row])
      if (!std::isfinite(entry)) return broken_grid("its map is not finite");
  }
  return {};
}

// Where the root is.
Result<std::size_t> root_of(std::string_view grid) {
  if (!grid.starts_with("NanoVDB") || grid.size() < kTreeOffset + 64) return broken_grid("it has no header");
  const std::uint32_t version = *bytes_at<std::uint32_t>(grid, 16) >> 21;
  const auto has_no = [](std::string what) { return fail(ErrorCode::kInvalidArgument, std::move(what)); };
  if (version != kVersion)
    return has_no(fmt::format("has a grid of version {}; only version {} is read", version, kVersion));
  if (*bytes_at<std::uint32_t>(grid, 636) != kGridOfFloats)
    return has_no("has a grid of other values than 32-bit floats");
  const std::uint32_t grid_class = *bytes_at<std::uint32_t>(grid, 632);
  if (grid_class != kUnknownClass && grid_class != kFogVolume)
    return has_no("has a grid that is no fog volume");
  return kTreeOffset + static_cast<std::size_t>(*bytes_at<std::uint64_t>(grid, kTreeOffset + 24));
}

}  // namespace

Result<GridShape> shape_of(std::string_view grid, std::uint64_t max_voxels) {
  const auto root = root_of(grid);
  if (!root) return fail(root.error());
  const auto box = index_box(grid, *root);
  if (!box) return fail(box.error());
  GridShape shape{.box = *box};
  const std::int64_t factor = reduction_of(*box, max_voxels);
  const auto size = reduced(*box, factor);
  shape.reduction = static_cast<std::uint32_t>(factor);
  for (std::size_t axis = 0; axis < 3; ++axis) shape.size[axis] = static_cast<std::uint32_t>(size[axis]);
  if (auto placed = place_grid(grid, shape); !placed) return fail(placed.error());
  return shape;
}

Result<VoxelGrid> voxels_of(std::string_view grid, const GridShape& shape) {
  const auto root = root_of(grid);
  if (!root) return fail(root.error());
  VoxelGrid voxels{.size = shape.size, .border = GridBorder::kZero};
  voxels.values.assign(voxels.voxel_count(), 0);
  if (auto read = TreeReader(grid, shape, voxels).read(*root); !read) return fail(read.error());
  return voxels;
}

}  // namespace tessera::core
