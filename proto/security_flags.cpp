// SPDX-License-Identifier: Apache-2.0
#include "proto/security_flags.hpp"

#include "core/cli/help.hpp"

namespace tessera::proto {

void add_security_flags(CLI::App& command, ClientSecurity& security) {
  const auto add_file = [&](const char* flag, std::string& path, const char* what, const char* variable) {
    command.add_option(flag, path, what)
        ->envname(variable)
        ->check(cli::existing_file())
        ->type_name("FILE")
        ->group("Security");
  };
  add_file("--tls-ca", security.ca,
           "Use TLS, and trust coordinators whose certificate this authority signed (PEM)", "TESSERA_TLS_CA");
  add_file("--tls-certificate", security.certificate,
           "Certificate that this program shows to the coordinator (PEM)", "TESSERA_TLS_CERTIFICATE");
  add_file("--tls-key", security.key, "Private key of the certificate (PEM)", "TESSERA_TLS_KEY");
  add_file("--token-file", security.token, "File whose first line is the token for the coordinator",
           "TESSERA_TOKEN_FILE");
  command.add_flag("--insecure", security.insecure, "Connect to another machine without TLS")
      ->group("Security");
}

}  // namespace tessera::proto
