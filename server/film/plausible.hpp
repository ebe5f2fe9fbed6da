// SPDX-License-Identifier: Apache-2.0
// Plausibility checks: find results that no scene can give, without rendering. Pure functions.
#pragma once

#include "core/base/error.hpp"
#include "core/film/film.hpp"

namespace tessera::film {

// INVALID_ARGUMENT if the sums contradict each other, the sample range or the counters.
core::Status check_plausible(const core::FilmTile& tile);

}  // namespace tessera::film
