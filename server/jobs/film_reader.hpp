// SPDX-License-Identifier: Apache-2.0
// Reads the films of jobs back from the store. Thread-safe; blocks for the disk.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/farm/job_record.hpp"
#include "server/film/fingerprinter.hpp"
#include "server/film/job_film.hpp"
#include "server/store/job_store.hpp"

namespace tessera::jobs {

// A job's film as read from the store.
struct LoadedFilm {
  std::unique_ptr<film::JobFilm> film;
  // The samples in it, by tile.
  std::map<int, std::vector<core::SampleRange>> done;
  std::vector<scheduler::ProducedItem> provenance;
  // One sentence for each stored tile that could not be used and is empty here.
  std::vector<std::string> damage;
};

class FilmReader {
 public:
  FilmReader(store::JobStore& store, const film::Fingerprinter& fingerprinter)
      : store_(store), fingerprinter_(fingerprinter) {}

  core::Result<LoadedFilm> load(const v1::Job& spec) const;
  // Empty if the store has no samples of the tile.
  core::Result<film::TileContent> load_tile(const v1::Job& spec, const core::TileGrid& grid, int tile) const;

 private:
  core::Status load_tile_into(LoadedFilm& loaded, const v1::Job& spec, const core::TileGrid& grid, int tile,
                              const std::vector<core::SampleRange>& done) const;
  // Drops fingerprints that a lost secret made, since they cannot be compared. Returns false if an audit
  // needs one of them.
  bool can_be_verified(film::Produced& provenance) const;

  store::JobStore& store_;
  const film::Fingerprinter& fingerprinter_;
};

}  // namespace tessera::jobs
