// SPDX-License-Identifier: Apache-2.0
// The source of a scene's files: a folder for a local scene, content-addressed blobs for one received over
// the network. The loader opens files only through this interface, so that a path in a remote scene is a
// name in its bundle and never a path on this machine.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::core {

class AssetSource {
 public:
  virtual ~AssetSource() = default;
  // Whether read() has a file with exactly this path.
  virtual bool exists(const std::string& path) { return read(path).has_value(); }
  // The paths of files that equal `path` ignoring ASCII case. At most two are returned, enough to detect
  // ambiguity. A source that cannot search returns only `path` itself.
  virtual std::vector<std::string> find_in_any_case(const std::string& path) {
    return exists(path) ? std::vector{path} : std::vector<std::string>();
  }
  // The bytes of the file that the scene calls `path` (relative to the scene file). The error names the
  // path and the reason.
  virtual Result<std::string> read(const std::string& path) = 0;
};

// Local files in or relative to a folder.
class FolderAssets : public AssetSource {
 public:
  explicit FolderAssets(std::string folder) : folder_(std::move(folder)) {}
  bool exists(const std::string& path) override;
  std::vector<std::string> find_in_any_case(const std::string& path) override;
  Result<std::string> read(const std::string& path) override;

 private:
  std::string folder_;
};

// The files of a bundle: names are looked up in `blob_paths`, and only those files are opened. Bundles are
// transmitted as UTF-8, so unprintable bytes of names are escaped as \xNN (core/base/printable.hpp).
class BundleAssets : public AssetSource {
 public:
  // Verifies that the bytes read are those of the bundle's file.
  using Check = std::function<Status(const std::string& path, const std::string& bytes)>;

  explicit BundleAssets(std::map<std::string, std::string> blob_paths, Check check = nullptr)
      : blob_paths_(std::move(blob_paths)), check_(std::move(check)) {}
  bool exists(const std::string& path) override;
  std::vector<std::string> find_in_any_case(const std::string& path) override;
  Result<std::string> read(const std::string& path) override;

 private:
  std::map<std::string, std::string> blob_paths_;
  std::map<std::string, std::vector<std::string>> in_lower_case_;  // filled by the first search
  Check check_;
};

// Forwards reads and reports each file, so that loading a scene determines the files of its bundle. If
// several files differ only in case, all are read, so that a search in the bundle has the same result.
class RecordingAssets : public AssetSource {
 public:
  using Observer = std::function<void(const std::string& path, const std::string& bytes)>;
  RecordingAssets(AssetSource& inner, Observer on_read) : inner_(inner), on_read_(std::move(on_read)) {}
  bool exists(const std::string& path) override;
  std::vector<std::string> find_in_any_case(const std::string& path) override;
  Result<std::string> read(const std::string& path) override;

 private:
  AssetSource& inner_;
  Observer on_read_;
};

}  // namespace tessera::core
