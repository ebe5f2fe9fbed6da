// SPDX-License-Identifier: Apache-2.0
#include "worker/blob_cache.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <span>
#include <system_error>

#include "core/scene/cache/block_file.hpp"
#include "core/scene/cache/cache_folder.hpp"
#include "core/scene/cache/scene_store.hpp"

namespace tessera::worker {
namespace {

using core::ErrorCode;
using core::fail;

// The length of a SHA-256.
constexpr std::size_t kHexDigits = 64;
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

core::Result<std::string> BlobCache::get(const proto::Digest& digest, const InUse& in_use, BlobSource& source,
                                         const std::stop_token& stop) const {
  const std::string path = path_of(digest);
  const core::OpenFile known(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (known.valid() && holds(known, digest)) {
    core::mark_as_used(path);
    return path;
  }
  const std::string partial = core::partial_path_of(path);
  if (core::Status done = download(digest, partial, in_use, source, stop); !done) {
    std::remove(partial.c_str());
    return fail(done.error());
  }
  ++traffic_->files;
  traffic_->received_bytes += digest.size_bytes;
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

core::Status BlobCache::download(const proto::Digest& digest, const std::string& partial_path,
                                 const InUse& in_use, BlobSource& source, const std::stop_token& stop) const {
  const auto partial = PartialBlob::create(partial_path, digest);
  if (!partial) return fail(partial.error());
  if (core::Status room = make_room(in_use); !room) return room;
  const PartialBlobs::Listing listing(*partial_blobs_, *partial);
  if (core::Status fetched = source.fetch(**partial, stop); !fetched) return fetched;
  const std::string path = path_of(digest);
  if (std::rename(partial_path.c_str(), path.c_str()) != 0) return fail(cannot_write(path));
  return {};
}

std::optional<std::string> BlobCache::read_segment(const proto::Digest& digest, const proto::Segment& segment,
                                                   std::chrono::milliseconds timeout) const {
  if (const auto partial = partial_blobs_->find(digest)) return partial->read(segment, timeout);
  const core::OpenFile file(::open(path_of(digest).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  std::string bytes(file.valid() ? segment.size_bytes : 0, '\0');
  if (!file.valid() ||
      !core::read_at(file.get(), std::as_writable_bytes(std::span(bytes)), segment.offset_bytes))
    return std::nullopt;
  return bytes;
}

}  // namespace tessera::worker
