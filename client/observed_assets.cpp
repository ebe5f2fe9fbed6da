// SPDX-License-Identifier: Apache-2.0
#include "client/observed_assets.hpp"

#include <algorithm>

namespace tessera::client {
namespace {

std::string name_of(const std::string& path) {
  return path.substr(path.find_last_of("/\\") + 1);
}

}  // namespace

void ObservedAssets::miss(const std::string& path) {
  missing_.emplace(name_of(path), path);
}

core::Result<std::string> ObservedAssets::read(const std::string& path) {
  auto bytes = inner_.read(path);
  if (bytes)
    files_[path] = bytes->size();
  else if (bytes.error().code == core::ErrorCode::kNotFound)
    miss(path);
  return bytes;
}

std::vector<std::string> ObservedAssets::missing() const {
  std::vector<std::string> paths;
  for (const auto& entry : missing_) {
    const bool was_read =
        std::ranges::any_of(files_, [&](const auto& file) { return name_of(file.first) == entry.first; });
    if (!was_read) paths.push_back(entry.second);
  }
  return paths;
}

}  // namespace tessera::client
