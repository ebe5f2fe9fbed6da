// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cache/source_files.hpp"

#include <gtest/gtest.h>

namespace tessera::core::stored {
namespace {

// One file, which somebody saves while it is read.
class ChangingAssets : public AssetSource {
 public:
  Result<std::string> read(const std::string&) override { return contents; }

  std::string contents = "first";
};

TEST(RecordedAssets, NoticesAFileThatChangesBetweenReads) {
  ChangingAssets assets;
  RecordedAssets recorded(assets, 1);
  EXPECT_TRUE(recorded.read("a"));
  EXPECT_TRUE(recorded.read("a"));
  EXPECT_TRUE(recorded.consistent());
  assets.contents = "second";
  EXPECT_TRUE(recorded.read("b"));
  EXPECT_TRUE(recorded.consistent()) << "another file";
  EXPECT_TRUE(recorded.read("a"));
  EXPECT_FALSE(recorded.consistent());
  assets.contents = "first";
  EXPECT_TRUE(recorded.read("a"));
  EXPECT_FALSE(recorded.consistent()) << "for good";
}

}  // namespace
}  // namespace tessera::core::stored
