// SPDX-License-Identifier: Apache-2.0
#include "proto/blob.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace tessera::proto {
namespace {

using core::ErrorCode;
using ::testing::HasSubstr;

std::string pattern(std::size_t size) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 31 + i / 251);
  return bytes;
}

std::vector<v1::BlobChunk> chunks_of(const std::string& bytes) {
  std::vector<v1::BlobChunk> chunks;
  for_each_chunk(digest_of(bytes), bytes, [&](const v1::BlobChunk& chunk) {
    chunks.push_back(chunk);
    return true;
  });
  return chunks;
}

core::Result<Digest> receive(BlobReceiver& receiver, const std::vector<v1::BlobChunk>& chunks) {
  for (const v1::BlobChunk& chunk : chunks)
    if (const core::Status taken = receiver.accept(chunk); !taken) return core::fail(taken.error());
  return receiver.finish();
}

// FIPS 180-2, appendix B.
TEST(Digest, IsSha256) {
  EXPECT_EQ(digest_of("abc").hex(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(digest_of("").hex(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(digest_of("abc").size_bytes, 3u);
}

TEST(Digest, TravelsAndIsChecked) {
  const Digest digest = digest_of("abc");
  EXPECT_EQ(from_proto(to_proto(digest)).value(), digest);
  v1::Digest short_digest = to_proto(digest);
  short_digest.mutable_sha256()->pop_back();
  ASSERT_FALSE(from_proto(short_digest).has_value());
  EXPECT_EQ(from_proto(short_digest).error().message, "digest.sha256: must be 32 bytes, got 31");
}

TEST(Hasher, DoesNotSeeHowBytesWereCut) {
  const std::string bytes = pattern(100'000);
  Hasher hasher;
  for (std::size_t begin = 0, step = 1; begin < bytes.size(); begin += step, step = step * 3 % 4093)
    hasher.update(std::string_view(bytes).substr(begin, step));
  EXPECT_EQ(hasher.finish(), digest_of(bytes));
}

TEST(Chunks, PutTogetherAreTheBlob) {
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, kChunkBytes, kChunkBytes + 1, 3 * kChunkBytes}) {
    const std::string bytes = pattern(size);
    const auto chunks = chunks_of(bytes);
    EXPECT_EQ(chunks.size(), std::max<std::size_t>(1, (size + kChunkBytes - 1) / kChunkBytes));
    std::string received;
    BlobReceiver receiver([&](std::string_view piece) {
      received += piece;
      return core::Status{};
    });
    const auto digest = receive(receiver, chunks);
    ASSERT_TRUE(digest.has_value()) << digest.error().message;
    EXPECT_EQ(*digest, digest_of(bytes));
    EXPECT_EQ(received, bytes);
  }
}

TEST(Chunks, StopWhenTheReceiverDisconnects) {
  const std::string bytes = pattern(3 * kChunkBytes);
  int sent = 0;
  EXPECT_FALSE(for_each_chunk(digest_of(bytes), bytes, [&](const v1::BlobChunk&) { return ++sent < 2; }));
  EXPECT_EQ(sent, 2);
}

class BlobReceiverTest : public ::testing::Test {
 protected:
  void expect_refused(const std::vector<v1::BlobChunk>& chunks, ErrorCode code, const std::string& reason) {
    std::size_t kept = 0;
    BlobReceiver receiver(digest_of(bytes_), [&](std::string_view piece) {
      kept += piece.size();
      return core::Status{};
    });
    const auto digest = receive(receiver, chunks);
    ASSERT_FALSE(digest.has_value());
    EXPECT_EQ(digest.error().code, code);
    EXPECT_THAT(digest.error().message, HasSubstr(reason));
    EXPECT_LE(kept, bytes_.size());
  }

  const std::string bytes_ = pattern(kChunkBytes + 10);
};

TEST_F(BlobReceiverTest, RefusesAStreamWithoutADigest) {
  auto chunks = chunks_of(bytes_);
  chunks[0].clear_digest();
  expect_refused(chunks, ErrorCode::kInvalidArgument, "first chunk");
  expect_refused({}, ErrorCode::kInvalidArgument, "no chunk");
}

TEST_F(BlobReceiverTest, RefusesMoreBytesThanPromised) {
  auto chunks = chunks_of(bytes_);
  chunks[1].mutable_data()->push_back('x');
  expect_refused(chunks, ErrorCode::kInvalidArgument, "longer than its digest's");
}

TEST_F(BlobReceiverTest, RefusesFewerOrOtherBytes) {
  auto chunks = chunks_of(bytes_);
  chunks.pop_back();
  expect_refused(chunks, ErrorCode::kDataLoss, "damaged");
  chunks = chunks_of(bytes_);
  (*chunks[1].mutable_data())[3] ^= 1;
  expect_refused(chunks, ErrorCode::kDataLoss, "damaged");
}

TEST_F(BlobReceiverTest, RefusesAnotherBlob) {
  expect_refused(chunks_of("other"), ErrorCode::kInvalidArgument, "asked for blob");
  auto chunks = chunks_of(bytes_);
  *chunks[1].mutable_digest() = to_proto(digest_of("other"));
  expect_refused(chunks, ErrorCode::kInvalidArgument, "asked for blob");
}

TEST_F(BlobReceiverTest, RefusesAnOversizedChunk) {
  v1::BlobChunk chunk;
  *chunk.mutable_digest() = to_proto(digest_of(bytes_));
  chunk.set_data(pattern(kMaxChunkBytes + 1));
  expect_refused({chunk}, ErrorCode::kInvalidArgument, "a chunk may hold");
}

TEST_F(BlobReceiverTest, PassesTheSinksErrorOn) {
  BlobReceiver receiver([](std::string_view) -> core::Status {
    return core::fail(ErrorCode::kResourceExhausted, "disk full");
  });
  const auto digest = receive(receiver, chunks_of(bytes_));
  ASSERT_FALSE(digest.has_value());
  EXPECT_EQ(digest.error().message, "disk full");
}

TEST(Digest, ComesBackFromItsName) {
  const Digest digest = digest_of("tessera");
  const std::string name = blob_name(digest);
  EXPECT_EQ(name, "blobs/" + digest.hex() + "/7");
  EXPECT_EQ(digest_from_name(name), digest);
  for (const std::string& other :
       {std::string(), std::string("blobs/"), name + "x", name.substr(1), "blobs/" + digest.hex(),
        "blobs/" + digest.hex() + "/", "blobs/" + std::string(64, 'A') + "/7",
        "blobs/" + std::string(63, 'a') + "/77"})
    EXPECT_FALSE(digest_from_name(other)) << other;
}

}  // namespace
}  // namespace tessera::proto
