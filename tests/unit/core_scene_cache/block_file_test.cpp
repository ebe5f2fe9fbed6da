// SPDX-License-Identifier: Apache-2.0
// What was written comes back, and nothing else is ever taken for it.
#include "core/scene/cache/block_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "tests/support/temporary_folder.hpp"

namespace tessera::core {
namespace {

using Bytes = std::vector<std::byte>;

constexpr Checksum kVersion{7, 8};

Bytes numbered_bytes(std::size_t size, unsigned first) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>((first + i * i / 3) & 0xff);
  return bytes;
}

class BlockFile : public testing::Test {
 protected:
  std::string path() const { return folder_.path() / "file"; }

  void write(const std::vector<Bytes>& blocks, const Bytes& index) const {
    auto writer = BlockFileWriter::create(path(), kVersion, 2).value();
    for (const Bytes& block : blocks) writer.write_block(block);
    ASSERT_TRUE(writer.finish(index));
  }

  // Whether the file is taken for one of these blocks and this index.
  bool holds(const std::vector<Bytes>& blocks, const Bytes& index, int threads = 1) const {
    auto reader = BlockFileReader::open(path(), kVersion, threads);
    if (!reader || !std::ranges::equal(reader->index(), index)) return false;
    return std::ranges::all_of(blocks, [&](const Bytes& block) {
      Bytes read(block.size());
      return reader->read_block(read) && read == block;
    });
  }

  TemporaryFolder folder_;
};

TEST_F(BlockFile, GivesBackWhatWasWritten) {
  // Pieces of 4 MiB: none, one, several, and borders.
  const std::vector<Bytes> blocks{numbered_bytes(0, 1), numbered_bytes(1, 2), numbered_bytes(4u << 20, 3),
                                  numbered_bytes((9u << 20) + 5, 4)};
  const Bytes index = numbered_bytes(100, 5);
  write(blocks, index);
  EXPECT_TRUE(holds(blocks, index, 3));
}

// Opening one waits for a writer, for ever.
TEST_F(BlockFile, IsRefusedWhereAFifoIsInItsPlace) {
  ASSERT_EQ(::mkfifo(path().c_str(), 0600), 0);
  ::alarm(20);
  EXPECT_FALSE(BlockFileReader::open(path(), kVersion, 1));
  ::alarm(0);
}

TEST_F(BlockFile, IsRefusedWithAnyByteChangedOrMissing) {
  const std::vector<Bytes> blocks{numbered_bytes(200, 1), numbered_bytes(33, 2)};
  const Bytes index = numbered_bytes(20, 3);
  write(blocks, index);
  const std::string good = read_file(path());
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ (1 << i % 8));
    write_file(path(), bad);
    EXPECT_FALSE(holds(blocks, index)) << "changed at " << i;
    write_file(path(), good.substr(0, i));
    EXPECT_FALSE(holds(blocks, index)) << "cut at " << i;
  }
  write_file(path(), good + "x");
  EXPECT_FALSE(holds(blocks, index)) << "longer";
  write_file(path(), good);
  EXPECT_TRUE(holds(blocks, index));
}

TEST_F(BlockFile, OfAnotherVersionIsRefused) {
  write({}, {});
  const auto reader = BlockFileReader::open(path(), {8, 7}, 1);
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.error().message, path() + " is of another version");
}

// The header's fields and its checksum, as they lie in the file.
constexpr std::size_t kBlocksEnd = 32, kPieceCount = 40, kHeaderChecksum = 72;

TEST_F(BlockFile, RefusesAHeaderThatExceedsTheFile) {
  write({numbered_bytes(200, 1)}, numbered_bytes(20, 3));
  const std::string good = read_file(path());
  for (const std::size_t field : {kBlocksEnd, kPieceCount}) {
    for (const std::uint64_t value : {std::uint64_t{0}, std::uint64_t{71}, std::uint64_t{good.size() + 1},
                                      std::uint64_t{1} << 60, UINT64_MAX}) {
      if (field == kPieceCount && value == 0) continue;  // all of what follows is then the index
      std::string bad = good;
      std::memcpy(bad.data() + field, &value, sizeof(value));
      const Checksum right = checksum_of(std::as_bytes(std::span(bad)).first(kHeaderChecksum));
      std::memcpy(bad.data() + kHeaderChecksum, &right, sizeof(right));
      write_file(path(), bad);
      const auto reader = BlockFileReader::open(path(), kVersion, 1);
      ASSERT_FALSE(reader) << field << " " << value;
      EXPECT_EQ(reader.error().message, path() + " is damaged");
    }
  }
}

TEST_F(BlockFile, IsThereOnlyWhenItIsComplete) {
  {
    auto writer = BlockFileWriter::create(path(), kVersion, 1).value();
    writer.write_block(numbered_bytes(10000, 1));
    EXPECT_EQ(BlockFileReader::open(path(), kVersion, 1).error().code, ErrorCode::kNotFound);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path())) << "nothing is left behind";
}

TEST_F(BlockFile, HasItsSizeBeforeItIsWritten) {
  const Bytes block = numbered_bytes(1000, 1);
  for (const std::uint64_t reserved : {1u, 500u, 1u << 20}) {
    auto writer = BlockFileWriter::create(path(), kVersion, 1).value();
    writer.reserve(reserved);
    const auto partial = std::filesystem::directory_iterator(folder_.path())->path();
    EXPECT_GE(std::filesystem::file_size(partial), reserved);
    writer.write_block(block);
    ASSERT_TRUE(writer.finish({}));
    EXPECT_TRUE(holds({block}, {})) << reserved;
    EXPECT_LT(std::filesystem::file_size(path()), 2 * block.size());
    std::filesystem::remove(path());
  }
}

TEST_F(BlockFile, CanHaveNoNameOfItsOwn) {
  const Bytes block = numbered_bytes(10000, 1), index = numbered_bytes(20, 2);
  const auto open = [&] { return OpenFile(::open(path().c_str(), O_RDWR | O_CREAT, 0600)); };
  {
    auto abandoned = BlockFileWriter::to(open(), "it", kVersion, 1);
    abandoned.write_block(block);
  }
  EXPECT_EQ(BlockFileReader::of(open(), "it", kVersion, 1).error().message, "it is of another version");
  auto writer = BlockFileWriter::to(open(), "it", kVersion, 1);
  writer.write_block(block);
  ASSERT_TRUE(writer.finish(index));
  EXPECT_TRUE(holds({block}, index));
  EXPECT_TRUE(BlockFileReader::of(open(), "it", kVersion, 1));
}

TEST_F(BlockFile, SaysWhyItCannotBeWritten) {
  const auto writer = BlockFileWriter::create(folder_.path() / "missing" / "file", kVersion, 1);
  ASSERT_FALSE(writer);
  EXPECT_NE(writer.error().message.find("No such file or directory"), std::string::npos);
}

}  // namespace
}  // namespace tessera::core
