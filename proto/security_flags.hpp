// SPDX-License-Identifier: Apache-2.0
// The options by which every program that calls a coordinator is told of certificates and tokens.
#pragma once

#include <CLI/CLI.hpp>

#include "proto/security.hpp"

namespace tessera::proto {

// Adds --tls-ca, --tls-certificate, --tls-key, --token-file and --insecure. `security` is filled in while the
// command line is parsed, and must live until then.
void add_security_flags(CLI::App& command, ClientSecurity& security);

}  // namespace tessera::proto
