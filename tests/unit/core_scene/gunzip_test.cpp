// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/gunzip.hpp"

#include <gtest/gtest.h>

namespace tessera::core {
namespace {

constexpr const char kCompressed[] =
    "\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\x03\x2b\xce\xac\x50\xc8\x4f\x53\x28\xc9\x48\x55\x48\x4a"
    "\x2d\x2e\xd1\x51\x28\x46\x15\xe0\x02\x00\xfb\x98\xbc\xd7\x21\x00\x00\x00";
const std::string kGzipFile(kCompressed, sizeof kCompressed - 1);

// 64 KiB of zeros.
constexpr const char kCompressedZeros[] =
    "\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\x03\xed\xc1\x01\x01\x00\x00\x00\x80\x90\xfe\xaf\xee\x08"
    "\x0a\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00"
    "\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00"
    "\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x6a\xeb\x8e\x97\xd7"
    "\x00\x00\x01\x00";
const std::string kZeros(kCompressedZeros, sizeof kCompressedZeros - 1);

TEST(Gunzip, GivesOtherFilesAsTheyAre) {
  std::string content = "unused";
  for (const std::string_view bytes : {"", "\x1f\x8b", "ply\n"}) {
    const auto plain = gunzipped(bytes, content);
    ASSERT_TRUE(plain);
    EXPECT_EQ(plain->data(), bytes.data()) << "nothing is copied";
    EXPECT_EQ(plain->size(), bytes.size());
  }
  EXPECT_EQ(content, "unused");
}

TEST(Gunzip, StoresWhatAFileHolds) {
  std::string content;
  const auto plain = gunzipped(kGzipFile, content);
  ASSERT_TRUE(plain);
  EXPECT_EQ(*plain, "six of the best, six of the best\n");
  EXPECT_EQ(plain->data(), content.data());
}

TEST(Gunzip, StoresAllMembersAndSkipsPadding) {
  std::string content;
  const auto plain = gunzipped(kGzipFile + kGzipFile + std::string(5, '\0'), content);
  ASSERT_TRUE(plain);
  EXPECT_EQ(*plain, "six of the best, six of the best\nsix of the best, six of the best\n");
  EXPECT_EQ(gunzipped(kGzipFile + "more", content).error().message, "is a broken gzip file");
}

TEST(Gunzip, RefusesBrokenFiles) {
  std::string content, damaged = kGzipFile;
  damaged[damaged.size() - 6] ^= 1;
  for (const std::string& broken :
       {kGzipFile.substr(0, 12), kGzipFile.substr(0, 40), std::string(kGzipFile).erase(20, 1), damaged})
    EXPECT_EQ(gunzipped(broken, content).error().message, "is a broken gzip file");
}

TEST(Gunzip, RefusesFilesMadeToExhaustMemory) {
  std::string content;
  EXPECT_EQ(gunzipped(kZeros, content).error().code, ErrorCode::kResourceExhausted);
}

}  // namespace
}  // namespace tessera::core
