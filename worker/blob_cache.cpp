// SPDX-License-Identifier: Apache-2.0
#include "worker/blob_cache.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <span>
#include <string_view>
#include <system_error>

#include "core/scene/cache/block_file.hpp"
#include "core/scene/cache/cache_folder.hpp"
#include "core/scene/cache/scene_store.hpp"
#include "proto/status.hpp"
#include "worker/waiting.hpp"

namespace tessera::worker {
namespace {

using core::ErrorCode;
using core::fail;

// The length of a SHA-256.
constexpr std::size_t kHexDigits = 64;
// The timeout for one chunk of a blob, of up to a mebibyte, so that lines of a few kilobytes a second
// suffice. The channel's keepalive detects a peer that vanished long before.
constexpr auto kMaxSilence = std::chrono::minutes(5);

core::Error cannot_write(const std::string& path) {
  return {ErrorCode::kInternal, fmt::format("cannot write {}: {}", path, std::strerror(errno))};
}

// Whether path_of() gives such names.
bool is_blob_name(const std::string& name) {
  return name.size() == kHexDigits && name.find_first_not_of("0123456789abcdef") == std::string::npos;
}

double in_gib(std::uint64_t bytes) {
  return static_cast<double>(bytes) / (std::uint64_t{1} << 30);
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

core::Result<BlobCache> BlobCache::open(const std::string& folder, std::uint64_t max_bytes) {
  if (core::Status usable = core::make_folder(folder); !usable) return fail(usable.error());
  // Another user who may write to the folder could change a scene between its check and its use.
  if (core::Status own = core::check_is_own(folder); !own) return fail(own.error());
  core::remove_abandoned(folder, is_blob_name);
  return BlobCache(folder, max_bytes);
}

std::uint64_t BlobCache::used_bytes() const {
  std::uint64_t bytes = 0;
  std::error_code failed;
  for (std::filesystem::directory_iterator file(folder_, failed), end; !failed && file != end;
       file.increment(failed)) {
    std::error_code gone;
    if (!is_file_name(file->path().filename())) continue;
    if (const std::uintmax_t size = file->file_size(gone); !gone) bytes += size;
  }
  return bytes;
}

bool BlobCache::is_file_name(const std::string& name) {
  return is_blob_name(name) || core::SceneStore::is_file_name(name);
}

std::string BlobCache::path_of(const proto::Digest& digest) const {
  return folder_ + "/" + digest.hex();
}

core::Result<std::string> BlobCache::get(const proto::Digest& digest, const InUse& in_use,
                                         v1::WorkerService::StubInterface& coordinator,
                                         const std::stop_token& stop) const {
  const std::string path = path_of(digest);
  const core::OpenFile known(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (known.valid() && holds(known, digest)) {
    core::mark_as_used(path);
    return path;
  }
  const std::string partial = core::partial_path_of(path);
  core::Status done = download(digest, partial, in_use, coordinator, stop);
  if (done && std::rename(partial.c_str(), path.c_str()) != 0) done = fail(cannot_write(path));
  if (!done) {
    std::remove(partial.c_str());
    return fail(done.error());
  }
  ++fetched_->files;
  fetched_->bytes += digest.size_bytes;
  return path;
}

core::Status BlobCache::make_room(const InUse& in_use) const {
  const auto must_stay = [&](const std::string& name, std::chrono::seconds) { return in_use.contains(name); };
  if (core::remove_least_used(folder_, max_bytes_, is_file_name, must_stay) <= max_bytes_) return {};
  return fail(ErrorCode::kResourceExhausted,
              fmt::format("the cache {} is full of files that are in use, or that other workers are writing: "
                          "a larger --cache-gib than {:.3g} makes room",
                          folder_, in_gib(max_bytes_)));
}

core::Status BlobCache::download(const proto::Digest& digest, const std::string& path, const InUse& in_use,
                                 v1::WorkerService::StubInterface& coordinator,
                                 const std::stop_token& stop) const {
  const core::OpenFile file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
  if (!file.valid()) return fail(cannot_write(path));
  // With its full size it counts in the folder, also for other workers that are making room.
  if (::ftruncate(file.get(), static_cast<off_t>(digest.size_bytes)) != 0) return fail(cannot_write(path));
  if (core::Status room = make_room(in_use); !room) return room;
  std::uint64_t size = 0;
  proto::BlobReceiver receiver(digest, [&](std::string_view bytes) -> core::Status {
    if (!core::write_at(file.get(), std::as_bytes(std::span(bytes)), size)) return fail(cannot_write(path));
    size += bytes.size();
    return {};
  });

  StoppableCall call(stop);
  StallGuard guard(*call.context(), kMaxSilence);
  call.context()->set_wait_for_ready(true);
  v1::FetchBlobRequest request;
  *request.mutable_digest() = proto::to_proto(digest);
  const auto stream = coordinator.FetchBlob(call.context(), request);
  v1::FetchBlobResponse response;
  core::Status taken;
  while (taken && stream->Read(&response)) {
    guard.progressed();
    taken = receiver.accept(response.chunk());
  }
  if (!taken) call.context()->TryCancel();
  const grpc::Status finished = stream->Finish();
  if (!taken) return taken;
  if (finished.error_code() == grpc::StatusCode::CANCELLED && !stop.stop_requested())
    return fail(ErrorCode::kUnavailable,
                "the coordinator ended the download: it is stopping, or for long too little was taken here");
  if (!finished.ok()) return fail(proto::error_from_grpc(finished, *call.context()));

  const auto received = receiver.finish();
  return received ? core::Status{} : fail(received.error());
}

}  // namespace tessera::worker
