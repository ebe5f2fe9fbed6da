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

float voxel(const DenseGrid& grid, std::size_t x, std::size_t y, std::size_t z) {
  return grid.voxels.values.at((z * grid.voxels.size[1] + y) * grid.voxels.size[0] + x);
}

std::string grid_error(const Bytes& grid) {
  const auto dense = dense_grid(grid.bytes, kManyVoxels);
  return dense ? "no error" : dense.error().message;
}

std::string file_error(const std::string& file, const std::string& name = "density") {
  std::string content;
  const auto found = find_nanovdb_grid(file, name, content);
  return found ? *found ? "found" : "nothing" : found.error().message;
}

TEST(NanoVdbGrid, VoxelsAreWhereTheMapPutsThem) {
  const auto grid = dense_grid(Bytes().bytes, kManyVoxels);
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_THAT(grid->voxels.size, ElementsAre(8u, 8u, 8u));
  EXPECT_EQ(voxel(*grid, 1, 2, 3), 321);
  EXPECT_EQ(voxel(*grid, 7, 7, 7), 777);
  // Indices are the centres of voxels.
  EXPECT_THAT(grid->to_world[0], ElementsAre(4, 0, 0, 0.75));
  EXPECT_THAT(grid->to_world[2], ElementsAre(0, 0, 4, 2.75));
}

TEST(NanoVdbGrid, TooManyVoxelsBecomeTheirMeans) {
  const auto grid = dense_grid(Bytes().bytes, 64);
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->reduction, 2u);
  EXPECT_THAT(grid->voxels.size, ElementsAre(4u, 4u, 4u));
  EXPECT_FLOAT_EQ(voxel(*grid, 0, 0, 0), 55.5f);
  EXPECT_FLOAT_EQ(voxel(*grid, 1, 0, 2), 55.5f + 2 + 400);
}

TEST(NanoVdbGrid, NodesWithoutChildrenHaveOneValue) {
  Bytes grid;
  put_bytes(grid.bytes, Bytes::kLowerValues + 8, 2.5f);  // z from 8 to 15
  grid.set_last({7, 7, 11});
  const auto dense = dense_grid(grid.bytes, kManyVoxels);
  ASSERT_TRUE(dense);
  EXPECT_THAT(dense->voxels.size, ElementsAre(8u, 8u, 12u));
  EXPECT_EQ(voxel(*dense, 7, 7, 7), 777);
  EXPECT_EQ(voxel(*dense, 0, 0, 8), 2.5f);
  EXPECT_EQ(voxel(*dense, 7, 7, 11), 2.5f);
}

TEST(NanoVdbGrid, ValuesThatNoMediumHasAre0) {
  Bytes grid;
  put_bytes(grid.bytes, Bytes::kLeafValues, -1.0f);
  put_bytes(grid.bytes, Bytes::kLeafValues + 4, std::numeric_limits<float>::quiet_NaN());
  const auto dense = dense_grid(grid.bytes, kManyVoxels);
  ASSERT_TRUE(dense);
  EXPECT_TRUE(is_sound(dense->voxels));
  EXPECT_EQ(voxel(*dense, 0, 0, 1), 0);
}

TEST(NanoVdbGrid, OtherGridsCanHaveTheSameVoxels) {
  const auto grid = dense_grid(Bytes().bytes, 64);
  ASSERT_TRUE(grid);
  Bytes larger;
  larger.set_last({15, 15, 15});
  const auto same = dense_grid(larger.bytes, *grid);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->voxels.values, grid->voxels.values);
}

TEST(NanoVdbGrid, DamageIsAnError) {
  Bytes doubles;
  put_bytes(doubles.bytes, 636, std::uint32_t{2});
  EXPECT_EQ(grid_error(doubles), "has a grid of other values than 32-bit floats");
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
              HasSubstr("claims to expand more than 1100 times"));
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
