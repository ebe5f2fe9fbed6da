#include "core/scene/cache/cache_folder.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <vector>

namespace tessera::core {
namespace {

namespace fs = std::filesystem;

constexpr auto kAbandonedAfter = std::chrono::hours(24);
constexpr auto kInUse = std::chrono::hours(1);

// The files in the folder, as far as it can be read: others may remove some at the same time.
std::vector<fs::directory_entry> entries_of(const std::string& folder) {
  std::vector<fs::directory_entry> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    entries.push_back(*entry);
  return entries;
}

}  // namespace

void mark_as_used(const std::string& path) {
  std::error_code ignored;  // at worst it is removed too early, and made again
  fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
}

void remove_least_used(const std::string& folder, std::uint64_t max_bytes,
                       const std::function<bool(const std::string& name)>& is_ours) {
  struct File {
    fs::file_time_type used;
    std::uint64_t bytes;
    fs::path path;
  };
  std::vector<File> files;
  std::uint64_t total = 0;
  for (const fs::directory_entry& entry : entries_of(folder)) {
    if (!is_ours(entry.path().filename())) continue;
    std::error_code gone, unknown;
    const std::uint64_t bytes = entry.file_size(gone);
    const auto used = entry.last_write_time(unknown);
    if (gone || unknown) continue;
    files.push_back({used, bytes, entry.path()});
    total += bytes;
  }
  std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.used < b.used; });
  const auto before = fs::file_time_type::clock::now() - kInUse;
  for (const File& file : files) {
    if (total <= max_bytes || file.used > before) return;
    std::error_code ignored;  // then it stays, or is gone already
    fs::remove(file.path, ignored);
    total -= file.bytes;
  }
}

void remove_abandoned(const std::string& folder,
                      const std::function<bool(const std::string& name)>& is_partial) {
  const auto before = fs::file_time_type::clock::now() - kAbandonedAfter;
  for (const fs::directory_entry& entry : entries_of(folder)) {
    std::error_code error;
    const auto written = entry.last_write_time(error);
    if (!error && written < before && is_partial(entry.path().filename())) fs::remove(entry.path(), error);
  }
}

}  // namespace tessera::core
