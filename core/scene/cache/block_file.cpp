// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cache/block_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "core/scene/cache/cache_folder.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kPieceBytes = 4u << 20;
constexpr std::array<char, 8> kMagic{'T', 'e', 's', 's', 'e', 'r', 'a', '\n'};
constexpr std::uint64_t kOrderOfBytes = 0x0102030405060708;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint64_t order_of_bytes = kOrderOfBytes;
  Checksum version;
  std::uint64_t blocks_end = 0, piece_count = 0, file_size = 0;
  Checksum index;      // of the data after the blocks: the pieces' checksums and the index
  Checksum preceding;  // of the header up to here
};
static_assert(sizeof(Header) == 88 && std::has_unique_object_representations_v<Header>);

Checksum checksum_of_header(const Header& header) {
  return checksum_of(std::as_bytes(std::span(&header, 1)).first(offsetof(Header, preceding)));
}

std::size_t piece_count(std::uint64_t bytes) {
  return (bytes + kPieceBytes - 1) / kPieceBytes;
}

template <typename Byte>
std::span<Byte> piece_of(std::span<Byte> bytes, std::size_t piece) {
  const std::size_t begin = piece * kPieceBytes;
  return bytes.subspan(begin, std::min(kPieceBytes, bytes.size() - begin));
}

Error cannot_write(const std::string& path, int error) {
  return {ErrorCode::kUnavailable, fmt::format("cannot write {}: {}", path, std::strerror(error))};
}

// Whether its sections lie within the file, one after another.
bool is_sound(const Header& header) {
  return header.blocks_end >= sizeof(Header) && header.blocks_end <= header.file_size &&
         header.piece_count <= (header.file_size - header.blocks_end) / sizeof(Checksum);
}

}  // namespace

bool read_at(int file, std::span<std::byte> into, std::uint64_t offset) {
  while (!into.empty()) {
    const ssize_t count = ::pread(file, into.data(), into.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    into = into.subspan(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
  return true;
}

bool write_at(int file, std::span<const std::byte> bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
  return true;
}

Checksum checksum_of(std::span<const std::byte> bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return {hash.low64, hash.high64};
}

std::string to_hex(const Checksum& checksum) {
  return fmt::format("{:016x}{:016x}", checksum.high, checksum.low);
}

Result<BlockFileWriter> BlockFileWriter::create(const std::string& path, const Checksum& version,
                                                int threads) {
  std::string partial = partial_path_of(path);
  OpenFile file(::open(partial.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
  if (!file.valid()) return fail(cannot_write(partial, errno));
  return BlockFileWriter(path, std::move(partial), std::move(file), version, threads);
}

BlockFileWriter BlockFileWriter::to(OpenFile file, const std::string& name, const Checksum& version,
                                    int threads) {
  return BlockFileWriter("", name, std::move(file), version, threads);
}

BlockFileWriter::BlockFileWriter(std::string path, std::string partial_path, OpenFile file,
                                 const Checksum& version, int threads)
    : path_(std::move(path)),
      partial_path_(std::move(partial_path)),
      file_(std::move(file)),
      version_(version),
      threads_(threads),
      size_(sizeof(Header)) {}

BlockFileWriter::~BlockFileWriter() {
  if (file_.valid() && !path_.empty()) ::unlink(partial_path_.c_str());
}

void BlockFileWriter::reserve(std::uint64_t bytes) {
  reserved_ = std::max(bytes, size_);
  if (::ftruncate(file_.get(), static_cast<off_t>(reserved_)) != 0) error_ = errno;
}

void BlockFileWriter::write_block(std::span<const std::byte> bytes) {
  const std::size_t count = piece_count(bytes.size()), first = pieces_.size();
  pieces_.resize(first + count);
  std::atomic<int> error{error_};
#pragma omp parallel for num_threads(threads_) schedule(dynamic)
  for (std::size_t i = 0; i < count; ++i) {
    if (error != 0) continue;
    pieces_[first + i] = checksum_of(piece_of(bytes, i));
    if (!write_at(file_.get(), piece_of(bytes, i), size_ + i * kPieceBytes)) error = errno;
  }
  error_ = error;
  size_ += bytes.size();
}

Status BlockFileWriter::write_all(std::span<const std::byte> index) {
  Header header;
  header.version = version_;
  header.blocks_end = size_;
  header.piece_count = pieces_.size();
  const auto pieces = std::as_bytes(std::span(pieces_));
  std::vector<std::byte> tail(pieces.begin(), pieces.end());
  tail.insert(tail.end(), index.begin(), index.end());
  header.file_size = size_ + tail.size();
  header.index = checksum_of(tail);
  header.preceding = checksum_of_header(header);
  if (error_ != 0) return fail(cannot_write(partial_path_, error_));
  const bool fits =
      reserved_ <= header.file_size || ::ftruncate(file_.get(), static_cast<off_t>(header.file_size)) == 0;
  const bool written = fits && write_at(file_.get(), tail, size_) &&
                       write_at(file_.get(), std::as_bytes(std::span(&header, 1)), 0) &&
                       (path_.empty() || std::rename(partial_path_.c_str(), path_.c_str()) == 0);
  if (!written) return fail(cannot_write(partial_path_, errno));
  return {};
}

Status BlockFileWriter::finish(std::span<const std::byte> index) {
  if (Status written = write_all(index); !written) return written;
  const OpenFile complete = std::move(file_);  // its destructor only closes the file
  return {};
}

Result<BlockFileReader> BlockFileReader::open(const std::string& path, const Checksum& version, int threads) {
  OpenFile file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));  // never waits for a FIFO's writer
  if (file.valid()) return of(std::move(file), path, version, threads);
  if (errno == ENOENT) return fail(ErrorCode::kNotFound, path + " does not exist");
  return fail(ErrorCode::kDataLoss, fmt::format("{} cannot be opened: {}", path, std::strerror(errno)));
}

Result<BlockFileReader> BlockFileReader::of(OpenFile file, const std::string& name, const Checksum& version,
                                            int threads) {
  const auto refuse = [&](std::string_view why) {
    return fail(ErrorCode::kDataLoss, fmt::format("{} {}", name, why));
  };
  BlockFileReader reader;
  reader.threads_ = threads;
  reader.file_ = std::move(file);
  const off_t size = ::lseek(reader.file_.get(), 0, SEEK_END);  // fails for a FIFO
  Header header;
  if (size < 0 || !read_at(reader.file_.get(), std::as_writable_bytes(std::span(&header, 1)), 0))
    return refuse("cannot be read");
  if (header.magic != kMagic || header.order_of_bytes != kOrderOfBytes || header.version != version)
    return refuse("is of another version");
  if (header.preceding != checksum_of_header(header) || !is_sound(header)) return refuse("is damaged");
  if (header.file_size != static_cast<std::uint64_t>(size)) return refuse("is not complete");

  std::vector<std::byte> tail(header.file_size - header.blocks_end);
  const std::size_t pieces_bytes = header.piece_count * sizeof(Checksum);
  if (!read_at(reader.file_.get(), tail, header.blocks_end) || checksum_of(tail) != header.index)
    return refuse("is damaged");
  reader.pieces_.resize(header.piece_count);
  std::ranges::copy(std::span(tail).first(pieces_bytes),
                    std::as_writable_bytes(std::span(reader.pieces_)).begin());
  reader.index_.assign(tail.begin() + static_cast<std::ptrdiff_t>(pieces_bytes), tail.end());
  reader.next_ = sizeof(Header);
  reader.blocks_end_ = header.blocks_end;
  return reader;
}

bool BlockFileReader::read_block(std::span<std::byte> into) {
  const std::size_t count = piece_count(into.size());
  if (into.size() > blocks_end_ - next_ || count > pieces_.size() - next_piece_) return false;
  std::atomic<bool> good{true};
#pragma omp parallel for num_threads(threads_) schedule(dynamic)
  for (std::size_t i = 0; i < count; ++i) {
    const auto piece = piece_of(into, i);
    if (!good) continue;
    if (!read_at(file_.get(), piece, next_ + i * kPieceBytes) ||
        checksum_of(piece) != pieces_[next_piece_ + i])
      good = false;
  }
  next_ += into.size();
  next_piece_ += count;
  return good;
}

}  // namespace tessera::core
