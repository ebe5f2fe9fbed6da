// SPDX-License-Identifier: Apache-2.0
#include "worker/job.hpp"

#include <fmt/format.h>

#include "proto/blob.hpp"

namespace tessera::worker {

std::string bundle_key(const v1::Bundle& bundle) {
  proto::Hasher hasher;
  // Each text follows its length, so that no two bundles give the same bytes.
  const auto add = [&hasher](const std::string& text) {
    hasher.update(fmt::format("{}:", text.size()));
    hasher.update(text);
  };
  add(bundle.scene_path());
  for (const v1::Bundle::Asset& asset : bundle.assets()) {
    add(asset.path());
    add(asset.digest().sha256());
  }
  return hasher.finish().hex();
}

}  // namespace tessera::worker
