// SPDX-License-Identifier: Apache-2.0
// Files of NanoVDB and their grids.
#include <gmock/gmock.h>
#include <libdeflate.h>

#include "core/scene/loader/nanovdb_file.hpp"
#include "core/scene/loader/nanovdb_grid.hpp"
#include "tests/support/nanovdb_bytes.hpp"

namespace tessera::core::test {
namespace {

using Bytes = NanoVdbGridBytes;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::uint64_t kManyVoxels = 1u << 24;

struct Read {
  GridShape shape;
  VoxelGrid voxels;

  float at(std::size_t x, std::size_t y, std::size_t z) const {
    return voxels.values.at((z * voxels.size[1] + y) * voxels.size[0] + x);
  }
};

Result<Read> read(const Bytes& grid, std::uint64_t max_voxels = kManyVoxels) {
  const auto shape = shape_of(grid.bytes, max_voxels);
  if (!shape) return fail(shape.error());
  auto voxels = voxels_of(grid.bytes, *shape);
  if (!voxels) return fail(voxels.error());
  return Read{*shape, *std::move(voxels)};
}

std::string grid_error(const Bytes& grid) {
  const auto voxels = read(grid);
  return voxels ? "no error" : voxels.error().message;
}

std::string file_error(const std::string& file, const std::string& name = "density") {
  std::string content;
  const auto found = find_nanovdb_grid(file, name, content);
  return found ? *found ? "found" : "nothing" : found.error().message;
}

TEST(NanoVdbGrid, VoxelsAreWhereTheMapPutsThem) {
  const auto grid = read({});
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_THAT(grid->voxels.size, ElementsAre(8u, 8u, 8u));
  EXPECT_EQ(grid->at(1, 2, 3), 321);
  EXPECT_EQ(grid->at(7, 7, 7), 777);
  // Indices are the centres of voxels.
  EXPECT_THAT(grid->shape.to_world[0], ElementsAre(4, 0, 0, 0.75));
  EXPECT_THAT(grid->shape.to_world[2], ElementsAre(0, 0, 4, 2.75));
}

TEST(NanoVdbGrid, TooManyVoxelsBecomeTheirMeans) {
  const auto grid = read({}, 64);
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->shape.reduction, 2u);
  EXPECT_THAT(grid->voxels.size, ElementsAre(4u, 4u, 4u));
  EXPECT_FLOAT_EQ(grid->at(0, 0, 0), 55.5f);
  EXPECT_FLOAT_EQ(grid->at(1, 0, 2), 55.5f + 2 + 400);
}

// The last voxels reach beyond the box, where there is nothing.
TEST(NanoVdbGrid, MeansIncludeWhatIsBeyondTheBox) {
  const auto grid = read({}, 27);
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->shape.reduction, 3u);
  EXPECT_THAT(grid->voxels.size, ElementsAre(3u, 3u, 3u));
  EXPECT_FLOAT_EQ(grid->at(0, 0, 0), 111);
  EXPECT_FLOAT_EQ(grid->at(2, 0, 0), (6.5f + 110) * 2 / 3);
  EXPECT_THAT(grid->shape.to_world[0], ElementsAre(4.5, 0, 0, 0.75));
}

TEST(NanoVdbGrid, LargeBoxesAreReducedAtOnce) {
  Bytes grid;
  grid.set_last({1 << 29, 1 << 29, 0});
  const auto shape = shape_of(grid.bytes, kManyVoxels);
  ASSERT_TRUE(shape);
  EXPECT_LE(shape->voxel_count(), kManyVoxels);
  EXPECT_GT(shape->voxel_count(), kManyVoxels / 2);
}

TEST(NanoVdbGrid, NodesWithoutChildrenHaveOneValue) {
  Bytes bytes;
  put_bytes(bytes.bytes, Bytes::kLowerValues + 8, 2.5f);  // z from 8 to 15
  bytes.set_last({7, 7, 11});
  const auto grid = read(bytes);
  ASSERT_TRUE(grid);
  EXPECT_THAT(grid->voxels.size, ElementsAre(8u, 8u, 12u));
  EXPECT_EQ(grid->at(7, 7, 7), 777);
  EXPECT_EQ(grid->at(0, 0, 8), 2.5f);
  EXPECT_EQ(grid->at(7, 7, 11), 2.5f);
}

TEST(NanoVdbGrid, ValuesThatNoMediumHasAreLimited) {
  Bytes bytes;
  put_bytes(bytes.bytes, Bytes::kLeafValues, -1.0f);
  put_bytes(bytes.bytes, Bytes::kLeafValues + 4, std::numeric_limits<float>::quiet_NaN());
  put_bytes(bytes.bytes, Bytes::kLeafValues + 8, 1e30f);
  const auto grid = read(bytes);
  ASSERT_TRUE(grid);
  EXPECT_TRUE(is_sound(grid->voxels));
  EXPECT_EQ(grid->at(0, 0, 0), 0);
  EXPECT_EQ(grid->at(0, 0, 1), 0);
  EXPECT_EQ(grid->at(0, 0, 2), 1e15f);
}

TEST(NanoVdbGrid, OtherGridsCanHaveTheSameVoxels) {
  const auto shape = shape_of(Bytes().bytes, 64);
  ASSERT_TRUE(shape);
  Bytes other;
  put_bytes(other.bytes, Bytes::kRoot, std::int32_t{-8});
  other.set_last({15, 15, 15});
  const auto same = voxels_of(other.bytes, *shape);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->values, read({}, 64)->voxels.values);
}

TEST(NanoVdbGrid, WhatIsNoFogVolumeIsRefused) {
  Bytes doubles, level_set, old;
  put_bytes(doubles.bytes, 636, std::uint32_t{2});
  EXPECT_EQ(grid_error(doubles), "has a grid of other values than 32-bit floats");
  put_bytes(level_set.bytes, 632, std::uint32_t{1});
  EXPECT_EQ(grid_error(level_set), "has a grid that is no fog volume");
  put_bytes(old.bytes, 16, std::uint32_t{29} << 21);
  EXPECT_EQ(grid_error(old), "has a grid of version 29; only version 32 is read");
}

// Two entries of the table whose keys differ in a bit that no index has.
TEST(NanoVdbGrid, PartsOfSpaceDoNotAppearTwice) {
  Bytes grid;
  std::string& bytes = grid.bytes;
  constexpr std::size_t kTable = Bytes::kRoot + 64;
  for (const std::size_t offset : {std::size_t{0}, std::size_t{32}}) {
    put_bytes(bytes, kTable + offset, std::uint64_t{offset} << 15);
    put_bytes(bytes, kTable + offset + 8, std::int64_t{0});
    put_bytes(bytes, kTable + offset + 16, std::uint32_t{1});
    put_bytes(bytes, kTable + offset + 20, 1.0f);
  }
  put_bytes(bytes, Bytes::kRoot + 24, std::uint32_t{1});
  EXPECT_EQ(grid_error(grid), "no error");
  put_bytes(bytes, Bytes::kRoot + 24, std::uint32_t{2});
  EXPECT_EQ(grid_error(grid), "has a broken grid: a part of space appears twice");
}

TEST(NanoVdbGrid, DamageIsAnError) {
  Bytes shared;
  shared.bytes[Bytes::kLowerMask] = 3;
  put_bytes(shared.bytes, Bytes::kLowerValues + 8, std::int64_t{Bytes::kLeaf - Bytes::kLower});
  shared.bytes[Bytes::kUpper + 4128] = 3;
  put_bytes(shared.bytes, Bytes::kUpper + 8256 + 8, std::int64_t{Bytes::kLower - Bytes::kUpper});
  for (std::size_t i = 0; i < 200; ++i) {
    shared.bytes[Bytes::kLowerMask + i / 8] |= static_cast<char>(1 << i % 8);
    put_bytes(shared.bytes, Bytes::kLowerValues + 8 * i, std::int64_t{Bytes::kLeaf - Bytes::kLower});
  }
  EXPECT_EQ(grid_error(shared), "has a broken grid: nodes have several parents");
  Bytes far;
  put_bytes(far.bytes, Bytes::kRoot + 64 + 8, std::int64_t{1} << 40);
  EXPECT_EQ(grid_error(far), "has a broken grid: a node is beyond its end");
  Bytes empty;
  empty.set_last({-1, 7, 7});
  EXPECT_EQ(grid_error(empty), "has a grid without voxels");
  for (const std::size_t size : {std::size_t{0}, std::size_t{700}, Bytes::kRoot + 20, Bytes::kLeaf + 2143}) {
    Bytes cut;
    cut.bytes.resize(size);
    EXPECT_THAT(grid_error(cut), HasSubstr("has a broken grid")) << size;
  }
}

TEST(NanoVdbFile, GridsAreFoundByName) {
  const std::string grid = Bytes().bytes;
  const std::string file = nanovdb_file("heat", "other", 5) + nanovdb_file("density", grid, grid.size());
  std::string content;
  const auto found = find_nanovdb_grid(file, "density", content);
  ASSERT_TRUE(found && *found);
  EXPECT_EQ(**found, grid);
  EXPECT_EQ(file_error(file, "flames"), "nothing");
}

TEST(NanoVdbFile, GridsAreDecompressed) {
  const std::string grid = Bytes().bytes;
  std::string packed(8 + grid.size(), '\0');
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(6);
  const std::size_t size =
      libdeflate_zlib_compress(compressor, grid.data(), grid.size(), packed.data() + 8, packed.size() - 8);
  libdeflate_free_compressor(compressor);
  packed.resize(8 + size);
  put_bytes(packed, 0, std::uint64_t{size});
  std::string content;
  const auto found = find_nanovdb_grid(nanovdb_file("density", packed, grid.size(), 1), "density", content);
  ASSERT_TRUE(found && *found);
  EXPECT_EQ(**found, grid);
  EXPECT_THAT(file_error(nanovdb_file("density", packed, grid.size() + 1, 1)), HasSubstr("are damaged"));
  EXPECT_THAT(file_error(nanovdb_file("density", packed, std::size_t{1} << 40, 1)),
              HasSubstr("claims to expand more than 1100 times, or"));
}

TEST(NanoVdbFile, DamageIsAnError) {
  const std::string file = nanovdb_file("density", "values", 6);
  EXPECT_EQ(file_error("VDB"), "is a broken NanoVDB file: it does not begin with \"NanoVDB\"");
  EXPECT_EQ(file_error(file.substr(0, 20)), "is a broken NanoVDB file: the list of its grids is cut short");
  EXPECT_EQ(file_error(file.substr(0, file.size() - 1)), "is a broken NanoVDB file: a grid is cut short");
  EXPECT_EQ(file_error(nanovdb_file("density", "values", 6, 2)), "is compressed by BLOSC, which is not read");
}

}  // namespace
}  // namespace tessera::core::test
