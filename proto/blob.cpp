// SPDX-License-Identifier: Apache-2.0
#include "proto/blob.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <charconv>
#include <new>
#include <system_error>

namespace tessera::proto {

using core::ErrorCode;
using core::fail;

std::string Digest::hex() const {
  std::string text;
  text.reserve(2 * sha256.size());
  for (const std::uint8_t byte : sha256) text += fmt::format("{:02x}", byte);
  return text;
}

std::string blob_name(const Digest& digest) {
  return fmt::format("blobs/{}/{}", digest.hex(), digest.size_bytes);
}

std::optional<Digest> digest_from_hex(std::string_view hex, std::uint64_t size_bytes) {
  Digest digest;
  digest.size_bytes = size_bytes;
  for (std::size_t i = 0; i < digest.sha256.size() && hex.size() == 2 * digest.sha256.size(); ++i) {
    const char* const begin = hex.data() + 2 * i;
    if (std::from_chars(begin, begin + 2, digest.sha256[i], 16).ptr != begin + 2) return std::nullopt;
  }
  if (digest.hex() != hex) return std::nullopt;
  return digest;
}

std::optional<Digest> digest_from_name(std::string_view name) {
  constexpr std::string_view kPrefix = "blobs/";
  constexpr std::size_t kHexDigits = 64;
  if (!name.starts_with(kPrefix) || name.size() < kPrefix.size() + kHexDigits + 2) return std::nullopt;
  name.remove_prefix(kPrefix.size());
  if (name[kHexDigits] != '/') return std::nullopt;
  std::uint64_t size_bytes = 0;
  const char* const end = name.data() + name.size();
  const auto read = std::from_chars(name.data() + kHexDigits + 1, end, size_bytes);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return digest_from_hex(name.substr(0, kHexDigits), size_bytes);
}

Digest digest_of(std::string_view bytes) {
  Hasher hasher;
  hasher.update(bytes);
  return hasher.finish();
}

v1::Digest to_proto(const Digest& digest) {
  v1::Digest message;
  message.set_sha256(std::string(digest.sha256.begin(), digest.sha256.end()));
  message.set_size_bytes(digest.size_bytes);
  return message;
}

core::Result<Digest> from_proto(const v1::Digest& message) {
  Digest digest;
  if (message.sha256().size() != digest.sha256.size())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("digest.sha256: must be 32 bytes, got {}", message.sha256().size()));
  std::copy(message.sha256().begin(), message.sha256().end(), digest.sha256.begin());
  digest.size_bytes = message.size_bytes();
  return digest;
}

struct Hasher::Context {
  Context() : evp(EVP_MD_CTX_new()) {
    // Both fail only for lack of memory.
    if (evp == nullptr || EVP_DigestInit_ex(evp, EVP_sha256(), nullptr) != 1) throw std::bad_alloc();
  }
  ~Context() { EVP_MD_CTX_free(evp); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  EVP_MD_CTX* evp;
};

Hasher::Hasher() : context_(std::make_unique<Context>()) {}
Hasher::~Hasher() = default;
Hasher::Hasher(Hasher&&) noexcept = default;
Hasher& Hasher::operator=(Hasher&&) noexcept = default;

void Hasher::update(std::string_view bytes) {
  EVP_DigestUpdate(context_->evp, bytes.data(), bytes.size());
  size_bytes_ += bytes.size();
}

Digest Hasher::finish() {
  Digest digest;
  EVP_DigestFinal_ex(context_->evp, digest.sha256.data(), nullptr);
  digest.size_bytes = size_bytes_;
  return digest;
}

bool for_each_chunk(const Digest& digest, std::string_view bytes,
                    const std::function<bool(const v1::BlobChunk&)>& send) {
  v1::BlobChunk chunk;
  *chunk.mutable_digest() = to_proto(digest);
  do {
    const std::string_view piece = bytes.substr(0, kChunkBytes);
    chunk.set_data(piece.data(), piece.size());
    if (!send(chunk)) return false;
    chunk.clear_digest();
    bytes.remove_prefix(piece.size());
  } while (!bytes.empty());
  return true;
}

core::Status BlobReceiver::learn_digest(const v1::BlobChunk& chunk) {
  if (!chunk.has_digest())
    return fail(ErrorCode::kInvalidArgument, "the first chunk of a blob must carry its digest");
  const core::Result<Digest> digest = from_proto(chunk.digest());
  if (!digest) return fail(digest.error());
  if (named_ && *digest != expected_)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("asked for blob {}, got {}", expected_.hex(), digest->hex()));
  expected_ = *digest;
  named_ = started_ = true;
  return {};
}

core::Status BlobReceiver::accept(const v1::BlobChunk& chunk) {
  if (!started_ || chunk.has_digest()) {
    if (core::Status learnt = learn_digest(chunk); !learnt) return learnt;
  }
  if (chunk.data().size() > kMaxChunkBytes)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("a chunk may hold {} bytes, got {}", kMaxChunkBytes, chunk.data().size()));
  if (chunk.data().size() > expected_.size_bytes - hasher_.size_bytes())
    return fail(ErrorCode::kInvalidArgument, fmt::format("blob {} is longer than its digest's {} bytes",
                                                         expected_.hex(), expected_.size_bytes));
  hasher_.update(chunk.data());
  return sink_(chunk.data());
}

core::Result<Digest> BlobReceiver::finish() {
  if (!started_) return fail(ErrorCode::kInvalidArgument, "no chunk of the blob came");
  const Digest actual = hasher_.finish();
  if (actual != expected_)
    return fail(ErrorCode::kDataLoss,
                fmt::format("the bytes of blob {} ({}) were damaged on the way: got {} ({} bytes)",
                            expected_.hex(), expected_.size_bytes, actual.hex(), actual.size_bytes));
  return actual;
}

}  // namespace tessera::proto
