// SPDX-License-Identifier: Apache-2.0
// Adds <default> elements to the text of a Mitsuba scene: parameters that a command line sets. Stateless;
// thread-safe.
#pragma once

#include <string>
#include <string_view>

namespace tessera::core {

bool is_xml(std::string_view text);

// `xml` with a <default> of this name before all others, of which the first one counts. A value that is JSON
// loses the quotes of a text and the brackets of a list. A file without a root element stays as it is.
std::string with_xml_default(std::string xml, const std::string& name, const std::string& value);

}  // namespace tessera::core
