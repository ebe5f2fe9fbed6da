// SPDX-License-Identifier: Apache-2.0
#include "worker/machine_key.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>

#include "core/scene/cache/block_file.hpp"
#include "core/scene/cache/cache_folder.hpp"
#include "proto/worker_key.hpp"

namespace tessera::worker {
namespace {

std::string random_bytes(std::size_t count) {
  std::string bytes(count, '\0');
  if (::getentropy(bytes.data(), bytes.size()) != 0)
    std::abort();  // documented to fail only for invalid arguments
  return bytes;
}

core::Error failed(const char* what, const std::string& path) {
  return {core::ErrorCode::kUnavailable, fmt::format("cannot {} {}: {}", what, path, std::strerror(errno))};
}

core::Result<std::string> read_key(const std::string& path) {
  const core::OpenFile file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (!file.valid()) return core::fail(failed("read", path));
  std::string key(proto::kMachineKeyBytes + 1, '\0');
  const ssize_t size = ::read(file.get(), key.data(), key.size());
  if (size < 0) return core::fail(failed("read", path));
  if (size != static_cast<ssize_t>(proto::kMachineKeyBytes))
    return core::fail(core::ErrorCode::kDataLoss,
                      fmt::format("{} does not have {} bytes: remove it, and a new one is made", path,
                                  proto::kMachineKeyBytes));
  key.resize(proto::kMachineKeyBytes);
  return key;
}

}  // namespace

core::Result<std::string> machine_key(const std::string& folder) {
  const std::string path = folder + "/worker.key";
  if (::access(path.c_str(), F_OK) == 0) return read_key(path);
  const std::string key = random_bytes(proto::kMachineKeyBytes);
  const std::string partial = core::partial_path_of(path);
  core::Status made;
  {
    const core::OpenFile file(
        ::open(partial.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR));
    if (!file.valid() || !core::write_at(file.get(), std::as_bytes(std::span(key)), 0))
      made = core::fail(failed("write", path));
  }
  // EEXIST: another worker was first, and its key is this machine's.
  if (made && ::link(partial.c_str(), path.c_str()) != 0 && errno != EEXIST)
    made = core::fail(failed("make", path));
  std::remove(partial.c_str());
  return made ? read_key(path) : core::fail(made.error());
}

std::string new_worker_key(const std::string& machine_key) {
  return machine_key + random_bytes(proto::kWorkerKeyBytes - machine_key.size());
}

}  // namespace tessera::worker
