// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/asset_source.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <new>
#include <system_error>

#include "core/base/printable.hpp"
#include "core/scene/loader/file_names.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

namespace fs = std::filesystem;

// Larger files are not meshes or images but mistakes, and reading one could exhaust memory.
constexpr std::uintmax_t kMaxAssetBytes = std::uintmax_t{8} << 30;

Result<std::string> read_open(const OpenFile& file, const std::string& shown) {
  const auto unreadable = [&shown] {
    return fail(ErrorCode::kUnavailable, fmt::format("{} cannot be read: {}", shown, std::strerror(errno)));
  };
  const off_t size = ::lseek(file.get(), 0, SEEK_END);
  if (size < 0) return unreadable();
  if (static_cast<std::uintmax_t>(size) > kMaxAssetBytes)
    return fail(ErrorCode::kResourceExhausted,
                fmt::format("{} has {} bytes, more than the {} that a scene's file may have", shown, size,
                            kMaxAssetBytes));
  std::string bytes(static_cast<std::size_t>(size), '\0');
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count =
        ::pread(file.get(), bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return unreadable();
    if (count == 0) return fail(ErrorCode::kUnavailable, shown + " cannot be read to its end");
    done += static_cast<std::size_t>(count);
  }
  return bytes;
}

Result<std::string> read_path(const fs::path& path, const std::string& shown) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) return fail(ErrorCode::kNotFound, shown + " does not exist");
  if (error)
    return fail(ErrorCode::kPermissionDenied, fmt::format("{} cannot be read: {}", shown, error.message()));
  if (fs::is_directory(status)) return fail(ErrorCode::kInvalidArgument, shown + " is a folder, not a file");
  if (!fs::is_regular_file(status))
    return fail(ErrorCode::kInvalidArgument, shown + " is not an ordinary file");
  const OpenFile file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.valid())
    return fail(ErrorCode::kPermissionDenied,
                fmt::format("{} cannot be opened: {}", shown, std::strerror(errno)));
  return read_open(file, shown);
}

template <typename Read>
Result<std::string> guarded(const std::string& shown, const Read& read) {
  try {
    return read();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kResourceExhausted, shown + " does not fit into memory");
  } catch (const std::exception& exception) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("{} cannot be read: {}", shown, exception.what()));
  }
}

// A name must not contain NUL, where the system would truncate it.
bool is_name(const std::string& path) {
  return !path.empty() && path.find('\0') == std::string::npos;
}

constexpr std::size_t kMaxFits = 2;  // of find_in_any_spelling()

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

// Removes doubled slashes, so that equal paths are equal strings.
std::string without_doubled_slashes(const fs::path& path) {
  fs::path parts;
  for (const fs::path& part : path) parts /= part;
  return parts.string();
}

// The paths of `folder`'s entries that are called `name` in any spelling.
void find_entries(const fs::path& root, const fs::path& folder, const std::string& name,
                  std::vector<fs::path>& found) {
  std::error_code error;
  for (fs::directory_iterator entry(root / folder, error), end; !error && entry != end;
       entry.increment(error))
    if (are_same_names(entry->path().filename().string(), name))
      found.push_back(folder / entry->path().filename());
}

}  // namespace

Result<std::string> read_asset(const std::string& path, const std::string& shown) {
  return guarded(shown, [&] { return read_path(path, shown); });
}

Result<std::string> read_asset(const OpenFile& file, const std::string& shown) {
  return guarded(shown, [&] { return read_open(file, shown); });
}

bool FolderAssets::exists(const std::string& path) {
  return is_name(path) && is_file(fs::path(folder_.empty() ? "." : folder_) / path);
}

std::vector<std::string> FolderAssets::find_in_any_spelling(const std::string& path) {
  constexpr std::size_t kMaxFolders = 64;
  const fs::path root = folder_.empty() ? "." : folder_;
  if (!is_name(path)) return {};
  std::vector<fs::path> paths{""};
  for (const fs::path& part : fs::path(path)) {
    std::vector<fs::path> next;
    for (const fs::path& folder : paths) {
      if (part.is_absolute() || part == "." || part == "..")
        next.push_back(folder / part);
      else
        find_entries(root, folder, part.string(), next);
    }
    paths = std::move(next);
    if (paths.size() > kMaxFolders) return {};
  }
  std::vector<std::string> files;
  for (const fs::path& found : paths)
    if (is_file(root / found)) files.push_back(found.string());
  std::sort(files.begin(), files.end());
  files.resize(std::min(files.size(), kMaxFits));
  return files;
}

Result<std::string> FolderAssets::read(const std::string& path) {
  const std::string folder = folder_.empty() ? "." : folder_;
  if (!is_name(path))
    return fail(ErrorCode::kInvalidArgument, in_quotes(path) + " is not the name of a file");
  const std::string shown = folder == "."
                                ? in_quotes(path)
                                : fmt::format("{} in the folder {}", in_quotes(path), in_quotes(folder));
  return read_asset((fs::path(folder) / path).string(), shown);
}

bool BundleAssets::exists(const std::string& path) {
  return names_.contains(printable(path));
}

std::vector<std::string> BundleAssets::find_in_any_spelling(const std::string& path) {
  if (by_key_.empty())
    for (const std::string& name : names_)
      if (without_doubled_slashes(name) == name) by_key_[spelling_key(name)].push_back(name);
  const std::string wanted = printable(without_doubled_slashes(path));
  std::vector<std::string> files;
  if (const auto found = by_key_.find(spelling_key(wanted)); found != by_key_.end())
    std::ranges::copy_if(found->second, std::back_inserter(files),
                         [&](const std::string& name) { return are_same_names(name, wanted); });
  files.resize(std::min(files.size(), kMaxFits));
  return files;
}

Result<std::string> BundleAssets::read(const std::string& path) {
  const auto name = names_.find(printable(path));
  if (name == names_.end())
    return fail(ErrorCode::kNotFound, in_quotes(path) + " is not in the scene's bundle");
  return read_(*name, in_quotes(path));
}

bool RecordingAssets::exists(const std::string& path) {
  return inner_.exists(path);
}

std::vector<std::string> RecordingAssets::find_in_any_spelling(const std::string& path) {
  auto files = inner_.find_in_any_spelling(path);
  if (files.size() > 1)
    for (const std::string& file : files) static_cast<void>(read(file));
  return files;
}

Result<std::string> RecordingAssets::read(const std::string& path) {
  auto bytes = inner_.read(path);
  if (bytes) on_read_(path, *bytes);
  return bytes;
}

}  // namespace tessera::core
