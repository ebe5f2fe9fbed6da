// SPDX-License-Identifier: Apache-2.0
// The events of a job's life, and what it does at present, in words. A pure function.
#pragma once

#include "server/http/answers.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::http_api {

// [{at, kind, message}], oldest first. The last one of a job that has not ended is its state, whose `at` is
// null.
Json life_of(const v1::Job& job);

}  // namespace tessera::http_api
