// SPDX-License-Identifier: Apache-2.0
#include "core/sandbox/options.hpp"

#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "core/cli/parse.hpp"
#include "core/sandbox/flags.hpp"

namespace tessera::sandbox {

void add_flags(CLI::App& app, Options& options, const LimitFlags& flags) {
  Confinement& confinement = options.confinement;
  app.add_option(flags.memory_mib, confinement.memory_mib, "Maximum MiB of address space")
      ->type_name("N")
      ->capture_default_str();
  app.add_option(flags.cpu_seconds, confinement.cpu_seconds, "Maximum seconds of processor time")
      ->type_name("N")
      ->capture_default_str();
  app.add_option(kParentFlag, confinement.parent,
                 "Process id of the program that starts this one, which ends with it")
      ->type_name("PID");
  app.add_flag(kCompleteFlag, confinement.complete, "Fail if a part of the sandbox is missing");
  app.add_flag(kCheckFlag, options.check,
               "Print what is missing of the sandbox, a line for each part, and end");
}

std::optional<int> confine_or_end(const Options& options, const char* program) {
  const auto missing = confine(options.confinement);
  if (!missing) return cli::print_error(program, missing.error().message);
  if (!options.check) return std::nullopt;
  for (const std::string& part : *missing) std::cout << part << '\n';
  return cli::flush_stdout(EXIT_SUCCESS, program);
}

}  // namespace tessera::sandbox
