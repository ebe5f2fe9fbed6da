// SPDX-License-Identifier: Apache-2.0
#include "server/film/film_memory.hpp"

#include <utility>

#include "server/film/job_film.hpp"

namespace tessera::film {

void FilmMemory::add(std::weak_ptr<JobFilm> film) {
  const core::MutexLock lock(mutex_);
  std::erase_if(films_, [](const auto& each) { return each.expired(); });
  films_.push_back(std::move(film));
}

std::shared_ptr<JobFilm> FilmMemory::next_film() {
  const core::MutexLock lock(mutex_);
  std::erase_if(films_, [](const auto& each) { return each.expired(); });
  if (films_.empty()) return nullptr;
  films_.push_back(std::move(films_.front()));
  films_.pop_front();
  return films_.back().lock();
}

// Ends when it comes back to a film without having freed anything since.
void FilmMemory::free_stored() {
  std::shared_ptr<JobFilm> last_freed;
  while (!may_keep_stored()) {
    const std::shared_ptr<JobFilm> film = next_film();
    if (!film || film == last_freed) return;
    if (film->free_stored() || !last_freed) last_freed = film;
  }
}

}  // namespace tessera::film
