// SPDX-License-Identifier: Apache-2.0
// The source of a scene's files: a folder for a local scene, content-addressed blobs for one received over
// the network. The loader opens files only through this interface, so that a path in a remote scene is a
// name in its bundle and never a path on this machine.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/open_file.hpp"

namespace tessera::core {

class AssetSource {
 public:
  virtual ~AssetSource() = default;
  // Whether read() has a file with exactly this path.
  virtual bool exists(const std::string& path) { return read(path).has_value(); }
  // The paths of files that equal `path` ignoring ASCII case and normalisation (file_names.hpp). At most two
  // are returned, enough to detect ambiguity. A source that cannot search returns only `path` itself.
  virtual std::vector<std::string> find_in_any_spelling(const std::string& path) {
    return exists(path) ? std::vector{path} : std::vector<std::string>();
  }
  // Called when a file was searched by all names that `path` may stand for, and there is none.
  virtual void miss(const std::string& path) { static_cast<void>(path); }
  // The bytes of the file that the scene calls `path` (relative to the scene file). The error names the
  // path and the reason.
  virtual Result<std::string> read(const std::string& path) = 0;
};

// Local files in or relative to a folder.
class FolderAssets : public AssetSource {
 public:
  explicit FolderAssets(std::string folder) : folder_(std::move(folder)) {}
  bool exists(const std::string& path) override;
  std::vector<std::string> find_in_any_spelling(const std::string& path) override;
  Result<std::string> read(const std::string& path) override;

 private:
  std::string folder_;
};

// The bytes of a local file, whose name in messages is `shown`. Refuses folders, devices and files of more
// than 8 GiB.
Result<std::string> read_asset(const std::string& path, const std::string& shown);
// The same for an open ordinary file.
Result<std::string> read_asset(const OpenFile& file, const std::string& shown);

// The files of a bundle, and no others. Bundles are transmitted as UTF-8, so unprintable bytes of names are
// escaped as \xNN (core/base/printable.hpp).
class BundleAssets : public AssetSource {
 public:
  // Reads the file of the bundle with this name. `shown` is its name in messages.
  using Read = std::function<Result<std::string>(const std::string& name, const std::string& shown)>;

  BundleAssets(std::set<std::string> names, Read read) : names_(std::move(names)), read_(std::move(read)) {}
  bool exists(const std::string& path) override;
  std::vector<std::string> find_in_any_spelling(const std::string& path) override;
  Result<std::string> read(const std::string& path) override;

 private:
  std::set<std::string> names_;
  Read read_;
  std::map<std::string, std::vector<std::string>> by_key_;  // spelling_key(); filled by the first search
};

// Forwards reads and reports each file, so that loading a scene determines the files of its bundle. If
// several files differ only in spelling, all are read, so that a search in the bundle has the same result.
class RecordingAssets : public AssetSource {
 public:
  using Observer = std::function<void(const std::string& path, const std::string& bytes)>;
  RecordingAssets(AssetSource& inner, Observer on_read) : inner_(inner), on_read_(std::move(on_read)) {}
  bool exists(const std::string& path) override;
  std::vector<std::string> find_in_any_spelling(const std::string& path) override;
  Result<std::string> read(const std::string& path) override;

 private:
  AssetSource& inner_;
  Observer on_read_;
};

}  // namespace tessera::core
