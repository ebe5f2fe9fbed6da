// SPDX-License-Identifier: Apache-2.0
// Headers of the responses of the view, so that nothing but the page itself runs in a browser.
#pragma once

#include <string_view>

#include "core/http/server.hpp"

namespace tessera::view {

// Those of everything that a browser may show as a document.
void add_security_headers(http::Response& response);
// Those of scripts and style sheets, on which a policy of their own has no effect.
void add_resource_headers(http::Response& response);

// Whether a Host header names an IP address or localhost. Servers that know no credentials reject requests
// with other names: another site can have its name point to this machine (DNS rebinding).
bool is_local_host(std::string_view host);

}  // namespace tessera::view
