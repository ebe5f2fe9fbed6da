// SPDX-License-Identifier: Apache-2.0
// Escapes untrusted text for display. Names, reasons and file names may contain bytes that control the
// terminal or forge a log line. Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>

namespace tessera::core {

// Escapes control characters (including line breaks), bidirectional controls, and bytes that are not UTF-8
// as \xNN, so that the text fits on one line and is valid UTF-8.
std::string printable(std::string_view text);
// As printable(), but keeps line breaks, for messages of several lines.
std::string printable_lines(std::string_view text);
// Whether printable() would return it unchanged.
bool is_printable(std::string_view text);

}  // namespace tessera::core
