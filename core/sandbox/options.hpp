// SPDX-License-Identifier: Apache-2.0
// The command line and the first step of every program that confines itself.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "core/sandbox/confinement.hpp"

namespace tessera::sandbox {

struct Options {
  Confinement confinement;
  bool check = false;  // tell what is missing of the sandbox, and end
};

// The names of the options that differ between programs.
struct LimitFlags {
  const char* memory_mib;
  const char* cpu_seconds;
};

void add_flags(CLI::App& app, Options& options, const LimitFlags& flags);

// Confines this process as the options say. Returns the exit status if the program should end now, with its
// output written: missing parts to stdout, an error of `program` to stderr.
std::optional<int> confine_or_end(const Options& options, const char* program);

}  // namespace tessera::sandbox
