// SPDX-License-Identifier: Apache-2.0
#include "core/sandbox/memory_file.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>

#include "core/sandbox/missing.hpp"

namespace tessera::sandbox {

core::Result<core::OpenFile> create_memory_file(const char* name, std::string_view content) {
  core::OpenFile file(memfd_create(name, MFD_CLOEXEC));
  if (!file.valid()) return core::fail(system_error("memfd_create"));
  while (!content.empty()) {
    const ssize_t count = write(file.get(), content.data(), content.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return core::fail(system_error("writing a file in memory"));
    content.remove_prefix(static_cast<std::size_t>(count));
  }
  if (lseek(file.get(), 0, SEEK_SET) != 0) return core::fail(system_error("lseek"));
  return file;
}

core::Result<std::string> read_memory_file(const core::OpenFile& file, std::size_t max_bytes) {
  const off_t size = lseek(file.get(), 0, SEEK_END);
  if (size < 0) return core::fail(system_error("lseek"));
  if (static_cast<std::size_t>(size) > max_bytes)
    return core::fail(core::ErrorCode::kResourceExhausted,
                      fmt::format("an answer of {} bytes, more than {}", size, max_bytes));
  std::string content(static_cast<std::size_t>(size), '\0');
  std::size_t done = 0;
  while (done < content.size()) {
    const ssize_t count =
        pread(file.get(), content.data() + done, content.size() - done, static_cast<off_t>(done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return core::fail(system_error("reading a file in memory"));
    done += static_cast<std::size_t>(count);
  }
  return content;
}

}  // namespace tessera::sandbox
