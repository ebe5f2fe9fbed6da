// SPDX-License-Identifier: Apache-2.0
// Precomputed results: whole tiles with noise like that of a path tracer, compressed in advance, so that
// sending them costs a worker next to nothing. Thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/film/layers.hpp"
#include "proto/convert.hpp"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::bench {

class ReadyTiles {
 public:
  // With these layers, none of which may be a light group or have ids.
  explicit ReadyTiles(const core::LayerSet& layers = {});

  // A valid result for the item, which must be a whole tile of 64 x 64 pixels. `variant` is any number; equal
  // ones give equal sums.
  v1::RenderedItem rendered(const proto::WorkItem& item, std::uint64_t variant) const;

 private:
  // The sums of a tile as sent over the network.
  struct Frame {
    std::string planes_zstd;
    std::vector<std::uint32_t> plane_words;
    std::uint64_t sums_xxh3 = 0;
  };

  // By how many of the range's samples are odd: none, some, all.
  std::array<std::vector<Frame>, 3> frames_;
};

}  // namespace tessera::bench
