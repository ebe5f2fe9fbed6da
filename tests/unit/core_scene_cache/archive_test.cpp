// SPDX-License-Identifier: Apache-2.0
// Sizes in a file are not believed before there is that much to read.
#include "core/scene/cache/archive.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace tessera::core::stored {
namespace {

constexpr Checksum kVersion{1, 2};

// Whether a Value can be read from a file whose index has these numbers.
template <typename Value, typename... Numbers>
bool is_read_from(Numbers... numbers) {
  const TemporaryFolder folder;
  const std::string path = folder.path() / "file";
  auto file = BlockFileWriter::create(path, kVersion, 1).value();
  Writer writer(file);
  (writer(numbers), ...);
  EXPECT_TRUE(file.finish(writer.bytes()));
  auto stored = BlockFileReader::open(path, kVersion, 1).value();
  Reader reader(stored);
  Value value;
  reader(value);
  return reader.complete();
}

template <typename Value>
bool is_read(std::uint64_t size, std::uint32_t rest) {
  return is_read_from<Value>(size, rest);
}

TEST(Archive, RefusesArraysLargerThanTheFile) {
  EXPECT_TRUE(is_read<std::vector<float>>(0, sizeof(float)));
  for (const std::uint64_t size :
       {std::uint64_t{1}, std::uint64_t{1} << 20, std::uint64_t{1} << 62, UINT64_MAX}) {
    EXPECT_FALSE(is_read<std::vector<float>>(size, sizeof(float))) << size;
    EXPECT_FALSE(is_read<accel::HugePageArray<accel::BvhNode>>(size, sizeof(accel::BvhNode))) << size;
    EXPECT_FALSE(is_read<std::string>(size, 1)) << size;
    EXPECT_FALSE(is_read<std::vector<std::string>>(size, 0)) << size;
  }
}

TEST(Archive, RefusesTruthsThatAreNeitherTrueNorFalse) {
  EXPECT_TRUE(is_read_from<bool>(std::uint8_t{0}));
  EXPECT_TRUE(is_read_from<bool>(std::uint8_t{1}));
  EXPECT_FALSE(is_read_from<bool>(std::uint8_t{2}));
  EXPECT_TRUE(is_read_from<std::optional<float>>(std::uint8_t{1}, 0.5f));
  EXPECT_FALSE(is_read_from<std::optional<float>>(std::uint8_t{104}, 0.5f));
}

TEST(Archive, RefusesEnumeratorsThatDoNotExist) {
  EXPECT_TRUE(is_read_from<Integrator>(Integrator::kWhitted));
  EXPECT_FALSE(is_read_from<Integrator>(static_cast<Integrator>(4)));
  EXPECT_FALSE(is_read_from<Integrator>(static_cast<Integrator>(-1)));
}

TEST(Archive, KnowsHowMuchItWillWrite) {
  const std::vector<float> small(10), large(5000);
  constexpr std::uint64_t kSizes = sizeof(std::uint64_t) + sizeof(std::uint32_t);
  EXPECT_EQ(stored_bytes(small), kSizes + 40);
  EXPECT_EQ(stored_bytes(large), kSizes + 20000);
}

}  // namespace
}  // namespace tessera::core::stored
