// SPDX-License-Identifier: Apache-2.0
#include "server/options.hpp"

#include <CLI/CLI.hpp>
#include <array>
#include <cstdlib>

#include "core/base/version.hpp"
#include "core/cli/config_file.hpp"
#include "core/cli/help.hpp"
#include "core/cli/parse.hpp"
#include "core/common/log_flags.hpp"
#include "core/common/metrics_flag.hpp"
#include "core/common/number_range.hpp"
#include "core/sandbox/flags.hpp"
#include "server/jobs/retirement.hpp"
#include "server/limit_flags.hpp"

namespace tessera::server {

namespace {

const cli::HelpText kHelp{
    .notes =
        R"(Log lines go to stderr. SIGINT and SIGTERM stop the coordinator; jobs go on when it starts again with the same
--state. SIGHUP reads the files of tokens and certificates again.)",
    .exit_statuses = {{cli::kExitOk, "stopped by a signal, or a maintenance command found nothing damaged"},
                      {cli::kExitFailed, "failed"},
                      {cli::kExitUsage, "wrong command line"}},
    .examples = {"tessera-coordinator --state /var/lib/tessera",
                 "tessera-coordinator --check /var/lib/tessera",
                 "tessera-coordinator --state /var/lib/tessera --backup /mnt/backup/tessera"}};
constexpr std::size_t kFingerprintDigits = 16;

// The error message; empty if the text is a fingerprint.
std::string is_fingerprint(const std::string& text) {
  const bool digits = text.find_first_not_of("0123456789abcdef") == std::string::npos;
  return digits && text.size() == kFingerprintDigits ? "" : "must be 16 lower-case hexadecimal digits";
}

// The error message; empty if the text can be read.
std::string is_keep_finished(const std::string& text) {
  const auto read = jobs::read_keep_finished(text);
  return read ? "" : read.error().message;
}

void add_maintenance_flags(CLI::App& app, Options& options) {
  const auto add_folder = [&](const char* flag, std::filesystem::path& path, const char* what) {
    return app.add_option(flag, path, what)
        ->configurable(false)
        ->type_name("DIR")
        ->group("Maintenance, instead of running");
  };
  const std::array all{
      add_folder("--check", options.check, "Check a state folder or a backup for damage and change nothing")
          ->check(cli::existing_folder()),
      add_folder(
          "--salvage", options.salvage,
          "Recover what is whole of a state folder whose database is damaged; the old database is kept "
          "beside it")
          ->check(cli::existing_folder()),
      add_folder(
          "--backup", options.backup,
          "Write a backup of the state folder (--state) into this new folder, also while a coordinator "
          "runs on it"),
      add_folder("--restore", options.restore, "Make a new state folder (--state) of this backup")
          ->check(cli::existing_folder())};
  for (CLI::Option* const option : all)
    for (CLI::Option* const other : all)
      if (option != other) option->excludes(other);
}

void add_security_flags(CLI::App& app, Options& options) {
  const auto add_file = [&](const char* flag, std::string& path, const char* what) {
    app.add_option(flag, path, what)->check(cli::existing_file())->type_name("FILE")->group("Security");
  };
  add_file("--tls-certificate", options.security.certificate, "Use TLS, with this certificate (PEM)");
  add_file("--tls-key", options.security.key, "Private key of the certificate (PEM)");
  add_file("--tls-client-ca", options.security.client_ca,
           "Require callers to show a certificate that this authority signed (PEM)");
  add_file("--tokens", options.tokens,
           "Require callers to show a token of this file; each line is ROLE NAME TOKEN, with the role "
           "watch, submit, work or admin; SIGHUP reads it again");
  app.add_flag(
         "--allow-unauthenticated-connections", options.security.allow_unauthenticated,
         "Let other machines connect without a client certificate; anyone who reaches the port can then "
         "exhaust the coordinator's memory and stop it, even with --tokens")
      ->group("Security");
  app.add_flag("--insecure", options.security.insecure, "Serve other machines without TLS")
      ->group("Security");
  app.add_flag(sandbox::kCompleteFlag, options.require_sandbox,
               "Do not start if this machine lacks a part of the sandbox in which scenes are validated")
      ->group("Security");
}

}  // namespace

Options parse_options(int argc, char** argv) {
  Options options;
  CLI::App app("Coordinate the workers and jobs of a Tessera farm", "tessera-coordinator");
  cli::set_help(app, kHelp);
  app.set_version_flag("--version", "tessera-coordinator " + std::string(core::version()),
                       "Print the version");
  cli::add_config_option(app);
  app.add_option("--listen", options.listen,
                 "Address to listen on; port 0 picks a free port. An address that other machines can reach "
                 "needs TLS with --tls-client-ca, unless another option allows less")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option("--state", options.state,
                 "Folder for jobs, scenes and images; survives restarts [default: "
                 "~/.local/state/tessera/coordinator]")
      ->type_name("DIR");
  app.add_option("--lease-seconds", options.lease_seconds,
                 "Lease time: a worker that is silent for so many seconds loses its work to others")
      ->check(common::number_between(1.0, 3600.0))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--keep-unused-hours", options.keep_unused_hours,
                 "Remove files of scenes so many hours after the last job that uses them")
      ->check(common::number_between(1.0, 1e6))
      ->type_name("N")
      ->capture_default_str();
  app.add_option(
         "--keep-finished", options.keep_finished,
         "Delete the oldest finished jobs beyond this number, such as 5000, or after this time, such as "
         "12h or 30d [default: keep them]")
      ->check(CLI::Validator(is_keep_finished, ""))
      ->type_name("N|TIME");
  app.add_option("--audit", options.audit,
                 "Share of the work, from 0 to 1, that a second worker renders again to compare the bytes")
      ->check(common::number_between(0.0, 1.0))
      ->type_name("P")
      ->capture_default_str();
  app.add_option("--validator", options.validator,
                 "Program that validates submitted scenes [default: tessera-validator beside this program]")
      ->type_name("FILE");
  app.add_option("--accept-fingerprint", options.fingerprints,
                 "Accept workers with this determinism fingerprint; give it once for each [default: that of "
                 "this release]")
      ->check(CLI::Validator(is_fingerprint, ""))
      ->allow_extra_args(false)
      ->type_name("HEX");
  CLI::Option* http =
      app.add_option("--http", options.http,
                     "Address of the page and of the HTTP API; off: neither. An address that other machines "
                     "can reach needs TLS, or --insecure")
          ->type_name("HOST:PORT")
          ->capture_default_str();
  common::add_metrics_flag(app, options.metrics);
  app.add_option(
         "--cluster", options.cluster,
         "Serve cluster managers at this address: health by the gRPC protocol, and the external scaler of "
         "KEDA; port 0 picks a free port. Without TLS and credentials: name an address that only this "
         "machine or a trusted network reaches")
      ->type_name("HOST:PORT");
  common::add_log_flags(app, options.log);
  add_maintenance_flags(app, options);
  add_security_flags(app, options);
  add_limit_flags(app, options.limits);
  if (const auto ended = cli::parse(app, argc, argv, "tessera-coordinator")) std::exit(*ended);
  options.http_is_given = http->count() > 0;
  return options;
}

}  // namespace tessera::server
