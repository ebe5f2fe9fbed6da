// SPDX-License-Identifier: Apache-2.0
// The life of a job, as far as the job itself tells it: the coordinator keeps no history. A pure function.
#pragma once

#include "server/http/answers.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::http_api {

// [{at, kind, message}], oldest first. `at` is null where the time is not known.
Json life_of(const v1::Job& job);

}  // namespace tessera::http_api
