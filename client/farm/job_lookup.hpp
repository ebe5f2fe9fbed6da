// Jobs by what a user typed. Stateless.
#pragma once

#include <string>

#include "client/farm/farm.hpp"

namespace tessera::client {

// The job with this id, or the only one whose id begins so.
core::Result<v1::Job> find_job(Farm& farm, const std::string& id_or_prefix);

}  // namespace tessera::client
