// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cache/source_files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <iterator>
#include <span>

#include "core/base/parallel_errors.hpp"

namespace tessera::core::stored {
namespace {

constexpr std::size_t kPieceBytes = 4u << 20;

// The checksum of the pieces' checksums. `piece` computes that of the bytes from an offset on, or fails.
template <typename Piece>
std::optional<Checksum> checksum_of_pieces(std::size_t bytes, int threads, const Piece& piece) {
  std::vector<Checksum> checksums((bytes + kPieceBytes - 1) / kPieceBytes);
  std::atomic<bool> good{true};
  ParallelErrors errors;
#pragma omp parallel for num_threads(threads) schedule(dynamic)
  for (std::size_t i = 0; i < checksums.size(); ++i) {
    errors.run([&] {
      const std::size_t begin = i * kPieceBytes;
      const std::optional<Checksum> one = piece(begin, std::min(kPieceBytes, bytes - begin));
      if (one) checksums[i] = *one;
      if (!one) good = false;
    });
  }
  errors.rethrow();
  if (!good) return std::nullopt;
  return checksum_of(std::as_bytes(std::span(checksums)));
}

}  // namespace

std::optional<Checksum> checksum_of_file(const std::string& path, int threads) {
  const OpenFile file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (!file.valid() || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return checksum_of_pieces(static_cast<std::size_t>(status.st_size), threads,
                            [&](std::size_t begin, std::size_t size) -> std::optional<Checksum> {
                              std::vector<std::byte> bytes(size);
                              if (!read_at(file.get(), bytes, begin)) return std::nullopt;
                              return checksum_of(bytes);
                            });
}

Checksum checksum_of_contents(std::string_view bytes, int threads) {
  const auto all = std::as_bytes(std::span(bytes));
  return *checksum_of_pieces(bytes.size(), threads, [&](std::size_t begin, std::size_t size) {
    return std::optional(checksum_of(all.subspan(begin, size)));
  });
}

SourceFiles as_they_are(SourceFiles files, const std::string& folder, int threads) {
  for (SourceFile& file : files) {
    const auto checksum = checksum_of_file(std::filesystem::path(folder) / file.path, threads);
    file.is_there = checksum.has_value();
    file.checksum = checksum.value_or(Checksum{});
  }
  return files;
}

bool RecordedAssets::exists(const std::string& path) {
  const bool is_there = inner_.exists(path);
  if (!is_there) files_.emplace(path, SourceFile{path, false, {}});
  return is_there;
}

std::vector<std::string> RecordedAssets::find_in_any_spelling(const std::string& path) {
  has_searched_ = true;
  return inner_.find_in_any_spelling(path);
}

Result<std::string> RecordedAssets::read(const std::string& path) {
  auto bytes = inner_.read(path);
  const SourceFile read{path, bytes.has_value(), bytes ? checksum_of_contents(*bytes, threads_) : Checksum{}};
  const auto [known, is_new] = files_.emplace(path, read);
  consistent_ = consistent_ && known->second == read;
  return bytes;
}

SourceFiles RecordedAssets::files() const {
  SourceFiles files;
  for (const auto& [path, file] : files_) files.push_back(file);
  return files;
}

std::string key_of(const SourceFiles& files) {
  std::string text;
  for (const SourceFile& file : files)
    fmt::format_to(std::back_inserter(text), "{} {} {} {}\n", file.path.size(), file.path, file.is_there,
                   to_hex(file.checksum));
  return text;
}

}  // namespace tessera::core::stored
