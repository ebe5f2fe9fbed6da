// SPDX-License-Identifier: Apache-2.0
// A bundle whose files lie at these paths, by their names in the bundle.
#pragma once

#include <map>
#include <set>
#include <string>

#include "core/scene/loader/asset_source.hpp"

namespace tessera {

inline core::BundleAssets bundle_at(const std::map<std::string, std::string>& paths) {
  std::set<std::string> names;
  for (const auto& [name, path] : paths) names.insert(name);
  return {names, [paths](const std::string& name, const std::string& shown) {
            return core::read_asset(paths.at(name), shown);
          }};
}

}  // namespace tessera
