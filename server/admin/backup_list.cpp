// SPDX-License-Identifier: Apache-2.0
#include "server/admin/backup_list.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "server/base/file.hpp"
#include "server/store/state_directory.hpp"

namespace tessera::admin {

using core::ErrorCode;

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDigits = 64;
constexpr std::string_view kGap = "  ";  // between digest and path

std::string header_of(std::size_t files) {
  return fmt::format("# tessera backup 1: {} files", files);
}

core::Error unusable(const fs::path& backup, const std::string& what) {
  return {ErrorCode::kDataLoss,
          fmt::format("the backup {} is not whole: {}: copy it again, or use another backup", backup.string(),
                      what)};
}

// A line of the list; empty if it is damaged. No path leaves the backup.
std::optional<std::pair<std::string, std::string>> read_line(std::string_view line) {
  const std::string_view digits = line.substr(0, kDigits);
  if (line.size() <= kDigits + kGap.size() || line.substr(kDigits, kGap.size()) != kGap) return std::nullopt;
  if (!proto::digest_from_hex(digits, 0)) return std::nullopt;
  std::string path(line.substr(kDigits + kGap.size()));
  const bool is_database = path == store::kDatabaseName;
  const bool is_blob = path == blob_path(digits);
  if (!is_database && !is_blob) return std::nullopt;
  return std::pair(std::move(path), std::string(digits));
}

core::Result<BackupFiles> read_list(const fs::path& backup) {
  std::ifstream file(backup / store::kBackupListName, std::ios::binary);
  if (!file)
    return core::fail(ErrorCode::kNotFound,
                      fmt::format("{} is no backup, since it has no {}: name a folder that --backup has made",
                                  backup.string(), store::kBackupListName));
  const core::Error damaged = unusable(backup, fmt::format("{} is damaged", store::kBackupListName));
  std::string header;
  std::getline(file, header);
  BackupFiles files;
  for (std::string line; std::getline(file, line);) {
    auto read = read_line(line);
    if (!read) return core::fail(damaged);
    files.insert(*std::move(read));
  }
  if (header != header_of(files.size()) || !files.contains(store::kDatabaseName)) return core::fail(damaged);
  return files;
}

}  // namespace

bool is_backup(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / store::kBackupListName, error);
}

std::string blob_path(std::string_view digits) {
  return fmt::format("{}/{}/{}", store::kBlobsName, digits.substr(0, 2), digits.substr(2));
}

core::Result<proto::Digest> digest_of_file(const fs::path& file) {
  const base::Fd fd(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (!fd) return core::fail(base::errno_error("opening", file));
  proto::Hasher hasher;
  std::string buffer(proto::kMaxChunkBytes, '\0');
  while (true) {
    const ssize_t got = ::read(fd.get(), buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return core::fail(base::errno_error("reading", file));
    if (got == 0) return hasher.finish();
    hasher.update(std::string_view(buffer).substr(0, static_cast<std::size_t>(got)));
  }
}

core::Status write_backup_list(const fs::path& backup, const BackupFiles& files) {
  std::string text = header_of(files.size()) + "\n";
  for (const auto& [path, digits] : files) text += fmt::format("{}{}{}\n", digits, kGap, path);
  const fs::path list = backup / store::kBackupListName;
  const base::Fd fd(::open(list.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  if (!fd) return core::fail(base::errno_error("creating", list));
  if (auto written = base::write_all(fd, text, list); !written) return written;
  return base::sync_file(fd, list);
}

core::Result<BackupFiles> read_whole_backup(const fs::path& backup) {
  auto files = read_list(backup);
  if (!files) return files;
  for (const auto& [path, digits] : *files) {
    const auto digest = digest_of_file(backup / path);
    if (!digest && digest.error().code == ErrorCode::kNotFound)
      return core::fail(unusable(backup, path + " is missing"));
    if (!digest) return core::fail(digest.error());
    if (digest->hex() != digits) return core::fail(unusable(backup, path + " is damaged"));
  }
  return files;
}

}  // namespace tessera::admin
