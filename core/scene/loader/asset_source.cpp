#include "core/scene/loader/asset_source.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <system_error>

#include "core/base/printable.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

namespace fs = std::filesystem;

// `shown` is what messages call the file.
// Larger files are not meshes or pictures but mistakes, and reading one would exhaust the machine first.
constexpr std::uintmax_t kMaxAssetBytes = std::uintmax_t{8} << 30;

Result<std::string> read_regular_file(const fs::path& path, const std::string& shown) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) return fail(ErrorCode::kNotFound, shown + " does not exist");
  if (error)
    return fail(ErrorCode::kPermissionDenied, fmt::format("{} cannot be read: {}", shown, error.message()));
  if (fs::is_directory(status)) return fail(ErrorCode::kInvalidArgument, shown + " is a folder, not a file");
  if (!fs::is_regular_file(status))
    return fail(ErrorCode::kInvalidArgument, shown + " is not an ordinary file");
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return fail(ErrorCode::kPermissionDenied,
                fmt::format("{} cannot be opened: {}", shown, std::strerror(errno)));
  const std::uintmax_t size = fs::file_size(path, error);
  if (error)
    return fail(ErrorCode::kUnavailable, fmt::format("{} cannot be read: {}", shown, error.message()));
  if (size > kMaxAssetBytes)
    return fail(ErrorCode::kResourceExhausted,
                fmt::format("{} has {} bytes, more than the {} that a scene's file may have", shown, size,
                            kMaxAssetBytes));
  std::string bytes(size, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(size));
  if (file.gcount() != static_cast<std::streamsize>(size))
    return fail(ErrorCode::kUnavailable, shown + " cannot be read to its end");
  return bytes;
}

Result<std::string> read_guarded(const fs::path& path, const std::string& shown) {
  try {
    return read_regular_file(path, shown);
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kResourceExhausted, shown + " does not fit into memory");
  } catch (const std::exception& exception) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("{} cannot be read: {}", shown, exception.what()));
  }
}

}  // namespace

Result<std::string> FolderAssets::read(const std::string& path) {
  const std::string folder = folder_.empty() ? "." : folder_;
  // A name with a NUL in it would be cut short by the system.
  if (path.empty() || path.find('\0') != std::string::npos)
    return fail(ErrorCode::kInvalidArgument, in_quotes(path) + " is not the name of a file");
  const std::string shown = folder == "."
                                ? in_quotes(path)
                                : fmt::format("{} in the folder {}", in_quotes(path), in_quotes(folder));
  return read_guarded(fs::path(folder) / path, shown);
}

Result<std::string> BundleAssets::read(const std::string& path) {
  const auto blob = blob_paths_.find(printable(path));
  if (blob == blob_paths_.end())
    return fail(ErrorCode::kNotFound, in_quotes(path) + " is not in the scene's bundle");
  return read_guarded(blob->second, in_quotes(path));
}

Result<std::string> RecordingAssets::read(const std::string& path) {
  auto bytes = inner_.read(path);
  if (bytes) on_read_(path, *bytes);
  return bytes;
}

}  // namespace tessera::core
