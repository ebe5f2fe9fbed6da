// SPDX-License-Identifier: Apache-2.0
#include "scenes/modelling/program.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <vector>

namespace tessera::modelling {

int run_program(const Program& program, int argc, char** argv,
                const std::function<core::Status(std::span<const std::string>)>& generate) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool option = !arguments.empty() && arguments[0].starts_with('-');
  if (option || arguments.size() < program.fewest || arguments.size() > program.most) {
    const bool help = option && (arguments[0] == "--help" || arguments[0] == "-h");
    fmt::print(help ? stdout : stderr, "Usage: {} {}\n{}\n", program.name, program.arguments,
               program.summary);
    return help ? 0 : 2;
  }
  const core::Status status = generate(arguments);
  if (!status) fmt::print(stderr, "{}: {}\n", program.name, status.error().message);
  return status ? 0 : 1;
}

}  // namespace tessera::modelling
