// SPDX-License-Identifier: Apache-2.0
// Content-addressed blobs: their digests, and how they are divided into the chunks of a stream and joined
// again. No files and no calls. Not thread-safe, but different objects may be used at once.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::proto {

inline constexpr std::size_t kMaxChunkBytes = std::size_t{1} << 20;
// The size of the chunks that are sent: so small that a slow line delivers one often, and does not appear
// stalled.
inline constexpr std::size_t kChunkBytes = std::size_t{1} << 16;

// The identity of a blob.
struct Digest {
  std::array<std::uint8_t, 32> sha256{};
  std::uint64_t size_bytes = 0;

  // 64 lower-case hexadecimal digits of sha256.
  std::string hex() const;
  auto operator<=>(const Digest&) const = default;
};

// The name of a blob in details of errors: "blobs/SHA256/SIZE".
std::string blob_name(const Digest& digest);
// Empty if it is no such name.
std::optional<Digest> digest_from_name(std::string_view name);
// Empty unless `hex` is 64 lower-case hexadecimal digits.
std::optional<Digest> digest_from_hex(std::string_view hex, std::uint64_t size_bytes);

Digest digest_of(std::string_view bytes);
v1::Digest to_proto(const Digest& digest);
// INVALID_ARGUMENT unless sha256 is 32 bytes.
core::Result<Digest> from_proto(const v1::Digest& digest);

// Computes the digest of bytes that arrive in pieces.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(Hasher&&) noexcept;
  Hasher& operator=(Hasher&&) noexcept;

  void update(std::string_view bytes);
  std::uint64_t size_bytes() const { return size_bytes_; }
  // The digest of all bytes so far. Call it once, at the end.
  Digest finish();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
  std::uint64_t size_bytes_ = 0;
};

// Calls `send` with each chunk of a blob. The first chunk carries the digest; an empty blob has one chunk.
// Stops and returns false as soon as `send` does.
bool for_each_chunk(const Digest& digest, std::string_view bytes,
                    const std::function<bool(const v1::BlobChunk&)>& send);

// Checks the chunks of one blob as they arrive, so that a receiver never keeps more bytes than were
// announced.
class BlobReceiver {
 public:
  // Receives the bytes of a checked chunk, e.g. to write them to a file; its errors are passed on.
  using Sink = std::function<core::Status(std::string_view bytes)>;

  // Accepts the blob that the first chunk names.
  explicit BlobReceiver(Sink sink) : sink_(std::move(sink)) {}
  // Accepts only this blob: the digest of another one is an error.
  BlobReceiver(const Digest& expected, Sink sink)
      : sink_(std::move(sink)), expected_(expected), named_(true) {}

  // INVALID_ARGUMENT: the digest is missing or changes, a chunk exceeds kMaxChunkBytes, or there are more
  // bytes than announced.
  core::Status accept(const v1::BlobChunk& chunk);
  // Call it once, after the last chunk. INVALID_ARGUMENT: there was no chunk. DATA_LOSS: the bytes do not
  // match the digest.
  core::Result<Digest> finish();

  // Valid after the first accepted chunk.
  const Digest& digest() const { return expected_; }

 private:
  core::Status learn_digest(const v1::BlobChunk& chunk);

  Sink sink_;
  Hasher hasher_;
  Digest expected_;
  bool named_ = false;
  bool started_ = false;
};

}  // namespace tessera::proto
