// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cache/cache_folder.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

namespace tessera::core {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPartialSuffix = ".partial";
constexpr auto kAbandonedAfter = std::chrono::hours(24);

// The readable files in the folder; other processes may remove some at the same time.
std::vector<fs::directory_entry> entries_of(const std::string& folder) {
  std::vector<fs::directory_entry> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    entries.push_back(*entry);
  return entries;
}

// Whether partial_path_of() may have made this name for a file of the cache.
bool is_partial_of(const std::string& name, const IsName& is_ours) {
  if (!name.ends_with(kPartialSuffix)) return false;
  const std::string rest = name.substr(0, name.size() - kPartialSuffix.size());
  const std::size_t random_part = rest.rfind('.');
  return random_part != std::string::npos && is_ours(rest.substr(0, random_part));
}

struct CacheFile {
  fs::file_time_type used;
  std::uint64_t bytes;
  fs::path path;
};

struct CacheFiles {
  std::vector<CacheFile> removable;
  std::uint64_t total_bytes = 0;  // also of the files that stay
};

CacheFiles removable_files(const std::string& folder, const IsName& is_ours, const MustStay& must_stay) {
  CacheFiles files;
  const auto now = fs::file_time_type::clock::now();
  for (const fs::directory_entry& entry : entries_of(folder)) {
    const std::string name = entry.path().filename();
    const bool is_partial = is_partial_of(name, is_ours);
    if (!is_partial && !is_ours(name)) continue;
    std::error_code gone, unknown;
    const std::uint64_t bytes = entry.file_size(gone);
    const auto used = entry.last_write_time(unknown);
    if (gone || unknown) continue;
    files.total_bytes += bytes;
    const auto unused_for = std::chrono::duration_cast<std::chrono::seconds>(now - used);
    if (is_partial ? unused_for < kMayBeInUse : must_stay(name, unused_for)) continue;
    files.removable.push_back({used, bytes, entry.path()});
  }
  return files;
}

Error cannot_use(const std::string& folder, ErrorCode code, const std::string& why) {
  return {code, fmt::format("cannot use {}: {}", folder, why)};
}

}  // namespace

Status make_folder(const std::string& path) {
  const fs::path folder = fs::path(path).has_filename() ? fs::path(path) : fs::path(path).parent_path();
  std::error_code error;
  if (folder.has_parent_path()) fs::create_directories(folder.parent_path(), error);
  if (error) return fail(ErrorCode::kUnavailable, fmt::format("cannot create {}: {}", path, error.message()));
  if (::mkdir(folder.c_str(), S_IRWXU | S_IRGRP | S_IXGRP | S_IROTH | S_IXOTH) != 0 && errno != EEXIST)
    return fail(ErrorCode::kUnavailable, fmt::format("cannot create {}: {}", path, std::strerror(errno)));
  if (!fs::is_directory(folder, error))
    return fail(cannot_use(path, ErrorCode::kUnavailable, "it is not a folder"));
  if (::access(path.c_str(), R_OK | W_OK | X_OK) != 0)
    return fail(cannot_use(path, ErrorCode::kPermissionDenied, std::strerror(errno)));
  return {};
}

Status check_is_own(const std::string& folder) {
  struct stat status {};
  if (::stat(folder.c_str(), &status) != 0)
    return fail(cannot_use(folder, ErrorCode::kUnavailable, std::strerror(errno)));
  if (status.st_uid != ::geteuid())
    return fail(cannot_use(folder, ErrorCode::kPermissionDenied, "it belongs to another user"));
  if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0)
    return fail(
        cannot_use(folder, ErrorCode::kPermissionDenied, "others may write to it (chmod go-w mends that)"));
  return {};
}

std::string partial_path_of(const std::string& path) {
  std::array<std::uint64_t, 2> random{};
  if (::getentropy(random.data(), sizeof random) != 0) std::abort();  // fails only for invalid arguments
  return fmt::format("{}.{:016x}{:016x}{}", path, random[0], random[1], kPartialSuffix);
}

void mark_as_used(const std::string& path) {
  std::error_code ignored;  // at worst it is removed too early, and made again
  fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
}

std::uint64_t remove_least_used(const std::string& folder, std::uint64_t max_bytes, const IsName& is_ours,
                                const MustStay& must_stay) {
  CacheFiles files = removable_files(folder, is_ours, must_stay);
  std::sort(files.removable.begin(), files.removable.end(),
            [](const CacheFile& a, const CacheFile& b) { return a.used < b.used; });
  for (const CacheFile& file : files.removable) {
    if (files.total_bytes <= max_bytes) break;
    std::error_code failed;  // a file that is gone already is no failure
    fs::remove(file.path, failed);
    if (!failed) files.total_bytes -= file.bytes;
  }
  return files.total_bytes;
}

void remove_abandoned(const std::string& folder, const IsName& is_ours) {
  const auto before = fs::file_time_type::clock::now() - kAbandonedAfter;
  for (const fs::directory_entry& entry : entries_of(folder)) {
    std::error_code error;
    const auto written = entry.last_write_time(error);
    if (!error && written < before && is_partial_of(entry.path().filename(), is_ours))
      fs::remove(entry.path(), error);
  }
}

}  // namespace tessera::core
