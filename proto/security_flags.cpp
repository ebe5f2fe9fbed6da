#include "proto/security_flags.hpp"

namespace tessera::proto {

void add_security_flags(CLI::App& command, ClientSecurity& security) {
  const auto add_file = [&](const char* flag, std::string& path, const char* what, const char* variable) {
    command.add_option(flag, path, what)
        ->envname(variable)
        ->check(CLI::ExistingFile)
        ->option_text("FILE")
        ->group("Security");
  };
  add_file("--tls-ca", security.ca,
           "Speak TLS with a coordinator whose certificate this authority signed (PEM)", "TESSERA_TLS_CA");
  add_file("--tls-certificate", security.certificate, "Show the coordinator this certificate (PEM)",
           "TESSERA_TLS_CERTIFICATE");
  add_file("--tls-key", security.key, "The certificate's private key (PEM)", "TESSERA_TLS_KEY");
  add_file("--token-file", security.token, "Show the coordinator the token in this file's first line",
           "TESSERA_TOKEN_FILE");
  command.add_flag("--insecure", security.insecure, "Speak to another machine without TLS")
      ->group("Security");
}

}  // namespace tessera::proto
