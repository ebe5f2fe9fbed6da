#include "worker/blob_cache.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "core/scene/cache/cache_folder.hpp"
#include "core/scene/cache/scene_store.hpp"
#include "proto/status.hpp"
#include "worker/waiting.hpp"

namespace tessera::worker {
namespace {

namespace fs = std::filesystem;
using core::ErrorCode;
using core::fail;

// Of a SHA-256.
constexpr std::size_t kHexDigits = 64;
constexpr const char* kPartialSuffix = ".partial";
// For one blob, however large: a stalled transfer is noticed by the channel's keepalive long before.
constexpr auto kFetchDeadline = std::chrono::hours(1);

// Different for each transfer of each process that shares the folder.
std::string partial_path(const std::string& path) {
  static std::atomic<unsigned> transfers{0};
  return fmt::format("{}.{}-{}{}", path, getpid(), ++transfers, kPartialSuffix);
}

core::Error cannot_write(const std::string& path) {
  return {ErrorCode::kInternal, fmt::format("cannot write {}: {}", path, std::strerror(errno))};
}

// The names that path_of() gives.
bool is_blob_name(const std::string& name) {
  return name.size() == kHexDigits && name.find_first_not_of("0123456789abcdef") == std::string::npos;
}

// Those of partial_path().
bool is_partial_name(const std::string& name) {
  return is_blob_name(name.substr(0, kHexDigits)) && name.ends_with(kPartialSuffix);
}

bool holds(const std::string& path, const proto::Digest& digest) {
  std::ifstream file(path, std::ios::binary);
  proto::Hasher hasher;
  std::string buffer(proto::kMaxChunkBytes, '\0');
  while (file && hasher.size_bytes() <= digest.size_bytes) {
    file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    hasher.update({buffer.data(), static_cast<std::size_t>(file.gcount())});
  }
  return hasher.finish() == digest;
}

}  // namespace

core::Result<BlobCache> BlobCache::open(const std::string& folder, std::uint64_t max_bytes) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return fail(ErrorCode::kInternal, fmt::format("cannot create {}: {}", folder, error.message()));
  if (access(folder.c_str(), R_OK | W_OK | X_OK) != 0) return fail(cannot_write(folder));
  core::remove_abandoned(folder, is_partial_name);
  return BlobCache(folder, max_bytes);
}

bool BlobCache::is_file_name(const std::string& name) {
  return is_blob_name(name) || core::SceneStore::is_file_name(name);
}

std::string BlobCache::path_of(const proto::Digest& digest) const {
  return folder_ + "/" + digest.hex();
}

core::Result<std::string> BlobCache::get(const proto::Digest& digest,
                                         v1::WorkerService::StubInterface& coordinator,
                                         const std::stop_token& stop) const {
  const std::string path = path_of(digest);
  if (holds(path, digest)) {
    core::mark_as_used(path);
    return path;
  }
  const std::string partial = partial_path(path);
  core::Status done = download(digest, partial, coordinator, stop);
  if (done && std::rename(partial.c_str(), path.c_str()) != 0) done = fail(cannot_write(path));
  if (!done) {
    std::remove(partial.c_str());
    return fail(done.error());
  }
  core::remove_least_used(folder_, max_bytes_, is_file_name);
  return path;
}

core::Status BlobCache::download(const proto::Digest& digest, const std::string& path,
                                 v1::WorkerService::StubInterface& coordinator,
                                 const std::stop_token& stop) const {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  proto::BlobReceiver receiver(digest, [&](std::string_view bytes) -> core::Status {
    if (!file.write(bytes.data(), static_cast<std::streamsize>(bytes.size())))
      return fail(cannot_write(path));
    return {};
  });

  StoppableCall call(stop, kFetchDeadline);
  call.context()->set_wait_for_ready(true);
  v1::FetchBlobRequest request;
  *request.mutable_digest() = proto::to_proto(digest);
  const auto stream = coordinator.FetchBlob(call.context(), request);
  v1::FetchBlobResponse response;
  core::Status taken;
  while (taken && stream->Read(&response)) taken = receiver.accept(response.chunk());
  if (!taken) call.context()->TryCancel();
  const grpc::Status finished = stream->Finish();
  if (!taken) return taken;
  if (!finished.ok()) return proto::from_grpc(finished);

  file.close();
  if (!file) return fail(cannot_write(path));
  const auto received = receiver.finish();
  return received ? core::Status{} : fail(received.error());
}

}  // namespace tessera::worker
