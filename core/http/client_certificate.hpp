// SPDX-License-Identifier: Apache-2.0
// The certificate that a client presents over TLS.
#pragma once

#include <optional>
#include <string>

struct MHD_Connection;

namespace tessera::http {

// The common name of the certificate, empty if it has none. Nothing if the client has presented no
// certificate, or one that none of the server's client CAs has signed for clients, or that is not valid now.
std::optional<std::string> verified_client_name(MHD_Connection* connection);

}  // namespace tessera::http
