// SPDX-License-Identifier: Apache-2.0
// Content-addressed blobs: their digests, and how they are cut into the chunks of a stream and put together
// again. No files and no calls. Not thread-safe, but different objects may be used at once.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::proto {

inline constexpr std::size_t kMaxChunkBytes = std::size_t{1} << 20;
// As many are sent at a time: so few that a slow line brings some often, and does not seem to stand still.
inline constexpr std::size_t kChunkBytes = std::size_t{1} << 16;

// What a blob is known by.
struct Digest {
  std::array<std::uint8_t, 32> sha256{};
  std::uint64_t size_bytes = 0;

  // 64 lower-case hexadecimal digits of sha256.
  std::string hex() const;
  auto operator<=>(const Digest&) const = default;
};

Digest digest_of(std::string_view bytes);
v1::Digest to_proto(const Digest& digest);
// INVALID_ARGUMENT unless sha256 is 32 bytes.
core::Result<Digest> from_proto(const v1::Digest& digest);

// Digests bytes that come piece by piece.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(Hasher&&) noexcept;
  Hasher& operator=(Hasher&&) noexcept;

  void update(std::string_view bytes);
  std::uint64_t size_bytes() const { return size_bytes_; }
  // Of all bytes so far. Call it once, at the end.
  Digest finish();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
  std::uint64_t size_bytes_ = 0;
};

// Calls `send` with each chunk of a blob, the first of which carries the digest; an empty blob has one chunk.
// Stops and answers false as soon as `send` does.
bool for_each_chunk(const Digest& digest, std::string_view bytes,
                    const std::function<bool(const v1::BlobChunk&)>& send);

// Checks the chunks of one blob as they arrive, so that a receiver never keeps more bytes than were promised.
class BlobReceiver {
 public:
  // Takes the bytes of a checked chunk, e.g. to a file; its errors are passed on.
  using Sink = std::function<core::Status(std::string_view bytes)>;

  // Expects whatever blob the first chunk names.
  explicit BlobReceiver(Sink sink) : sink_(std::move(sink)) {}
  // Expects this blob: another one's digest is an error.
  BlobReceiver(const Digest& expected, Sink sink)
      : sink_(std::move(sink)), expected_(expected), named_(true) {}

  // INVALID_ARGUMENT: no digest at first or another one later, a chunk above kMaxChunkBytes, more bytes than
  // promised.
  core::Status accept(const v1::BlobChunk& chunk);
  // Call it once, after the last chunk. INVALID_ARGUMENT: nothing came. DATA_LOSS: the bytes do not match the
  // digest.
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
