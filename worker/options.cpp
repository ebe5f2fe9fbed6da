#include "worker/options.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <thread>

#include "core/base/version.hpp"
#include "proto/number_range.hpp"
#include "proto/security_flags.hpp"
#include "proto/text.hpp"

namespace tessera::worker {
namespace {

constexpr unsigned kMostThreads = 1024;
constexpr int kExitUsage = 2;

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "worker";
}

// Where the XDG base directory specification puts it; for users without a home, a folder of their own in
// /tmp.
std::string default_cache() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/')
    return std::string(cache) + "/tessera";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
    return std::string(home) + "/.cache/tessera";
  return fmt::format("/tmp/tessera-{}", getuid());
}

}  // namespace

Options::Options()
    : threads(std::max(1u, std::thread::hardware_concurrency())), cache(default_cache()), name(host_name()) {}

Options parse_options(int argc, char** argv) {
  Options options;
  CLI::App app("A worker of a Tessera render farm: fetches scenes, renders tiles, delivers them.");
  app.set_version_flag("--version", "tessera-worker " + std::string(core::version()));
  app.add_option("--coordinator", options.coordinator, "Where the coordinator listens")
      ->envname(proto::kCoordinatorVariable)
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option("--threads", options.threads, "Threads to render with")
      ->check(proto::number_between(1u, kMostThreads))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--cache", options.cache,
                 "Folder for the files of scenes and for built scenes; workers may share it")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_option("--cache-gib", options.cache_gib,
                 "Size of the cache: beyond it, files that were not used for longest are removed")
      ->check(proto::number_between(0.0, 1e6))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--name", options.name, "What people call this worker")
      ->type_name("NAME")
      ->capture_default_str();
  proto::add_security_flags(app, options.security);
  app.add_flag("--verbose", options.verbose, "Log more");
  try {
    app.parse(argc, argv);
    if (const core::Status fit = proto::check_text("--name", options.name); !fit)
      throw CLI::ValidationError(fit.error().message);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == EXIT_SUCCESS ? EXIT_SUCCESS : kExitUsage);
  }
  return options;
}

}  // namespace tessera::worker
