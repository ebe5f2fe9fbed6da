// SPDX-License-Identifier: Apache-2.0
// What tessera-validator can be told, in one place. Only the coordinator tells it; validator_process.cpp.
#pragma once

#include <sys/types.h>

#include "core/scene/loader/scene_limits.hpp"
#include "server/validator/confinement.hpp"

namespace tessera::validator {

struct Options {
  Confinement confinement;
  core::SceneLimits scene;
};

// Reads the command line. On --help, --version and mistakes it prints what there is to say and ends the
// process.
Options parse_options(int argc, char** argv);

}  // namespace tessera::validator
