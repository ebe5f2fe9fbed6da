// SPDX-License-Identifier: Apache-2.0
#include "server/blobs/blob_store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>
#include <vector>

namespace tessera::blobs {

using core::ErrorCode;

namespace {

constexpr const char* kIncoming = "incoming";

// The entries of a folder, as far as they can be read.
std::vector<std::filesystem::path> paths_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    paths.push_back(entry->path());
  }
  return paths;
}

bool is_whole(const struct ::stat& status, const proto::Digest& digest) {
  return S_ISREG(status.st_mode) && static_cast<std::uint64_t>(status.st_size) == digest.size_bytes;
}

core::Error not_here(const proto::Digest& digest) {
  return {ErrorCode::kNotFound,
          fmt::format("blob {} ({} bytes) is not here: upload it", digest.hex(), digest.size_bytes)};
}

// The file of a blob in the store's folder.
std::filesystem::path file_of(const std::filesystem::path& folder, const proto::Digest& digest) {
  const std::string hex = digest.hex();
  return folder / hex.substr(0, 2) / hex.substr(2);
}

}  // namespace

BlobWriter::BlobWriter(Parts parts) : parts_(std::move(parts)) {}

BlobWriter::~BlobWriter() {
  if (parts_.fd) ::unlink(parts_.temporary.c_str());
}

core::Status BlobWriter::append(std::string_view bytes) {
  const proto::Digest& digest = parts_.digest;
  if (bytes.size() > digest.size_bytes - hasher_.size_bytes()) {
    return core::fail(
        ErrorCode::kInvalidArgument,
        fmt::format("blob {}: more bytes than the {} its digest says", digest.hex(), digest.size_bytes));
  }
  hasher_.update(bytes);
  auto written = base::write_all(parts_.fd, bytes, parts_.temporary);
  failed_ = !written;
  return written;
}

core::Result<proto::Digest> BlobWriter::name_by_content() {
  if (!is_whole())
    return core::fail(ErrorCode::kDataLoss, fmt::format("{} of the {} bytes were received: send them again",
                                                        written_bytes(), parts_.digest.size_bytes));
  is_named_by_content_ = true;
  return parts_.digest = hasher_.finish();
}

core::Status BlobWriter::commit() {
  const proto::Digest actual = is_named_by_content_ ? parts_.digest : hasher_.finish();
  if (actual != parts_.digest) {
    return core::fail(
        ErrorCode::kDataLoss,
        fmt::format("blob {}: the {} bytes that came are not those of its digest ({} bytes): send it "
                    "again, and check that the file is not being written to",
                    parts_.digest.hex(), actual.size_bytes, parts_.digest.size_bytes));
  }
  const std::filesystem::path folder = file_of(parts_.folder, parts_.digest).parent_path();
  if (auto synced = base::sync_file(parts_.fd, parts_.temporary); !synced) return synced;
  if (auto created = base::create_folder(folder); !created) return created;
  if (auto named = take_name(); !named) return named;
  return base::sync_folder(folder);
}

core::Status BlobWriter::take_name() {
  const core::MutexLock lock(parts_.index->mutex);
  const std::filesystem::path target = file_of(parts_.folder, parts_.digest);
  if (::rename(parts_.temporary.c_str(), target.c_str()) != 0)
    return core::fail(base::errno_error("writing", target));
  parts_.fd = base::Fd();
  parts_.index->blobs.insert_or_assign(parts_.digest.hex(),
                                       StoreIndex::Blob{parts_.digest, std::move(parts_.charge)});
  return {};
}

BlobReader::BlobReader(proto::Digest digest, std::filesystem::path path, base::Fd fd)
    : digest_(digest), path_(std::move(path)), fd_(std::move(fd)), left_bytes_(digest.size_bytes) {}

core::Status BlobReader::limit_to(std::uint64_t offset_bytes, std::uint64_t size_bytes) {
  if (::lseek(fd_.get(), static_cast<off_t>(offset_bytes), SEEK_SET) < 0)
    return core::fail(base::errno_error("reading", path_));
  is_part_ = size_bytes < digest_.size_bytes;
  left_bytes_ = size_bytes;
  return {};
}

core::Result<std::string> BlobReader::next(std::size_t max_bytes) {
  std::string bytes(std::min<std::uint64_t>(max_bytes, left_bytes_), '\0');
  if (bytes.empty()) return bytes;
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t got = ::read(fd_.get(), bytes.data() + filled, bytes.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return core::fail(base::errno_error("reading", path_));
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
  }
  hasher_.update(bytes);
  left_bytes_ -= bytes.size();
  if (left_bytes_ == 0) read_digest_ = hasher_.finish();
  if (filled == bytes.size() && (left_bytes_ > 0 || is_part_ || read_digest_ == digest_)) return bytes;
  return core::fail(ErrorCode::kDataLoss,
                    fmt::format("{} is damaged: its content is not what its name says", path_.string()));
}

core::Result<BlobStore> BlobStore::open(const std::filesystem::path& folder) {
  const std::filesystem::path incoming = folder / kIncoming;
  std::error_code ignored;  // creating it again reports what could not be removed
  std::filesystem::remove_all(incoming, ignored);
  if (auto created = base::create_folder(incoming); !created) return core::fail(created.error());
  BlobStore store(folder);
  const core::MutexLock lock(store.index_->mutex);
  for (const proto::Digest& digest : store.list()) store.index_->blobs[digest.hex()].digest = digest;
  return store;
}

std::vector<proto::Digest> BlobStore::stored() const {
  const core::MutexLock lock(index_->mutex);
  std::vector<proto::Digest> digests;
  digests.reserve(index_->blobs.size());
  for (const auto& [hex, blob] : index_->blobs) digests.push_back(blob.digest);
  return digests;
}

void BlobStore::charge(const proto::Digest& digest, Charge charge) const {
  const core::MutexLock lock(index_->mutex);
  const auto known = index_->blobs.find(digest.hex());
  if (known != index_->blobs.end()) known->second.charge = std::move(charge);
}

std::optional<std::filesystem::file_time_type> BlobStore::last_used(const proto::Digest& digest) const {
  std::error_code error;
  const auto used = std::filesystem::last_write_time(path(digest), error);
  if (error) return std::nullopt;
  return used;
}

std::filesystem::path BlobStore::path(const proto::Digest& digest) const {
  return file_of(folder_, digest);
}

bool BlobStore::contains(const proto::Digest& digest) const {
  struct ::stat status {};
  return ::stat(path(digest).c_str(), &status) == 0 && is_whole(status, digest);
}

core::Result<BlobWriter> BlobStore::write(const proto::Digest& digest, Charge charge) const {
  std::string temporary = (folder_ / kIncoming / "XXXXXX").string();
  base::Fd fd(::mkostemp(temporary.data(), O_CLOEXEC));
  if (!fd) return core::fail(base::errno_error("creating a file in", folder_ / kIncoming));
  return BlobWriter({digest, folder_, std::move(temporary), std::move(charge), index_, std::move(fd)});
}

core::Result<BlobReader> BlobStore::read(const proto::Digest& digest) const {
  const std::filesystem::path file = path(digest);
  base::Fd fd(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (!fd && errno == ENOENT) return core::fail(not_here(digest));
  // Other errors say nothing about the blob, and may be temporary.
  if (!fd) return core::fail(ErrorCode::kInternal, base::errno_error("opening", file).message);
  struct ::stat status {};
  if (::fstat(fd.get(), &status) != 0)
    return core::fail(ErrorCode::kInternal, base::errno_error("looking at", file).message);
  if (!is_whole(status, digest)) return core::fail(not_here(digest));
  return BlobReader(digest, file, std::move(fd));
}

core::Status BlobStore::check(const proto::Digest& digest, const std::stop_token& stop) const {
  auto reader = read(digest);
  if (!reader) return core::fail(reader.error());
  while (true) {
    if (stop.stop_requested())
      return core::fail(ErrorCode::kUnavailable, "the coordinator is stopping: try again");
    const auto bytes = reader->next(proto::kMaxChunkBytes);
    if (!bytes) return core::fail(bytes.error());
    if (bytes->empty()) return {};
  }
}

core::Status BlobStore::verify(const proto::Digest& digest, const std::stop_token& stop) const {
  if (auto intact = check(digest, stop); !intact) return intact;
  ::utimensat(AT_FDCWD, path(digest).c_str(), nullptr,
              0);  // at worst, the blob is removed too early and uploaded again
  return {};
}

std::vector<proto::Digest> BlobStore::list() const {
  std::vector<proto::Digest> digests;
  for (const std::filesystem::path& group : paths_in(folder_)) {
    if (group.filename() == kIncoming) continue;
    for (const std::filesystem::path& blob : paths_in(group)) {
      std::error_code error;
      const auto size = std::filesystem::file_size(blob, error);
      const auto digest = proto::digest_from_hex(group.filename().string() + blob.filename().string(), size);
      if (digest && !error) digests.push_back(*digest);
    }
  }
  return digests;
}

std::vector<std::filesystem::path> BlobStore::interrupted() const {
  return paths_in(folder_ / kIncoming);
}

RemovedBlob::RemovedBlob(std::filesystem::path file, Charge charge)
    : file_(std::move(file)), charge_(std::move(charge)) {}

RemovedBlob::~RemovedBlob() {
  if (!file_.empty()) ::unlink(file_.c_str());
}

// The rename may replace an earlier file in `incoming`, which was to be deleted as well.
RemovedBlob BlobStore::take_away(const proto::Digest& digest) const {
  std::filesystem::path aside = folder_ / kIncoming / (digest.hex() + ".removed");
  const core::MutexLock lock(index_->mutex);
  if (::rename(path(digest).c_str(), aside.c_str()) != 0 && errno != ENOENT) return {{}, {}};
  const auto blob = index_->blobs.extract(digest.hex());
  return {std::move(aside), blob ? std::move(blob.mapped().charge) : Charge()};
}

}  // namespace tessera::blobs
