// SPDX-License-Identifier: Apache-2.0
// A temporary file without a name, whose space is free again when the object is destroyed, also by a crash.
// On a full disk it moves into memory, if it is no larger than kMaxInMemory, so that images can be fetched
// all the same. For one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/error.hpp"
#include "server/base/file.hpp"

namespace tessera::base {

class ScratchFile {
 public:
  static constexpr std::uint64_t kMaxInMemory = std::uint64_t{256} << 20;

  // In this folder, which must exist. Errors are those of errno_error().
  static core::Result<ScratchFile> make(const std::filesystem::path& folder);

  core::Status write_at(std::uint64_t offset, std::string_view bytes);
  // At most so many bytes; fewer at the end of the file.
  core::Result<std::string> read_at(std::uint64_t offset, std::size_t bytes) const;

 private:
  ScratchFile(Fd file, std::filesystem::path folder) : file_(std::move(file)), folder_(std::move(folder)) {}
  core::Status write_all(std::uint64_t offset, std::string_view bytes);
  // Whether it is in memory now.
  bool move_into_memory();

  Fd file_;
  std::filesystem::path folder_;  // for messages
  std::uint64_t size_ = 0;
  bool is_in_memory_ = false;
};

}  // namespace tessera::base
