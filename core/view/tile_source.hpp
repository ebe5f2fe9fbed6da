// SPDX-License-Identifier: Apache-2.0
// The image of one job, as those who show it read it: on a farm, or while it is rendered in this process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/film.hpp"

namespace tessera::view {

// The number of a change; every later change has a greater one.
using Revision = std::uint64_t;

// The last change of a tile's samples.
struct TileChange {
  Revision revision = 0;
  int tile = 0;
};

// The samples of a tile at some revision.
struct TileAtRevision {
  core::Film::TileSums sums;
  Revision revision = 0;
  core::LayerSet layers{};  // those of the film
};

struct JobHeader {
  std::string json;  // an object: what is known of the job
  Revision revision = 0;
};

// Implementations are thread-safe. UNAVAILABLE from any of these: ask again later. Other errors: the job is
// gone, or its samples are damaged.
class TileSource {
 public:
  virtual ~TileSource() = default;

  // Tells the jobs of this process apart.
  virtual std::string id() const = 0;
  virtual core::Result<JobHeader> header() = 0;
  // Nothing while the job has no image. Once there is one, it stays the same.
  virtual std::optional<core::TileGrid> grid() = 0;
  // The layers of the image; the same once there is one.
  virtual core::LayerSet layers() = 0;
  // At most `most` tiles that changed after `since`, each with its last change, in the order of revisions.
  virtual core::Result<std::vector<TileChange>> changes_since(Revision since, std::size_t most) = 0;
  // The tile at this revision or a later one. Empty sums if its samples were withdrawn.
  virtual core::Result<TileAtRevision> read(const TileChange& change) = 0;
  // The job has ended, and all of its changes can be read.
  virtual bool is_over() = 0;
};

}  // namespace tessera::view
