// SPDX-License-Identifier: Apache-2.0
// A job's film as read from the store.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/coordinator/coordinator.hpp"

namespace tessera::coordinator {

struct Coordinator::LoadedFilm {
  std::unique_ptr<JobFilm> film;
  // The samples in it, by tile.
  std::map<int, std::vector<core::SampleRange>> done;
  std::vector<scheduler::ProducedItem> provenance;
  // One sentence for each stored tile that could not be used and is empty here.
  std::vector<std::string> damage;
};

}  // namespace tessera::coordinator
