// SPDX-License-Identifier: Apache-2.0
// The command line that the generators without options share: `NAME ARGUMENT...`, where `NAME --help`
// explains itself and other words that begin with '-' are not taken for files.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::modelling {

struct Program {
  std::string_view name, arguments;  // "tessera-generate-backdrop", "NAME FILE"
  std::string_view summary;          // a sentence
  std::size_t fewest, most;          // arguments
};

// What the process exits with: 0 done, 1 failed, 2 wrong command line.
int run_program(const Program& program, int argc, char** argv,
                const std::function<core::Status(std::span<const std::string>)>& generate);

}  // namespace tessera::modelling
