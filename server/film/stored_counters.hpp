// SPDX-License-Identifier: Apache-2.0
// Converts the counters of the renderer to and from those of the store. Pure functions.
#pragma once

#include "core/film/film.hpp"
#include "server/store/stored.pb.h"

namespace tessera::film {

stored::v1::Counters to_stored(const core::RenderCounters& counters);
core::RenderCounters from_stored(const stored::v1::Counters& stored);

}  // namespace tessera::film
