// SPDX-License-Identifier: Apache-2.0
#include "server/blobs/partial_uploads.hpp"

#include <algorithm>
#include <utility>

namespace tessera::blobs {

// Removed uploads are destroyed without the lock, since that deletes their files.
void PartialUploads::keep(const std::string& caller, BlobWriter writer) {
  if (!writer.can_be_continued() || writer.written_bytes() < kMinBytes) return;
  Uploads removed;
  const core::MutexLock lock(mutex_);
  if (const auto earlier = find(caller, writer.digest()); earlier != uploads_.end())
    removed.splice(removed.end(), uploads_, earlier);
  auto place = places_.take(caller);
  if (place) uploads_.push_back({caller, std::move(writer), *std::move(place), now_()});
}

std::uint64_t PartialUploads::size_bytes(const std::string& caller, const proto::Digest& digest) {
  const core::MutexLock lock(mutex_);
  const auto upload = find(caller, digest);
  return upload == uploads_.end() ? 0 : upload->writer.written_bytes();
}

std::optional<BlobWriter> PartialUploads::take(const std::string& caller, const proto::Digest& digest) {
  Uploads taken;
  const core::MutexLock lock(mutex_);
  const auto upload = find(caller, digest);
  if (upload == uploads_.end()) return std::nullopt;
  taken.splice(taken.end(), uploads_, upload);
  return std::move(taken.front().writer);
}

std::uint64_t PartialUploads::room_bytes() {
  const core::MutexLock lock(mutex_);
  std::uint64_t bytes = 0;
  for (const Upload& upload : uploads_) bytes += upload.writer.digest().size_bytes;
  return bytes;
}

void PartialUploads::collect() {
  Uploads removed;
  const core::MutexLock lock(mutex_);
  const auto kept = std::find_if(uploads_.begin(), uploads_.end(), [&](const Upload& upload) {
    return upload.interrupted_at + kKeepTime > now_();
  });
  removed.splice(removed.end(), uploads_, uploads_.begin(), kept);
}

bool PartialUploads::remove_oldest() {
  Uploads removed;
  const core::MutexLock lock(mutex_);
  if (uploads_.empty()) return false;
  removed.splice(removed.end(), uploads_, uploads_.begin());
  return true;
}

PartialUploads::Uploads::iterator PartialUploads::find(const std::string& caller,
                                                       const proto::Digest& digest) {
  return std::find_if(uploads_.begin(), uploads_.end(), [&](const Upload& upload) {
    return upload.caller == caller && upload.writer.digest() == digest;
  });
}

}  // namespace tessera::blobs
