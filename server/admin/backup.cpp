// SPDX-License-Identifier: Apache-2.0
#include "server/admin/backup.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <set>
#include <system_error>
#include <utility>

#include "proto/blob.hpp"
#include "server/admin/backup_list.hpp"
#include "server/admin/database_copy.hpp"
#include "server/admin/state_check.hpp"
#include "server/base/file.hpp"
#include "server/farm/job_record.hpp"
#include "server/farm/validating_job.hpp"
#include "server/store/state_directory.hpp"

namespace tessera::admin {

using core::ErrorCode;

namespace {

namespace fs = std::filesystem;

constexpr const char* kRestoredName = "tessera.db.restored";
// The original may have been opened so often since the backup, and has numbered its changes and leases by
// that.
constexpr std::uint32_t kStartsSinceBackup = 1024;

// The folder in which a backup is made, beside its place. It is removed unless it was put there.
class UnfinishedBackup {
 public:
  // `backup` is absolute.
  static core::Result<UnfinishedBackup> create(const fs::path& backup) {
    const fs::path parent = backup.parent_path();
    if (auto created = base::create_folder(parent); !created) return core::fail(created.error());
    std::string path = backup.string() + ".partial-XXXXXX";
    if (::mkdtemp(path.data()) == nullptr)
      return core::fail(base::errno_error("creating a folder in", parent));
    return UnfinishedBackup(path);
  }
  UnfinishedBackup(UnfinishedBackup&& other) noexcept : path_(std::exchange(other.path_, fs::path())) {}
  UnfinishedBackup& operator=(UnfinishedBackup&&) = delete;
  ~UnfinishedBackup() {
    std::error_code ignored;  // what is left is refused by --restore
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }

  const fs::path& path() const { return path_; }
  // Makes it durable first.
  core::Status put_in_place(const fs::path& backup) {
    const base::Fd folder(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!folder || ::syncfs(folder.get()) != 0) return core::fail(base::errno_error("writing", path_));
    if (::rename(path_.c_str(), backup.c_str()) != 0)
      return core::fail(base::errno_error("renaming " + path_.string() + " to", backup));
    path_.clear();
    return base::sync_folder(backup.parent_path());
  }

 private:
  explicit UnfinishedBackup(fs::path path) : path_(std::move(path)) {}

  fs::path path_;
};

// Without a slash at its end, beside which its unfinished form has a name.
fs::path place_of(const fs::path& backup) {
  const fs::path place = fs::absolute(backup).lexically_normal();
  return place.has_filename() ? place : place.parent_path();
}

core::Status expect_no_folder(const fs::path& backup) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(backup, error))) return {};
  return core::fail(ErrorCode::kFailedPrecondition,
                    fmt::format("{} exists already: name a new folder for the backup", backup.string()));
}

core::Result<std::set<proto::Digest>> files_of_jobs(const fs::path& database) {
  auto jobs = store::JobStore::open_read_only(database);
  if (!jobs) return core::fail(jobs.error());
  const auto readable = jobs->readable_jobs();
  if (!readable) return core::fail(readable.error());
  std::set<proto::Digest> files;
  for (const store::JobRow& row : readable->rows) {
    const auto job = farm::spec_from_row(row);
    if (!job) continue;
    for (const v1::Bundle::Asset& asset : (*job)->bundle().assets())
      if (const auto digest = proto::from_proto(asset.digest())) files.insert(*digest);
  }
  return files;
}

bool is_on_another_file_system(int error) {
  return error == EXDEV || error == EPERM || error == EMLINK || error == EOPNOTSUPP;
}

core::Status copy_blob(const blobs::BlobStore& from, const blobs::BlobStore& to,
                       const proto::Digest& digest) {
  auto reader = from.read(digest);
  if (!reader) return core::fail(reader.error());
  auto writer = to.write(digest);
  if (!writer) return core::fail(writer.error());
  while (true) {
    const auto bytes = reader->next(proto::kMaxChunkBytes);
    if (!bytes) return core::fail(bytes.error());
    if (bytes->empty()) return writer->commit();
    if (auto written = writer->append(*bytes); !written) return written;
  }
}

// Blobs never change, so both may be the same file.
core::Status link_or_copy(const blobs::BlobStore& from, const blobs::BlobStore& to,
                          const proto::Digest& digest) {
  const fs::path file = to.path(digest);
  if (auto created = base::create_folder(file.parent_path()); !created) return created;
  if (::link(from.path(digest).c_str(), file.c_str()) == 0) {
    const core::Status intact = to.check(digest);
    if (!intact) to.discard(digest);
    return intact;
  }
  if (errno == ENOENT || is_on_another_file_system(errno)) return copy_blob(from, to, digest);
  return core::fail(base::errno_error("linking " + from.path(digest).string() + " to", file));
}

bool is_lost(const core::Status& taken) {
  return !taken && (taken.error().code == ErrorCode::kNotFound || taken.error().code == ErrorCode::kDataLoss);
}

// Adds the result for each blob that was not taken yet. Fails at an error that says nothing about a blob.
core::Status take_blobs(const blobs::BlobStore& from, const blobs::BlobStore& to,
                        const std::set<proto::Digest>& digests, BlobStates& taken) {
  for (const proto::Digest& digest : digests) {
    const auto known = taken.find(digest.hex());
    if (known != taken.end() && known->second) continue;
    core::Status status = link_or_copy(from, to, digest);
    if (!status && !is_lost(status)) return status;
    taken.insert_or_assign(digest.hex(), std::move(status));
  }
  return {};
}

std::set<proto::Digest> lost_of(const std::set<proto::Digest>& digests, const BlobStates& taken) {
  std::set<proto::Digest> lost;
  for (const proto::Digest& digest : digests)
    if (!taken.at(digest.hex())) lost.insert(digest);
  return lost;
}

// A job may be deleted with its files after the database was copied. So the copy is made again until it names
// no other lost files than the one before.
core::Result<BlobStates> take_state(const fs::path& state, const fs::path& copy) {
  const fs::path database = copy / store::kDatabaseName;
  const auto from = blobs::BlobStore::look_at(state / store::kBlobsName);
  const auto to = blobs::BlobStore::open(copy / store::kBlobsName);
  if (!to) return core::fail(to.error());
  BlobStates taken;
  std::set<proto::Digest> lost, lost_before;
  do {
    lost_before = std::exchange(lost, {});
    remove_database(database);
    if (auto copied = store::copy_database(state, database); !copied) return core::fail(copied.error());
    const auto digests = files_of_jobs(database);
    if (!digests) return core::fail(digests.error());
    if (auto done = take_blobs(from, *to, *digests, taken); !done) return core::fail(done.error());
    lost = lost_of(*digests, taken);
  } while (lost != lost_before);
  return taken;
}

// The files of the backup: the database, and the blobs that are intact.
core::Result<BackupFiles> list_files(const fs::path& copy, const BlobStates& taken) {
  const auto digest = digest_of_file(copy / store::kDatabaseName);
  if (!digest) return core::fail(digest.error());
  BackupFiles files{{store::kDatabaseName, digest->hex()}};
  for (const auto& [hex, state] : taken)
    if (state) files.emplace(blob_path(hex), hex);
  return files;
}

std::vector<std::string> damage_of(const std::vector<JobFindings>& jobs) {
  std::vector<std::string> damage;
  for (const JobFindings& job : jobs)
    for (const std::string& each : job.damage) damage.push_back(fmt::format("job {}: {}", job.id, each));
  return damage;
}

core::Status copy_blobs(const fs::path& backup, const blobs::BlobStore& to, const BackupFiles& files) {
  const auto from = blobs::BlobStore::look_at(backup / store::kBlobsName);
  for (const auto& [path, hex] : files) {
    if (path == store::kDatabaseName) continue;
    std::error_code error;
    const auto digest = proto::digest_from_hex(hex, fs::file_size(backup / path, error));
    if (error || !digest) return core::fail(ErrorCode::kNotFound, (backup / path).string() + " is missing");
    if (auto copied = copy_blob(from, to, *digest); !copied) return copied;
  }
  return {};
}

// Makes the copy a database of its own, whose changes and leases have other numbers than those of the
// original.
core::Status renumber(const fs::path& database) {
  {
    auto jobs = store::JobStore::open(database, false);
    if (!jobs) return core::fail(jobs.error());
    if (auto later = jobs->continue_from(jobs->epoch() + kStartsSinceBackup); !later) return later;
    if (auto whole = jobs->truncate_wal(); !whole) return whole;
  }
  return expect_empty_log(database);
}

core::Status restore_database(const fs::path& backup, const fs::path& state) {
  const fs::path copy = state / kRestoredName, database = state / store::kDatabaseName;
  remove_database(copy);
  std::error_code error;
  fs::copy_file(backup / store::kDatabaseName, copy, error);
  if (error)
    return core::fail(ErrorCode::kInternal, fmt::format("writing {}: {}", copy.string(), error.message()));
  fs::permissions(copy, fs::perms::owner_read | fs::perms::owner_write, error);
  core::Status done = renumber(copy);
  if (done && ::rename(copy.c_str(), database.c_str()) != 0)
    done = core::fail(base::errno_error("renaming " + copy.string() + " to", database));
  remove_database(copy);  // does nothing if it was put in place
  return done ? base::sync_folder(state) : done;
}

}  // namespace

core::Result<Backup> back_up_state(const fs::path& state, const fs::path& backup) {
  const fs::path place = place_of(backup);
  if (auto is_new = expect_no_folder(place); !is_new) return core::fail(is_new.error());
  auto unfinished = UnfinishedBackup::create(place);
  if (!unfinished) return core::fail(unfinished.error());
  const auto taken = take_state(state, unfinished->path());
  if (!taken) return core::fail(taken.error());
  const StateFindings findings = check_database(unfinished->path() / store::kDatabaseName, *taken);
  if (!findings.damage.empty())
    return core::fail(ErrorCode::kDataLoss,
                      fmt::format("the database of {} is damaged ({}): nothing was backed up", state.string(),
                                  findings.damage.front()));
  const auto files = list_files(unfinished->path(), *taken);
  if (!files) return core::fail(files.error());
  if (auto listed = write_backup_list(unfinished->path(), *files); !listed) return core::fail(listed.error());
  if (auto placed = unfinished->put_in_place(place); !placed) return core::fail(placed.error());
  return Backup{findings.jobs.size(), files->size() - 1, damage_of(findings.jobs)};
}

core::Result<std::size_t> restore_state(const fs::path& backup, const fs::path& state) {
  const auto files = read_whole_backup(backup);
  if (!files) return core::fail(files.error());
  const auto lock = store::lock_new_state(state);
  if (!lock) return core::fail(lock.error());
  const auto blobs = blobs::BlobStore::open(state / store::kBlobsName);
  if (!blobs) return core::fail(blobs.error());
  if (auto copied = copy_blobs(backup, *blobs, *files); !copied) return core::fail(copied.error());
  if (auto restored = restore_database(backup, state); !restored) return core::fail(restored.error());
  return files->size() - 1;
}

}  // namespace tessera::admin
