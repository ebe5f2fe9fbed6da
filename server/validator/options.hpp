// SPDX-License-Identifier: Apache-2.0
// The options of tessera-validator. Only the coordinator passes them (validator_process.cpp).
#pragma once

#include "core/sandbox/options.hpp"
#include "core/scene/loader/scene_limits.hpp"

namespace tessera::validator {

struct Options {
  sandbox::Options sandbox;
  core::SceneLimits scene;
};

// Parses the command line. On --help, --version and errors it prints the text and ends the process.
Options parse_options(int argc, char** argv);

}  // namespace tessera::validator
