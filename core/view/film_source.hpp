// SPDX-License-Identifier: Apache-2.0
// The image of a film in this process, which somebody adds samples to. Thread-safe.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/view/tile_source.hpp"

namespace tessera::view {

class FilmSource final : public TileSource {
 public:
  // `describe` gives the header; it is called by several threads.
  FilmSource(std::string id, const core::TileGrid& grid, std::function<JobHeader()> describe);

  // Shows this film, which must be of the grid, until detach(). Without a film, read() is UNAVAILABLE.
  void attach(const core::Film& film);
  void detach();
  // Held while the film is read, and by whoever changes it.
  std::mutex& film_mutex() { return film_mutex_; }
  // The samples of the grid tiles in `rect` have changed.
  void note_change(const core::PixelRect& rect);
  // There are no more changes.
  void end();

  std::string id() const override { return id_; }
  core::Result<JobHeader> header() override { return describe_(); }
  std::optional<core::TileGrid> grid() override { return grid_; }
  // Those of the film that was attached last.
  core::LayerSet layers() override;
  core::Result<std::vector<TileChange>> changes_since(Revision since, std::size_t most) override;
  core::Result<TileAtRevision> read(const TileChange& change) override;
  bool is_over() override;

 private:
  void note_tile(int tile);

  const std::string id_;
  const core::TileGrid grid_;
  const std::function<JobHeader()> describe_;

  std::mutex film_mutex_;
  // Guarded by film_mutex_, as the film is:
  const core::Film* film_ = nullptr;
  core::LayerSet layers_;

  std::mutex mutex_;
  // Guarded by mutex_:
  Revision last_ = 0;
  std::vector<Revision> revisions_;  // of the tiles; 0 without samples
  std::map<Revision, int> log_;      // the tiles in the order of their last changes
  bool is_over_ = false;
};

}  // namespace tessera::view
