// SPDX-License-Identifier: Apache-2.0
// A file of large blocks of bytes and one index of them, every byte under a checksum (XXH3, 128 bits),
// written and read by several threads. It appears under its name only when all of it is written. Of another
// version, of a machine with another order of bytes, damaged or cut short, it is not read but
// refused.
//
// In the file: a header of fixed size, the blocks one after another, the index. Blocks are checked in pieces,
// whose checksums the index begins with; the header has the index's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::core {

struct Checksum {
  std::uint64_t low = 0, high = 0;
  bool operator==(const Checksum&) const = default;
};

Checksum checksum_of(std::span<const std::byte> bytes);

// 32 hexadecimal digits.
std::string to_hex(const Checksum& checksum);

// An open file, closed at the end of its life.
class OpenFile {
 public:
  explicit OpenFile(int descriptor = -1) : descriptor_(descriptor) {}
  OpenFile(OpenFile&& other) noexcept;
  OpenFile& operator=(OpenFile&& other) noexcept;
  ~OpenFile();

  int get() const { return descriptor_; }
  bool valid() const { return descriptor_ >= 0; }

 private:
  int descriptor_;
};

// All of the bytes from `offset` on; false where there are not so many or they cannot be read.
bool read_at(int file, std::span<std::byte> into, std::uint64_t offset);
// False with errno set where not all could be written.
bool write_at(int file, std::span<const std::byte> bytes, std::uint64_t offset);

class BlockFileWriter {
 public:
  // Writes to a file beside `path`, which finish() gives that name; without it, nothing is left behind.
  // Errors name the file and say why, and those of later calls are told by finish().
  static Result<BlockFileWriter> create(const std::string& path, const Checksum& version, int threads);
  BlockFileWriter(BlockFileWriter&&) noexcept = default;
  ~BlockFileWriter();

  void write_block(std::span<const std::byte> bytes);
  Status finish(std::span<const std::byte> index);

 private:
  BlockFileWriter(std::string path, std::string partial_path, OpenFile file, const Checksum& version,
                  int threads);
  Status write_all(std::span<const std::byte> index);

  std::string path_, partial_path_;
  OpenFile file_;
  Checksum version_;
  int threads_;
  std::uint64_t size_;
  std::vector<Checksum> pieces_;
  int error_ = 0;  // errno of the first failure
};

class BlockFileReader {
 public:
  // Errors say what is wrong with the file: kNotFound where there is none, else kDataLoss.
  static Result<BlockFileReader> open(const std::string& path, const Checksum& version, int threads);

  std::span<const std::byte> index() const { return index_; }

  // Of the blocks that were not read yet.
  std::uint64_t bytes_left() const { return blocks_end_ - next_; }

  // The next block, which has this size. False if it is not what was written.
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
