// SPDX-License-Identifier: Apache-2.0
#include "server/base/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

namespace tessera::base {

using core::ErrorCode;

namespace {

// Less is used up by the next change of the database.
constexpr unsigned long kMinFreeBytes = 1 << 20;

struct Advice {
  ErrorCode code;
  std::string sentence;
};

Advice advice_for(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return {ErrorCode::kResourceExhausted, "the disk is full: free some space there"};
    case EROFS:
      return {ErrorCode::kFailedPrecondition,
              "it is on a read-only file system: remount it, or choose another folder with --state"};
    case EACCES:
    case EPERM:
      return {ErrorCode::kPermissionDenied,
              "permission denied: let this user read and write there, or choose another folder with --state"};
    case EMFILE:
    case ENFILE:
      return {ErrorCode::kResourceExhausted, "too many open files: raise the limit (ulimit -n)"};
    case EFBIG:
      return {ErrorCode::kResourceExhausted, "it is too large: raise the limit (ulimit -f)"};
    case ENOENT:
      return {ErrorCode::kNotFound, "no such file or folder"};
    case EIO:
      return {ErrorCode::kDataLoss, "the disk failed to read or write: check its health"};
    default:
      return {ErrorCode::kInternal, std::strerror(error)};
  }
}

}  // namespace

core::Error errno_error(std::string_view doing, const std::filesystem::path& path) {
  const Advice advice = advice_for(errno);
  return {advice.code, fmt::format("{} {}: {}", doing, path.string(), advice.sentence)};
}

core::Status write_all(const Fd& fd, std::string_view bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return core::fail(errno_error("writing", path));
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

core::Status sync_file(const Fd& fd, const std::filesystem::path& path) {
  if (::fsync(fd.get()) != 0) return core::fail(errno_error("writing", path));
  return {};
}

core::Status sync_folder(const std::filesystem::path& folder) {
  const Fd fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd) return core::fail(errno_error("opening", folder));
  return sync_file(fd, folder);
}

core::Status create_folder(const std::filesystem::path& folder) {
  std::filesystem::path part;
  for (const auto& name : std::filesystem::absolute(folder)) {
    part /= name;
    if (::mkdir(part.c_str(), 0700) == 0 || errno == EEXIST) continue;
    const core::Error error = errno_error("creating", part);
    if (std::error_code unknown; !std::filesystem::is_directory(part, unknown)) return core::fail(error);
  }
  if (std::error_code unknown; std::filesystem::is_directory(folder, unknown)) return {};
  return core::fail(ErrorCode::kFailedPrecondition, folder.string() + " is not a folder");
}

std::string write_obstacle(const struct statvfs& file_system) {
  if ((file_system.f_flag & ST_RDONLY) != 0) return "its file system is read-only";
  const bool has_room = file_system.f_bavail >= kMinFreeBytes / file_system.f_frsize;
  return has_room ? "" : "its disk is full";
}

std::string write_obstacle(const std::filesystem::path& folder) {
  struct statvfs file_system {};
  if (::statvfs(folder.c_str(), &file_system) != 0 || file_system.f_frsize == 0) return "";
  return write_obstacle(file_system);
}

}  // namespace tessera::base
