// SPDX-License-Identifier: Apache-2.0
// The tables of docs/scene-format.md. Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>

namespace tessera::core {

// `page`, with the tables of keys below the lines that ask for them: "<!-- keys of glass -->", and
// "<!-- keys that may have keyframes -->". All else stays.
std::string update_reference(std::string_view page);

}  // namespace tessera::core
