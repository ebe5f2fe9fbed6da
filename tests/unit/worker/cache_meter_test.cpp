// SPDX-License-Identifier: Apache-2.0
#include "worker/cache_meter.hpp"

#include <gtest/gtest.h>

#include <string>

#include "proto/blob.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::worker {
namespace {

TEST(CacheMeter, MeasuresEveryFewSeconds) {
  const TemporaryFolder folder;
  const auto cache = BlobCache::open(folder.path(), 5000);
  ASSERT_TRUE(cache) << cache.error().message;
  CacheMeter meter(*cache);
  const CacheMeter::Clock::time_point start{};
  EXPECT_EQ(meter.read(start).used_bytes(), 0u);
  EXPECT_EQ(meter.read(start).limit_bytes(), 5000u);
  write_file(folder.path() / proto::digest_of("abc").hex(), "abc");
  write_file(folder.path() / "notes", "of somebody else");
  EXPECT_EQ(meter.read(start + CacheMeter::kInterval / 2).used_bytes(), 0u);
  EXPECT_EQ(meter.read(start + CacheMeter::kInterval).used_bytes(), 3u);
}

}  // namespace
}  // namespace tessera::worker
