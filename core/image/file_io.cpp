// SPDX-License-Identifier: Apache-2.0
#include "core/image/file_io.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

namespace tessera::core {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 34;  // the largest image takes 12 GiB

class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    if (this != &other) {
      close();
      fd_ = std::exchange(other.fd_, -1);
    }
    return *this;
  }
  ~FileDescriptor() { close(); }

  bool valid() const { return fd_ >= 0; }
  int get() const { return fd_; }
  bool close() { return fd_ < 0 || ::close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

ErrorCode code_of(int error) {
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return ErrorCode::kNotFound;
    case EACCES:
    case EPERM:
    case EROFS:
      return ErrorCode::kPermissionDenied;
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
    case ENOMEM:
      return ErrorCode::kResourceExhausted;
    case EISDIR:
      return ErrorCode::kInvalidArgument;
    default:
      return ErrorCode::kUnavailable;
  }
}

tl::unexpected<Error> fail_with(int error, std::string_view action, const std::string& path) {
  return fail(code_of(error), fmt::format("cannot {} '{}': {}", action, path, std::strerror(error)));
}
tl::unexpected<Error> cannot_write(int error, const std::string& path) {
  return fail_with(error, "write", path);
}

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path();
  return folder.empty() ? "." : folder;
}

// Resolves symbolic links; returns the path itself if it is not a link.
std::string follow_links(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::path target = std::filesystem::canonical(path, ignored);
  return target.empty() ? path : target.string();
}

// Sets errno if access is denied.
bool allowed(const std::string& path, int rights) {
  return ::faccessat(AT_FDCWD, path.c_str(), rights, AT_EACCESS) == 0;
}

// 0, or errno.
int write_all(int fd, std::string_view bytes) {
  constexpr std::size_t kLargestWrite = std::size_t{1} << 30;
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), std::min(bytes.size(), kLargestWrite));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

// Error messages name `path`, which may be a link to `target`.
Status write_in_place(const std::string& target, std::string_view bytes, const std::string& path) {
  const FileDescriptor file(::open(target.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file.valid()) return cannot_write(errno, path);
  if (const int error = write_all(file.get(), bytes)) return cannot_write(error, path);
  return {};
}

// Writes and flushes a new file. Returns 0 or errno.
int write_durably(const FileDescriptor& file, std::string_view bytes) {
  if (const int error = write_all(file.get(), bytes)) return error;
  return ::fsync(file.get()) == 0 ? 0 : errno;
}

// ---- Temporary files: .NAME.N.tmp beside NAME, N from 0 on; after these .NAME.PID-N.tmp ----
//
// Their writers hold a lock on them, which ends with the process, also on other machines that share the
// folder.

// Of the names without a process.
constexpr int kSharedNames = 16;

std::string temporary_path(const std::string& target, int number) {
  constexpr std::size_t kMaxNameBytes = 200;
  const std::string name = std::filesystem::path(target).filename().string().substr(0, kMaxNameBytes);
  const std::string which = number < kSharedNames ? fmt::format("{}", number)
                                                  : fmt::format("{}-{}", ::getpid(), number - kSharedNames);
  return fmt::format("{}/.{}.{}.tmp", folder_of(target), name, which);
}

// Says to others that this process writes the file. False if one of them is just removing it. On file systems
// without locks nobody removes any.
bool lock_temporary(const FileDescriptor& file) {
  return ::flock(file.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

// Whether the path still names the open file.
bool is_named(const FileDescriptor& file, const std::string& path) {
  struct stat open_file {};
  struct stat named {};
  return ::fstat(file.get(), &open_file) == 0 && ::lstat(path.c_str(), &named) == 0 &&
         open_file.st_dev == named.st_dev && open_file.st_ino == named.st_ino;
}

// Removes the temporary files of the target that killed writers have left, but those with a process in their
// name: these are made only while so many write the same file, or where there are no locks. To look for names
// costs the same in a folder of many files, unlike listing it.
void remove_abandoned_beside(const std::string& target) {
  for (int number = 0; number < kSharedNames; ++number) {
    const std::string path = temporary_path(target, number);
    const FileDescriptor file(::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (!file.valid() || ::flock(file.get(), LOCK_EX | LOCK_NB) != 0) continue;
    // With the lock, a file that still has this name has no writer who will rename it.
    if (is_named(file, path)) ::unlink(path.c_str());
  }
}

// Calls `create` with names beside `target` until one is unused, and returns that name. Returns an empty
// string and sets errno if none can be created. Other processes may be writing the same target, or have
// left files behind, which stay where there are no locks.
template <typename Create>
std::string new_name_beside(const std::string& target, const Create& create) {
  constexpr int kAttempts = 1000;
  for (int attempt = 0;; ++attempt) {
    std::string path = temporary_path(target, attempt);
    if (create(path)) return path;
    if (errno != EEXIST || attempt == kAttempts) return "";
  }
}

// An unnamed file in the folder of `target`, which disappears if the process is killed. Invalid if the
// system does not support it.
FileDescriptor create_unnamed(const std::string& target) {
  if (::access("/proc/self/fd", X_OK) != 0) return FileDescriptor(-1);  // it could not be given a name later
  return FileDescriptor(::open(folder_of(target).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666));
}

// Links the file to a name beside `target`. Returns an empty string and sets errno on failure.
std::string name_beside(const FileDescriptor& file, const std::string& target) {
  const std::string unnamed = fmt::format("/proc/self/fd/{}", file.get());
  return new_name_beside(target, [&](const std::string& path) {
    return ::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0;
  });
}

struct Temporary {
  FileDescriptor file{-1};  // open, and so locked, until it is renamed
  std::string path{};       // empty: it has no name
};

// A new file with a name. Sets errno if there can be none.
Temporary create_named(const std::string& target) {
  Temporary made;
  made.path = new_name_beside(target, [&](const std::string& path) {
    // O_EXCL never follows an existing link and never shares a file between two writers.
    made.file = FileDescriptor(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (!made.file.valid()) return false;
    if (lock_temporary(made.file) && is_named(made.file, path)) return true;
    errno = EEXIST;  // another writer has taken it for abandoned before it was locked
    return false;
  });
  return made;
}

// Writes a new file beside `target`. Returns 0 or errno.
int write_beside(const std::string& target, std::string_view bytes, Temporary& made) {
  made.file = create_unnamed(target);
  if (made.file.valid()) {
    if (const int error = write_durably(made.file, bytes)) return error;
    lock_temporary(made.file);
    made.path = name_beside(made.file, target);
    return made.path.empty() ? errno : 0;
  }
  made = create_named(target);
  return made.path.empty() ? errno : write_durably(made.file, bytes);
}

Status replace_file(const std::string& target, std::string_view bytes, const std::string& path) {
  remove_abandoned_beside(target);
  Temporary made;
  int error = write_beside(target, bytes, made);
  if (error == 0 && ::rename(made.path.c_str(), target.c_str()) != 0) error = errno;
  if (error != 0) {
    if (!made.path.empty()) ::unlink(made.path.c_str());
    return cannot_write(error, path);
  }
  // Makes the rename durable. On systems that cannot flush folders the file is still complete.
  const FileDescriptor folder(::open(folder_of(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.valid()) ::fsync(folder.get());
  return {};
}

}  // namespace

Result<std::string> read_file(const std::string& path) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.valid()) return fail_with(errno, "read", path);
  std::string bytes;
  char buffer[1 << 16];
  for (;;) {
    const ssize_t count = ::read(file.get(), buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return fail_with(errno, "read", path);
    if (count == 0) return bytes;
    if (bytes.size() > kMaxFileBytes) return fail_with(EFBIG, "read", path);
    bytes.append(buffer, static_cast<std::size_t>(count));
  }
}

Status check_can_write(const std::string& path) {
  const std::string target = follow_links(path);
  struct stat info {};
  if (::stat(target.c_str(), &info) == 0) {
    if (S_ISDIR(info.st_mode)) return cannot_write(EISDIR, path);
    if (!allowed(target, W_OK)) return cannot_write(errno, path);
    if (!S_ISREG(info.st_mode)) return {};
  }
  const std::string folder = folder_of(target);
  if (::stat(folder.c_str(), &info) != 0) {
    return fail(code_of(errno),
                fmt::format("cannot write '{}': the folder '{}' does not exist", path, folder));
  }
  if (!S_ISDIR(info.st_mode)) return cannot_write(ENOTDIR, path);
  if (!allowed(folder, W_OK | X_OK)) {
    return fail(code_of(errno), fmt::format("cannot write '{}': its folder: {}", path, std::strerror(errno)));
  }
  return {};
}

Status write_file_atomically(const std::string& path, std::string_view bytes) {
  if (Status status = check_can_write(path); !status) return status;
  const std::string target = follow_links(path);
  struct stat info {};
  const bool special = ::stat(target.c_str(), &info) == 0 && !S_ISREG(info.st_mode);
  return special ? write_in_place(target, bytes, path) : replace_file(target, bytes, path);
}

}  // namespace tessera::core
