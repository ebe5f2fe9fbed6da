// SPDX-License-Identifier: Apache-2.0
// The files that a scene was read from, with checksums of their contents: what tells whether reading them
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
  std::string path;       // as the scene calls it
  bool is_there = false;  // a file that could not be read also has its say in what a scene becomes
  Checksum checksum;
  bool operator==(const SourceFile&) const = default;
};
using SourceFiles = std::vector<SourceFile>;

// Of the file's contents, however many threads compute it; nullopt if it is not a file that can be read.
std::optional<Checksum> checksum_of_file(const std::string& path, int threads);
Checksum checksum_of_contents(std::string_view bytes, int threads);

// The same files as they are now, in a folder.
SourceFiles as_they_are(SourceFiles files, const std::string& folder, int threads);

// Passes reads on and takes down what was read.
class RecordedAssets : public AssetSource {
 public:
  RecordedAssets(AssetSource& inner, int threads) : inner_(inner), threads_(threads) {}

  bool exists(const std::string& path) override;
  std::vector<std::string> find_in_any_case(const std::string& path) override;
  Result<std::string> read(const std::string& path) override;
  SourceFiles files() const;
  // Whether a file was searched for in any case of its letters. Then what a scene becomes depends on all
  // files in a folder, and not on those that were read alone.
  bool has_searched() const { return has_searched_; }
  // Whether no file was another at a second look: of such files nobody can tell what became part of the
  // scene.
  bool consistent() const { return consistent_; }

 private:
  AssetSource& inner_;
  int threads_;
  std::map<std::string, SourceFile> files_;
  bool consistent_ = true;
  bool has_searched_ = false;
};

// Two for the same files only if their contents are the same.
std::string key_of(const SourceFiles& files);

}  // namespace tessera::core::stored
