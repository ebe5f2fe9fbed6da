// SPDX-License-Identifier: Apache-2.0
// Reads the films of jobs from the store, and tiles of which the store has a part. Thread-safe; blocks for
// the disk.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/farm/job_record.hpp"
#include "server/film/fingerprinter.hpp"
#include "server/film/job_film.hpp"
#include "server/film/tile_row.hpp"
#include "server/store/job_store.hpp"

namespace tessera::jobs {

// A job's film as found in the store. Its samples stay there.
struct LoadedFilm {
  std::shared_ptr<film::JobFilm> film;
  // The samples in it, by tile.
  std::map<int, std::vector<core::SampleRange>> done;
  std::vector<scheduler::ProducedItem> provenance;
  // One sentence for each stored tile that could not be used and is empty here.
  std::vector<std::string> damage;
};

class FilmReader {
 public:
  FilmReader(store::JobStore& store, film::FilmMemory& memory, const film::Fingerprinter& fingerprinter,
             events::RevisionCounter& revisions)
      : store_(store), memory_(memory), fingerprinter_(fingerprinter), revisions_(revisions) {}

  // Reads and checks every tile of a job, one at a time.
  core::Result<LoadedFilm> load(const v1::Job& spec) const;
  // The sums of a tile of a job whose film is in the store alone; zeros if the store has no samples of it.
  core::Result<core::Film::TileSums> stored_sums(const v1::Job& spec, int tile) const;
  // The sums of a tile of a job in progress, of all samples at one moment. `revision`, unless null, receives
  // their revision.
  core::Result<core::Film::TileSums> sums(const v1::Job& spec, const film::JobFilm& film, int tile,
                                          events::Revision* revision = nullptr) const;
  // All samples of a tile that is about to be stored. DATA_LOSS if the store has lost some of them.
  core::Result<std::shared_ptr<film::TilePart>> whole(const v1::Job& spec, int tile,
                                                      const film::TileToStore& to_store) const;

 private:
  // The last change of each stored tile.
  core::Result<std::map<int, events::Revision>> revisions_of(const std::string& job_id) const;
  core::Status load_tile(LoadedFilm& loaded, const v1::Job& spec, const store::TileChange& change,
                         const std::vector<core::SampleRange>& done) const;
  // The parts together; empty if the store has another part than the snapshot says, since it was written
  // meanwhile.
  core::Result<std::shared_ptr<film::TilePart>> combine(const v1::Job& spec, int tile,
                                                        const film::TileSnapshot& parts) const;
  // Drops fingerprints that a lost secret made, since they cannot be compared. Returns false if an audit
  // needs one of them.
  bool can_be_verified(film::Produced& provenance) const;

  store::JobStore& store_;
  film::FilmMemory& memory_;
  const film::Fingerprinter& fingerprinter_;
  events::RevisionCounter& revisions_;
};

}  // namespace tessera::jobs
