// SPDX-License-Identifier: Apache-2.0
// The files that a scene was read from, with checksums of their contents, to detect whether reading them
// again would give the same scene.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/cache/block_file.hpp"
#include "core/scene/loader/asset_source.hpp"

namespace tessera::core::stored {

struct SourceFile {
  std::string path;       // as named by the scene
  bool is_there = false;  // missing files also affect what a scene becomes
  Checksum checksum;
  bool operator==(const SourceFile&) const = default;
};
using SourceFiles = std::vector<SourceFile>;

// The checksum of the file's contents, independent of `threads`; nullopt if the file is not readable.
std::optional<Checksum> checksum_of_file(const std::string& path, int threads);
Checksum checksum_of_contents(std::string_view bytes, int threads);

// The current state of the same files in a folder.
SourceFiles as_they_are(SourceFiles files, const std::string& folder, int threads);

// Forwards reads and records them.
class RecordedAssets : public AssetSource {
 public:
  RecordedAssets(AssetSource& inner, int threads) : inner_(inner), threads_(threads) {}

  bool exists(const std::string& path) override;
  std::vector<std::string> find_in_any_spelling(const std::string& path) override;
  Result<std::string> read(const std::string& path) override;
  SourceFiles files() const;
  // Whether a file was searched in any spelling. The scene then depends on the names of all files in a
  // folder, not just on the files that were read.
  bool has_searched() const { return has_searched_; }
  // Whether no file changed between two reads. Otherwise it is unknown which version became part of the
  // scene.
  bool consistent() const { return consistent_; }

 private:
  AssetSource& inner_;
  int threads_;
  std::map<std::string, SourceFile> files_;
  bool consistent_ = true;
  bool has_searched_ = false;
};

// Equal keys imply equal file contents.
std::string key_of(const SourceFiles& files);

}  // namespace tessera::core::stored
