// SPDX-License-Identifier: Apache-2.0
// A file of large blocks of bytes and one index, protected by checksums (XXH3, 128 bits), written and read
// by several threads. It appears under its name only when it is complete. Files of another version, of a
// machine with another byte order, and damaged or truncated files are rejected.
//
// Layout: a header of fixed size, the blocks one after another, the index. Blocks are verified in pieces,
// whose checksums are at the start of the index; the header has the checksum of the index.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/open_file.hpp"

namespace tessera::core {

struct Checksum {
  std::uint64_t low = 0, high = 0;
  bool operator==(const Checksum&) const = default;
};

Checksum checksum_of(std::span<const std::byte> bytes);

// 32 hexadecimal digits.
std::string to_hex(const Checksum& checksum);

// Reads all bytes of `into` from `offset` on; returns false if there are fewer or the read fails.
bool read_at(int file, std::span<std::byte> into, std::uint64_t offset);
// Returns false with errno set unless all bytes are written.
bool write_at(int file, std::span<const std::byte> bytes, std::uint64_t offset);

class BlockFileWriter {
 public:
  // Writes to a file beside `path`, which finish() renames to `path`; without finish(), nothing is left
  // behind. Errors name the file and the reason; finish() also reports errors of earlier calls.
  static Result<BlockFileWriter> create(const std::string& path, const Checksum& version, int threads);
  // Writes to an open file, which must be empty and keeps its name. Errors call it `name`.
  static BlockFileWriter to(OpenFile file, const std::string& name, const Checksum& version, int threads);
  BlockFileWriter(BlockFileWriter&&) noexcept = default;
  ~BlockFileWriter();

  // Gives the file this size before it is written, so that others count it when they make room. It may end up
  // larger or smaller.
  void reserve(std::uint64_t bytes);
  void write_block(std::span<const std::byte> bytes);
  Status finish(std::span<const std::byte> index);

 private:
  BlockFileWriter(std::string path, std::string partial_path, OpenFile file, const Checksum& version,
                  int threads);
  Status write_all(std::span<const std::byte> index);

  std::string path_;          // empty: the file is not renamed
  std::string partial_path_;  // what it is called until then
  OpenFile file_;
  Checksum version_;
  int threads_;
  std::uint64_t size_;
  std::uint64_t reserved_ = 0;
  std::vector<Checksum> pieces_;
  int error_ = 0;  // errno of the first failure
};

class BlockFileReader {
 public:
  // Errors describe the defect of the file: kNotFound if it is missing, else kDataLoss.
  static Result<BlockFileReader> open(const std::string& path, const Checksum& version, int threads);
  // The same for an open file. Errors call it `name`.
  static Result<BlockFileReader> of(OpenFile file, const std::string& name, const Checksum& version,
                                    int threads);

  std::span<const std::byte> index() const { return index_; }

  // The number of bytes of blocks not yet read.
  std::uint64_t bytes_left() const { return blocks_end_ - next_; }

  // Reads the next block, which has this size. Returns false if it differs from what was written.
  bool read_block(std::span<std::byte> into);

 private:
  BlockFileReader() = default;

  OpenFile file_;
  int threads_ = 1;
  std::uint64_t next_ = 0, blocks_end_ = 0;
  std::vector<Checksum> pieces_;
  std::size_t next_piece_ = 0;
  std::vector<std::byte> index_;
};

}  // namespace tessera::core
