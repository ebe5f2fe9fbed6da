// SPDX-License-Identifier: Apache-2.0
// Precomputed results for simulated workers: whole tiles whose sums are noise like that of a path tracer,
// already compressed, so that sending them costs little. Thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "proto/convert.hpp"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::bench {

class ReadyTiles {
 public:
  ReadyTiles();

  // A valid result for the item, which must be a whole tile of 64 x 64 pixels. `variant` is any number;
  // equal ones give equal sums.
  v1::RenderedItem rendered(const proto::WorkItem& item, std::uint64_t variant) const;

 private:
  // The sums of a tile in the format of the protocol.
  struct Frame {
    std::string planes_zstd;
    std::uint64_t sums_xxh3 = 0;
  };

  // By which of the range's samples have odd numbers: none, some, all.
  std::array<std::vector<Frame>, 3> frames_;
};

}  // namespace tessera::bench
