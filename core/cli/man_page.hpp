// SPDX-License-Identifier: Apache-2.0
// The manual page of a program, in the man macros of roff, made of its options. A pure function.
#pragma once

#include <string>

#include "core/cli/option_table.hpp"

namespace tessera::cli {

// `version`: "tessera 0.1.0". Commands are subsections of one page.
std::string man_page(const CommandTable& table, const std::string& version);

}  // namespace tessera::cli
