// SPDX-License-Identifier: Apache-2.0
// The command-line options for certificates and tokens, shared by all programs that call a coordinator.
#pragma once

#include <CLI/CLI.hpp>

#include "proto/security.hpp"

namespace tessera::proto {

// Adds --tls-ca, --tls-certificate, --tls-key, --token-file and --insecure. `security` must live until the
// command line is parsed, which fills it in.
void add_security_flags(CLI::App& command, ClientSecurity& security);

}  // namespace tessera::proto
