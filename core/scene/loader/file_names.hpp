// SPDX-License-Identifier: Apache-2.0
// Spellings of one file's name by different programs and systems. Stateless; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace tessera::core {

// The text with %XX replaced by bytes (RFC 3986, section 2.1). A '%' without two digits stays.
std::string decode_percent(std::string_view text);

// A name in Windows-1252 as UTF-8; nullopt if it is UTF-8 already.
std::optional<std::string> windows_1252_as_utf8(std::string_view name);

// Whether two names in UTF-8 are the same, ignoring ASCII case and the normalisation: an accented letter may
// be one character (NFC) or an ASCII letter with combining marks (NFD), as macOS writes it. Which letter it
// is is not compared.
bool are_same_names(std::string_view a, std::string_view b);

// Equal for names that are the same, and for few others.
std::string spelling_key(std::string_view name);

}  // namespace tessera::core
