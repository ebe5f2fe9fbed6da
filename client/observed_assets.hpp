// SPDX-License-Identifier: Apache-2.0
// Notes which files a scene reads and which it misses. Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/scene/loader/asset_source.hpp"

namespace tessera::client {

class ObservedAssets : public core::AssetSource {
 public:
  // `inner` must outlive this object.
  explicit ObservedAssets(core::AssetSource& inner) : inner_(inner) {}
  bool exists(const std::string& path) override { return inner_.exists(path); }
  std::vector<std::string> find_in_any_spelling(const std::string& path) override {
    return inner_.find_in_any_spelling(path);
  }
  void miss(const std::string& path) override;
  core::Result<std::string> read(const std::string& path) override;

  // Sizes in bytes by path.
  const std::map<std::string, std::uint64_t>& files() const { return files_; }
  // Paths that were read or searched without success, each name once.
  std::vector<std::string> missing() const;

 private:
  core::AssetSource& inner_;
  std::map<std::string, std::uint64_t> files_;
  std::map<std::string, std::string> missing_;  // the first path by the name without folders
};

}  // namespace tessera::client
