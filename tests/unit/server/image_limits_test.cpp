// SPDX-License-Identifier: Apache-2.0
// Limits of images that are fetched: their memory, and the stall time of callers.
#include <gtest/gtest.h>

#include <string>
#include <thread>

#include "proto/status.hpp"
#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

using ImageLimits = LimitedService;

TEST_F(ImageLimits, OneIsAlwaysMadeAndTheNextWaitsForItsMemory) {
  start({.image_mib = 1});
  const std::string id = submit_large();
  const auto slow = begin_fetch(id);
  slow->stream->WaitForInitialMetadata();  // it is encoded, but not read
  const auto next = begin_fetch(id);
  EXPECT_TRUE(finish_fetch(*slow).ok());
  EXPECT_TRUE(finish_fetch(*next).ok());
}

TEST_F(ImageLimits, WaitsForMemoryEndWithTheStallTime) {
  start({.image_mib = 1, .stall_time = std::chrono::seconds(2)});
  const std::string id = submit_large();
  const auto slow = begin_fetch(id);
  slow->stream->WaitForInitialMetadata();
  std::jthread reader([&](const std::stop_token& stop) {  // so slow that it takes more than a minute
    v1::GetImageResponse response;
    while (!stop.stop_requested() && slow->stream->Read(&response))
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    slow->context.TryCancel();
  });
  const auto refused = begin_fetch(id);
  const grpc::Status status = finish_fetch(*refused);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(
      status.error_message(),
      "this image takes 4 MiB of memory, and others that are being fetched 4 MiB, and this farm takes at "
      "most 1 MiB (tessera-coordinator --max-image-mib), some of which it keeps for other callers");
  EXPECT_EQ(proto::error_from_grpc(status, refused->context).code, core::ErrorCode::kUnavailable);
}

TEST_F(ImageLimits, ALargeImageComesThroughHoweverManySmallOnesDo) {
  start_with_names({.image_mib = 4});
  const auto ada = as("ada"), ben = as("ben");
  users_ = as("ada");
  const std::string large = submit_large(), small = submit_of_size(600, 400);
  std::jthread others([&](const std::stop_token& stop) {  // there is always one
    auto last = begin_fetch(*ben, small);
    last->stream->WaitForInitialMetadata();
    while (!stop.stop_requested()) {
      auto next = begin_fetch(*ben, small);
      EXPECT_TRUE(finish_fetch(*last).ok());
      next->stream->WaitForInitialMetadata();
      last = std::move(next);
    }
    finish_fetch(*last);
  });
  for (int i = 0; i < 3; ++i) {
    const grpc::Status fetched = finish_fetch(*begin_fetch(*ada, large));
    EXPECT_TRUE(fetched.ok()) << fetched.error_message();
  }
}

TEST_F(ImageLimits, ACancelledWaitForMemoryBlocksNoOther) {
  start({.image_mib = 1});
  const std::string id = submit_large();
  const auto slow = begin_fetch(id);
  slow->stream->WaitForInitialMetadata();
  for (int i = 0; i < 200; ++i) {  // more than may wait at once
    const auto gone = begin_fetch(id);
    gone->context.TryCancel();
    EXPECT_FALSE(finish_fetch(*gone).ok());
  }
  const auto next = begin_fetch(id);
  EXPECT_TRUE(finish_fetch(*slow).ok());
  EXPECT_TRUE(finish_fetch(*next).ok());
}

TEST_F(ImageLimits, AnImageThatIsNotTakenIsEnded) {
  start({.image_mib = 1, .stall_time = std::chrono::seconds(3)});
  const std::string id = submit_large();
  const auto slow = begin_fetch(id);
  slow->stream->WaitForInitialMetadata();
  grpc::StatusCode later;
  do {
    later = finish_fetch(*begin_fetch(id)).error_code();
  } while (later == grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(later, grpc::StatusCode::OK);
  EXPECT_EQ(finish_fetch(*slow).error_code(), grpc::StatusCode::CANCELLED);
}

}  // namespace
}  // namespace tessera::rpc
