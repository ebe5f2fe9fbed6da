// Where a scene's files come from: a folder for a scene on this machine, content-addressed blobs for one that
// came over the network. The loader opens nothing but through this, so that a path in a scene from elsewhere
// is a name in its bundle and never a path on this machine.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "core/base/error.hpp"

namespace tessera::core {

class AssetSource {
 public:
  virtual ~AssetSource() = default;
  // The bytes of the file that the scene calls `path` (as written there, relative to the scene file).
  // The error names the path and says why it cannot be read.
  virtual Result<std::string> read(const std::string& path) = 0;
};

// Files below or beside a folder on this machine.
class FolderAssets : public AssetSource {
 public:
  explicit FolderAssets(std::string folder) : folder_(std::move(folder)) {}
  Result<std::string> read(const std::string& path) override;

 private:
  std::string folder_;
};

// The files of a bundle: a name is looked up in `blob_paths`, and only those files are opened. Bundles travel
// as UTF-8, so that a name's bytes that cannot be shown stand there as \xNN (core/base/printable.hpp).
class BundleAssets : public AssetSource {
 public:
  explicit BundleAssets(std::map<std::string, std::string> blob_paths) : blob_paths_(std::move(blob_paths)) {}
  Result<std::string> read(const std::string& path) override;

 private:
  std::map<std::string, std::string> blob_paths_;
};

// Passes reads on and reports every file that was read, so that loading a scene tells what its bundle needs.
class RecordingAssets : public AssetSource {
 public:
  using Observer = std::function<void(const std::string& path, const std::string& bytes)>;
  RecordingAssets(AssetSource& inner, Observer on_read) : inner_(inner), on_read_(std::move(on_read)) {}
  Result<std::string> read(const std::string& path) override;

 private:
  AssetSource& inner_;
  Observer on_read_;
};

}  // namespace tessera::core
