#include "server/options.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "proto/number_range.hpp"
#include "server/limit_flags.hpp"

namespace tessera::server {

namespace {

constexpr int kExitUsage = 2;

void add_maintenance_flags(CLI::App& app, Options& options) {
  const auto add_folder = [&](const char* flag, std::filesystem::path& path, const char* what) {
    return app.add_option(flag, path, what)
        ->check(CLI::ExistingDirectory)
        ->type_name("DIR")
        ->group("Instead of running");
  };
  CLI::Option* check = add_folder("--check", options.check,
                                  "Tell what of a state folder is whole, and change nothing. Exit status 0 "
                                  "only if all of it is");
  add_folder("--salvage", options.salvage,
             "Keep what is whole of a state folder whose database is damaged; the old database is set aside")
      ->excludes(check);
}

void add_security_flags(CLI::App& app, Options& options) {
  const auto add_file = [&](const char* flag, std::string& path, const char* what) {
    app.add_option(flag, path, what)->check(CLI::ExistingFile)->type_name("FILE")->group("Security");
  };
  add_file("--tls-certificate", options.security.certificate, "Speak TLS, with this certificate (PEM)");
  add_file("--tls-key", options.security.key, "The certificate's private key (PEM)");
  add_file("--tls-client-ca", options.security.client_ca,
           "Ask callers for a certificate that this authority signed (PEM)");
  add_file("--tokens", options.tokens,
           "Ask callers for a token: a line 'ROLE NAME TOKEN' for each, ROLE one of submit, work, admin");
  app.add_flag("--allow-unauthenticated-connections", options.security.allow_unauthenticated,
               "Serve other machines that show no certificate. Anybody who reaches the port can then use up "
               "the coordinator's memory and stop it; --tokens does not prevent that")
      ->group("Security");
  app.add_flag("--insecure", options.security.insecure, "Serve other machines without TLS")
      ->group("Security");
}

}  // namespace

Options parse_options(int argc, char** argv) {
  Options options;
  CLI::App app(
      "The coordinator of a Tessera render farm: takes scenes, hands their tiles to workers, serves the "
      "pictures.");
  app.set_version_flag("--version", "tessera-coordinator " TESSERA_VERSION);
  app.add_option("--listen", options.listen,
                 "HOST:PORT to serve at; port 0 picks a free one. An address that other machines reach needs "
                 "TLS with client certificates; see --tls-client-ca")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option("--state", options.state, "Folder for what must survive a restart: jobs, films, scenes")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_option("--lease-seconds", options.lease_seconds,
                 "A worker silent for so long loses its work to others")
      ->check(proto::number_between(1.0, 3600.0))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--keep-unused-hours", options.keep_unused_hours,
                 "Files of scenes that no job names any more are removed after so many hours")
      ->check(proto::number_between(1.0, 1e6))
      ->type_name("N")
      ->capture_default_str();
  app.add_option(
         "--audit", options.audit,
         "The share of ranges, 0 to 1, that a worker of another name renders again, to compare the bits")
      ->check(proto::number_between(0.0, 1.0))
      ->type_name("P")
      ->capture_default_str();
  app.add_option("--validator", options.validator, "The tessera-validator to start for submitted scenes")
      ->type_name("FILE")
      ->capture_default_str();
  add_maintenance_flags(app, options);
  add_security_flags(app, options);
  add_limit_flags(app, options.limits);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == EXIT_SUCCESS ? EXIT_SUCCESS : kExitUsage);
  }
  return options;
}

}  // namespace tessera::server
