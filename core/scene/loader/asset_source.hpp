// SPDX-License-Identifier: Apache-2.0
// Where a scene's files come from: a folder for a scene on this machine, content-addressed blobs for one that
// came over the network. The loader opens nothing but through this, so that a path in a scene from elsewhere
// is a name in its bundle and never a path on this machine.
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
  // Whether there is a file that read() knows by exactly this path.
  virtual bool exists(const std::string& path) { return read(path).has_value(); }
  // The paths of files that differ from `path` at most in the case of ASCII letters. At most two, which tell
  // that there are several. A source that cannot search knows only `path` itself.
  virtual std::vector<std::string> find_in_any_case(const std::string& path) {
    return exists(path) ? std::vector{path} : std::vector<std::string>();
  }
  // The bytes of the file that the scene calls `path` (as written there, relative to the scene file).
  // The error names the path and says why it cannot be read.
  virtual Result<std::string> read(const std::string& path) = 0;
};

// Files below or beside a folder on this machine.
class FolderAssets : public AssetSource {
 public:
  explicit FolderAssets(std::string folder) : folder_(std::move(folder)) {}
  bool exists(const std::string& path) override;
  std::vector<std::string> find_in_any_case(const std::string& path) override;
  Result<std::string> read(const std::string& path) override;

 private:
  std::string folder_;
};

// The files of a bundle: a name is looked up in `blob_paths`, and only those files are opened. Bundles travel
// as UTF-8, so that a name's bytes that cannot be shown stand there as \xNN (core/base/printable.hpp).
class BundleAssets : public AssetSource {
 public:
  // Whether the bytes that were read are those of the file that the bundle means.
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

// Passes everything on and reports each file that was read, so that loading a scene tells what its bundle
// needs. Where several files differ in the case of letters alone, all are read: a search in the bundle must
// end as it did here.
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
