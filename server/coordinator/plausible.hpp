// SPDX-License-Identifier: Apache-2.0
// What no render can have come to, whatever the scene: found without rendering. Pure functions.
#pragma once

#include "core/base/error.hpp"
#include "core/film/film.hpp"

namespace tessera::coordinator {

// INVALID_ARGUMENT: the sums contradict each other, their range or their counters.
core::Status check_plausible(const core::FilmTile& tile);

}  // namespace tessera::coordinator
