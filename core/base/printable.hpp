// SPDX-License-Identifier: Apache-2.0
// Text from elsewhere made fit to be shown: names, reasons and file names may hold bytes that would steer the
// terminal of whoever reads them, or forge a line of a log. Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>

namespace tessera::core {

// Control characters (line breaks among them), those that turn the direction of writing, and bytes that are
// not UTF-8 as \xNN, so that it can be printed in one line, and sent.
std::string printable(std::string_view text);
// The same with line breaks kept: for sentences of several lines.
std::string printable_lines(std::string_view text);
// Whether printable() would leave it as it is.
bool is_printable(std::string_view text);

}  // namespace tessera::core
