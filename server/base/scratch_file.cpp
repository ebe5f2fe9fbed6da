// SPDX-License-Identifier: Apache-2.0
#include "server/base/scratch_file.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace tessera::base {

core::Result<ScratchFile> ScratchFile::make(const std::filesystem::path& folder) {
  std::string path = (folder / "scratch-XXXXXX").string();
  Fd file(::mkostemp(path.data(), O_CLOEXEC));
  if (!file) return core::fail(errno_error("creating a temporary file in", folder));
  ::unlink(path.c_str());
  return ScratchFile(std::move(file), folder);
}

core::Status ScratchFile::write_at(std::uint64_t offset, std::string_view bytes) {
  core::Status written = write_all(offset, bytes);
  const bool is_full = !written && written.error().code == core::ErrorCode::kResourceExhausted;
  const std::uint64_t end = std::max(size_, offset + bytes.size());
  if (is_full && !is_in_memory_ && end <= kMaxInMemory && move_into_memory())
    written = write_all(offset, bytes);
  if (written) size_ = end;
  return written;
}

bool ScratchFile::move_into_memory() {
  constexpr std::size_t kBytesAtOnce = 1 << 20;
  Fd memory(::memfd_create("scratch", MFD_CLOEXEC));
  if (!memory) return false;
  ScratchFile moved(std::move(memory), folder_);
  for (std::uint64_t offset = 0; offset < size_; offset += kBytesAtOnce) {
    const auto bytes =
        read_at(offset, static_cast<std::size_t>(std::min<std::uint64_t>(kBytesAtOnce, size_ - offset)));
    if (!bytes || !moved.write_all(offset, *bytes)) return false;
  }
  file_ = std::move(moved.file_);
  return is_in_memory_ = true;
}

core::Status ScratchFile::write_all(std::uint64_t offset, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file_.get(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return core::fail(errno_error("writing a temporary file in", folder_));
    bytes.remove_prefix(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
  return {};
}

core::Result<std::string> ScratchFile::read_at(std::uint64_t offset, std::size_t bytes) const {
  std::string result(bytes, '\0');
  std::size_t size = 0;
  while (size < bytes) {
    const ssize_t got =
        ::pread(file_.get(), result.data() + size, bytes - size, static_cast<off_t>(offset + size));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return core::fail(errno_error("reading a temporary file in", folder_));
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  result.resize(size);
  return result;
}

}  // namespace tessera::base
