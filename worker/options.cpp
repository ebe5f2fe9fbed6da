// SPDX-License-Identifier: Apache-2.0
#include "worker/options.hpp"

#include <pwd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "core/base/available_resources.hpp"
#include "core/base/version.hpp"
#include "core/cli/config_file.hpp"
#include "core/cli/help.hpp"
#include "core/cli/parse.hpp"
#include "core/common/log_flags.hpp"
#include "core/common/metrics_flag.hpp"
#include "core/common/number_range.hpp"
#include "core/sandbox/flags.hpp"
#include "proto/security_flags.hpp"
#include "proto/text.hpp"

namespace tessera::worker {
namespace {

constexpr unsigned kMaxThreads = 1024;
// A loader maps some of this before it reads anything.
constexpr std::uint64_t kMinSceneMib = 128, kMaxSceneMib = std::uint64_t{1} << 30;
constexpr std::int64_t kMaxSceneSeconds = 86400;

const cli::HelpText kHelp{
    .notes =
        R"(Log lines go to stderr. SIGINT and SIGTERM end the worker after what it has rendered is delivered; a second
SIGINT ends it at once. SIGHUP reads the files of certificates and token again.)",
    .exit_statuses = {{cli::kExitOk, "stopped by a signal or by an administrator"},
                      {cli::kExitFailed, "failed"},
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

void add_loader_flags(CLI::App& app, LoaderOptions& loader) {
  app.add_option("--scene-loader", loader.program,
                 "Program that loads scenes [default: tessera-scene-loader beside this program]")
      ->type_name("FILE");
  app.add_option(kSceneMemoryFlag, loader.memory_mib,
                 "Maximum MiB of memory for loading a scene [default: the memory that this process may use]")
      ->check(common::number_between(kMinSceneMib, kMaxSceneMib))
      ->type_name("N");
  app.add_option_function<std::int64_t>(
         kSceneSecondsFlag, [&loader](std::int64_t seconds) { loader.time = std::chrono::seconds(seconds); },
         "Maximum seconds for loading a scene")
      ->check(common::number_between(std::int64_t{1}, kMaxSceneSeconds))
      ->type_name("N")
      ->default_str(std::to_string(loader.time.count()));
  app.add_flag(sandbox::kCompleteFlag, loader.require_sandbox,
               "Do not start if this machine lacks a part of the sandbox in which scenes are loaded")
      ->group("Security");
}

}  // namespace

Options::Options() : threads(core::available_threads()), cache(default_cache()), name(host_name()) {}

Options parse_options(int argc, char** argv) {
  Options options;
  CLI::App app("Render scenes for a Tessera farm", "tessera-worker");
  cli::set_help(app, kHelp);
  app.set_version_flag("--version", "tessera-worker " + std::string(core::version()), "Print the version");
  cli::add_config_option(app);
  app.add_option("--coordinator", options.coordinator, "Address of the farm's coordinator")
      ->envname(proto::kCoordinatorVariable)
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option(
         "--threads", options.threads,
         "Number of threads [default: one per processor that this process may use by control group and "
         "affinity mask, at most SLURM_CPUS_PER_TASK or, without that, OMP_NUM_THREADS]")
      ->check(common::number_between(1u, kMaxThreads))
      ->type_name("N");
  app.add_option("--cache", options.cache,
                 "Folder for the files of scenes and for built scenes, writable by this user alone; workers "
                 "can share it "
                 "[default: ~/.cache/tessera]")
      ->type_name("DIR");
  app.add_option(
         "--cache-gib", options.cache_gib,
         "Size limit of the cache in GiB; files unused for longest are removed first, and scenes with "
         "more files are declined")
      ->check(common::number_between(0.001, 1e6))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--serve-blobs", options.serve_blobs,
                 "Serve files of scenes to other workers at this IP address, 0.0.0.0 or [::] for all of this "
                 "machine; "
                 "port 0 picks a free port [default: not served]")
      ->type_name("HOST:PORT");
  app.add_option("--name", options.name, "Name of this worker in lists and logs [default: the host name]")
      ->type_name("NAME");
  proto::add_security_flags(app, options.security);
  add_loader_flags(app, options.loader);
  common::add_metrics_flag(app, options.metrics);
  common::add_log_flags(app, options.log);
  app.add_flag(
      "--verbose",
      [&options](std::int64_t times) {
        if (times > 0) options.log.level = spdlog::level::debug;
      },
      "Log debug messages: --log-level debug");
  app.final_callback([&options] {
    if (const core::Status fit = proto::check_text("--name", options.name); !fit)
      throw CLI::ValidationError(fit.error().message);
  });
  if (const auto ended = cli::parse(app, argc, argv, "tessera-worker")) std::exit(*ended);
  return options;
}

}  // namespace tessera::worker
