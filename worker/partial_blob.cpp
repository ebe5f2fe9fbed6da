// SPDX-License-Identifier: Apache-2.0
#include "worker/partial_blob.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>
#include <utility>

#include "core/scene/cache/block_file.hpp"

namespace tessera::worker {
namespace {

tl::unexpected<core::Error> cannot_write_blob(const std::string& path) {
  return core::fail(core::ErrorCode::kInternal,
                    fmt::format("cannot write {}: {}", path, std::strerror(errno)));
}

}  // namespace

bool holds(const core::OpenFile& file, const proto::Digest& digest) {
  const off_t size = ::lseek(file.get(), 0, SEEK_END);
  if (size < 0 || static_cast<std::uint64_t>(size) != digest.size_bytes) return false;
  proto::Hasher hasher;
  std::string buffer(std::min<std::uint64_t>(digest.size_bytes, proto::kMaxChunkBytes), '\0');
  while (hasher.size_bytes() < digest.size_bytes) {
    const std::string_view piece =
        std::string_view(buffer).substr(0, digest.size_bytes - hasher.size_bytes());
    if (!core::read_at(file.get(), std::as_writable_bytes(std::span(buffer).first(piece.size())),
                       hasher.size_bytes()))
      return false;
    hasher.update(piece);
  }
  return hasher.finish() == digest;
}

core::Result<std::shared_ptr<PartialBlob>> PartialBlob::create(const std::string& path,
                                                               const proto::Digest& digest) {
  core::OpenFile file(::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
  if (!file.valid()) return cannot_write_blob(path);
  // With its full size it counts in the folder, also for other workers that are making room.
  if (::ftruncate(file.get(), static_cast<off_t>(digest.size_bytes)) != 0) return cannot_write_blob(path);
  return std::shared_ptr<PartialBlob>(new PartialBlob(path, digest, std::move(file)));
}

core::Status PartialBlob::write(std::string_view bytes, std::uint64_t offset) {
  if (!core::write_at(file_.get(), std::as_bytes(std::span(bytes)), offset)) return cannot_write_blob(path_);
  return {};
}

core::Status PartialBlob::add(const proto::Segment& segment, std::string_view bytes) {
  if (core::Status written = write(bytes, segment.offset_bytes); !written) return written;
  const core::MutexLock lock(mutex_);
  held_.insert(segment.index());
  added_.notify_all();
  return {};
}

proto::SegmentSet PartialBlob::held() const {
  const core::MutexLock lock(mutex_);
  return held_;
}

void PartialBlob::clear() {
  const core::MutexLock lock(mutex_);
  held_ = proto::SegmentSet(held_.count());
}

bool PartialBlob::is_intact() const {
  return held().is_full() && holds(file_, digest_);
}

std::optional<std::string> PartialBlob::read(const proto::Segment& segment,
                                             std::chrono::milliseconds timeout) const {
  {
    core::MutexLock lock(mutex_);
    const auto is_there = [&]() TESSERA_REQUIRES(mutex_) { return held_.contains(segment.index()); };
    if (!added_.wait_for(lock.native(), timeout, is_there)) return std::nullopt;
  }
  std::string bytes(segment.size_bytes, '\0');
  if (!core::read_at(file_.get(), std::as_writable_bytes(std::span(bytes)), segment.offset_bytes))
    return std::nullopt;
  return bytes;
}

PartialBlobs::Listing::Listing(PartialBlobs& list, std::shared_ptr<PartialBlob> blob)
    : list_(list), blob_(std::move(blob)) {
  const core::MutexLock lock(list_.mutex_);
  list_.blobs_.insert_or_assign(blob_->digest(), blob_);
}

PartialBlobs::Listing::~Listing() {
  const core::MutexLock lock(list_.mutex_);
  const auto listed = list_.blobs_.find(blob_->digest());
  if (listed != list_.blobs_.end() && listed->second == blob_) list_.blobs_.erase(listed);
}

std::shared_ptr<const PartialBlob> PartialBlobs::find(const proto::Digest& digest) const {
  const core::MutexLock lock(mutex_);
  const auto listed = blobs_.find(digest);
  return listed == blobs_.end() ? nullptr : listed->second;
}

}  // namespace tessera::worker
