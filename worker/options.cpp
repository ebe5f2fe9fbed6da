// SPDX-License-Identifier: Apache-2.0
#include "worker/options.hpp"

#include <pwd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <thread>

#include "core/base/version.hpp"
#include "core/cli/help.hpp"
#include "core/cli/parse.hpp"
#include "proto/log_flags.hpp"
#include "proto/number_range.hpp"
#include "proto/security_flags.hpp"
#include "proto/text.hpp"

namespace tessera::worker {
namespace {

constexpr unsigned kMaxThreads = 1024;

const cli::HelpText kHelp{
    .notes =
        R"(Log lines go to stderr. SIGINT and SIGTERM end the worker after what it has rendered is delivered; a second
signal ends it at once.)",
    .exit_statuses = {{cli::kExitOk, "stopped by a signal"},
                      {cli::kExitFailed, "failed, or refused by the coordinator"},
                      {cli::kExitUsage, "wrong command line"}},
    .examples = {"tessera-worker --coordinator farm.example.org:7420 --tls-ca ca.pem"}};

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "worker";
}

// The home folder of this process's user. System services often run without HOME. Empty if there is none.
std::string home_folder() {
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') return home;
  const passwd* const user = getpwuid(geteuid());
  std::error_code unknown;
  const bool exists = user != nullptr && std::filesystem::is_directory(user->pw_dir, unknown);
  return exists ? user->pw_dir : "";
}

// The folder of the XDG base directory specification. It is never in a folder such as /tmp, where other users
// could create it first. Empty for users without a home.
std::string default_cache() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/')
    return std::string(cache) + "/tessera";
  const std::string home = home_folder();
  return home.empty() ? "" : home + "/.cache/tessera";
}

}  // namespace

Options::Options()
    : threads(std::max(1u, std::thread::hardware_concurrency())), cache(default_cache()), name(host_name()) {}

Options parse_options(int argc, char** argv) {
  Options options;
  CLI::App app("Render scenes for a Tessera farm", "tessera-worker");
  cli::set_help(app, kHelp);
  app.set_version_flag("--version", "tessera-worker " + std::string(core::version()), "Print the version");
  app.add_option("--coordinator", options.coordinator, "Address of the farm's coordinator")
      ->envname(proto::kCoordinatorVariable)
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option("--threads", options.threads, "Number of threads [default: one per processor]")
      ->check(proto::number_between(1u, kMaxThreads))
      ->type_name("N");
  app.add_option("--cache", options.cache,
                 "Folder for the files of scenes and for built scenes, writable by this user alone; workers "
                 "can share it "
                 "[default: ~/.cache/tessera]")
      ->type_name("DIR");
  app.add_option("--cache-gib", options.cache_gib,
                 "Size limit of the cache in GiB; files unused for longest are removed first")
      ->check(proto::number_between(0.0, 1e6))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--name", options.name, "Name of this worker in lists and logs [default: the host name]")
      ->type_name("NAME");
  proto::add_security_flags(app, options.security);
  proto::add_log_flags(app, options.log);
  app.add_flag(
      "--verbose", [&options](auto) { options.log.level = spdlog::level::debug; },
      "Log debug messages: --log-level debug");
  app.final_callback([&options] {
    if (const core::Status fit = proto::check_text("--name", options.name); !fit)
      throw CLI::ValidationError(fit.error().message);
  });
  if (const auto ended = cli::parse(app, argc, argv, "tessera-worker")) std::exit(*ended);
  return options;
}

}  // namespace tessera::worker
