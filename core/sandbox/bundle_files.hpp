// SPDX-License-Identifier: Apache-2.0
// For a confined process: the files of a scene, which its parent sends.
#pragma once

#include <string>
#include <vector>

#include "core/scene/loader/asset_source.hpp"

namespace tessera::sandbox {

// The files with these names. The parent knows each by its index. If a name occurs twice, the last counts.
core::BundleAssets bundle_files(const std::vector<std::string>& names);

}  // namespace tessera::sandbox
