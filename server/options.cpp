#include "server/options.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>

namespace tessera::server {

namespace {

constexpr int kExitUsage = 2;

}  // namespace

Options parse_options(int argc, char** argv) {
  Options options;
  CLI::App app(
      "The coordinator of a Tessera render farm: takes scenes, hands their tiles to workers, serves the "
      "pictures.");
  app.set_version_flag("--version", "tessera-coordinator " TESSERA_VERSION);
  app.add_option("--listen", options.listen,
                 "HOST:PORT to serve at; port 0 picks a free one. There is no TLS yet: beyond loopback, only "
                 "on networks you trust")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option("--state", options.state, "Folder for what must survive a restart: jobs, films, scenes")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_option("--lease-seconds", options.lease_seconds,
                 "A worker silent for so long loses its work to others")
      ->check(CLI::Range(1.0, 3600.0))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--keep-unused-hours", options.keep_unused_hours,
                 "Files of scenes that no job names any more are removed after so many hours")
      ->check(CLI::Range(1.0, 1e6))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--validator", options.validator, "The tessera-validator to start for submitted scenes")
      ->type_name("FILE")
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == EXIT_SUCCESS ? EXIT_SUCCESS : kExitUsage);
  }
  return options;
}

bool is_loopback(const std::string& address) {
  const std::string host = address.substr(0, address.find_last_of(':'));
  return host == "localhost" || host == "[::1]" || host.rfind("127.", 0) == 0 || host.rfind("unix", 0) == 0;
}

}  // namespace tessera::server
