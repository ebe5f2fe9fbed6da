// SPDX-License-Identifier: Apache-2.0
// `tessera demo`: a farm on this machine for a first look, with a scene that it renders.
#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "client/console.hpp"
#include "client/example_scenes.hpp"
#include "client/farm/bundle.hpp"
#include "client/farm/child_process.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/single_commands.hpp"
#include "client/farm/submission.hpp"
#include "client/farm/watching.hpp"
#include "client/interrupt.hpp"
#include "client/notices.hpp"
#include "proto/json.hpp"

namespace tessera::client {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kStartTimeout{60};
constexpr std::chrono::milliseconds kProgressPause{200};
// The best-looking example, and one that is always there.
constexpr const char* kFirstScene = "still_life";
constexpr const char* kOtherScene = "cornell";
constexpr const char* kCoordinatorName = "tessera-coordinator";
constexpr const char* kWorkerName = "tessera-worker";

struct DemoOptions {
  std::string scene;  // empty: the first scene that is there
  std::string http = "127.0.0.1:0";
  bool once = false;
  bool json = false;
};

// Removed at the end, with what is in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code error;
    std::string pattern = (fs::temp_directory_path(error) / "tessera-demo-XXXXXX").string();
    if (::mkdtemp(pattern.data()) != nullptr) path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code error;
    if (!path_.empty()) fs::remove_all(path_, error);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  // Empty if it could not be made.
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string program_beside_this(const std::string& name) {
  std::error_code error;
  return (fs::read_symlink("/proc/self/exe", error).parent_path() / name).string();
}

// Each is in the Debian package of its name.
core::Status check_programs() {
  std::string missing, packages;
  for (const char* const name : {kCoordinatorName, kWorkerName}) {
    if (::access(program_beside_this(name).c_str(), X_OK) == 0) continue;
    missing += (missing.empty() ? "" : " and ") + std::string(name);
    packages += fmt::format(" ./{}_*.deb", name);
  }
  if (missing.empty()) return {};
  return core::fail(core::ErrorCode::kNotFound,
                    fmt::format("the demo starts {}, which must be in the folder of this program: install "
                                "the Debian packages of these names (apt-get install{})",
                                missing, packages));
}

std::string scene_of(const DemoOptions& options) {
  if (!options.scene.empty()) return find_scene(options.scene);
  const std::string first = find_scene(kFirstScene);
  return first == kFirstScene ? find_scene(kOtherScene) : first;
}

// The processes of the farm, which end with this. The worker ends first.
struct Processes {
  ChildProcess coordinator, worker;
  std::string address, page;
};

core::Result<Processes> start_farm(const DemoOptions& options, const fs::path& folder) {
  auto coordinator = ChildProcess::start(
      program_beside_this(kCoordinatorName),
      {"--listen", "127.0.0.1:0", "--http", options.http, "--state", (folder / "state").string()},
      (folder / "coordinator.log").string());
  if (!coordinator) return core::fail(coordinator.error());
  const std::string says = "tessera-coordinator: ";
  const auto address = coordinator->wait_for_line(says + "listening on ", kStartTimeout);
  if (!address) return core::fail(address.error());
  const auto page = coordinator->wait_for_line(says + "the page is at ", kStartTimeout);
  if (!page) return core::fail(page.error());
  auto worker = ChildProcess::start(
      program_beside_this(kWorkerName),
      {"--coordinator", *address, "--name", "demo", "--cache", (folder / "cache").string()},
      (folder / "worker.log").string());
  if (!worker) return core::fail(worker.error());
  return Processes{.coordinator = *std::move(coordinator),
                   .worker = *std::move(worker),
                   .address = *address,
                   .page = *page};
}

void print_addresses(const Processes& processes, bool json) {
  const nlohmann::ordered_json addresses = {{"page", processes.page}, {"coordinator", processes.address}};
  print_result(json ? proto::to_line(addresses) + "\n"
                    : fmt::format("The page of this farm: {}\nCtrl-C ends the demo.\n", processes.page));
}

core::Result<v1::Job> follow(Farm& farm, const std::string& job_id, bool json) {
  Notices none;
  return json ? watch_with_lines(farm, job_id, none) : watch_with_progress(farm, job_id, none);
}

// Renders the scene, and returns the exit status that its job deserves.
core::Result<int> render_on(const Processes& processes, const LocalBundle& local, bool json) {
  const auto opened = Farm::open({.address = processes.address});
  if (!opened) return core::fail(opened.error());
  Farm& farm = **opened;
  const auto job = submit_job(farm, {}, local);
  if (!job) return core::fail(job.error());
  if (!json)
    print_note(fmt::format("renders {}, {} pixels, {} spp, as job {}", job->name(),
                           size_text(job->settings()), job->settings().spp(), short_id(job->id())));
  const auto ended = follow(farm, job->id(), json);
  if (!ended) return core::fail(ended.error());
  if (const int status = report_end(*ended); status != kExitOk || json) return status;
  print_note(fmt::format("done. Save the image: tessera image {} --coordinator {} -o demo.png",
                         short_id(job->id()), processes.address));
  return kExitOk;
}

// Until Ctrl-C, or until one of the processes ends.
core::Status wait_for_end(Processes& processes) {
  while (sleep_unless_interrupted(kProgressPause)) {
    if (!processes.coordinator.is_running())
      return core::fail(core::ErrorCode::kUnavailable, "the coordinator of the demo has ended");
    if (!processes.worker.is_running())
      return core::fail(core::ErrorCode::kUnavailable, "the worker of the demo has ended");
  }
  return {};
}

int run_demo(const DemoOptions& options) {
  if (const core::Status installed = check_programs(); !installed) return print_error(installed.error());
  const auto local = bundle_scene(scene_of(options), {});
  if (!local) return print_error(local.error());
  print_warnings(local->warnings);
  const TemporaryFolder folder;
  if (folder.path().empty())
    return print_error("cannot make a temporary folder: set TMPDIR to one that can be written to");
  watch_for_interrupt();
  auto processes = start_farm(options, folder.path());
  const int at_interrupt = options.once ? kExitInterrupted : kExitOk;
  if (!processes) return interrupted() ? at_interrupt : print_error(processes.error());
  print_addresses(*processes, options.json);
  const auto status = render_on(*processes, *local, options.json);
  if (interrupted()) return at_interrupt;
  if (!status) return print_error(status.error());
  if (options.once || *status != kExitOk) return *status;
  const core::Status ended = wait_for_end(*processes);
  return ended ? kExitOk : print_error(ended.error());
}

}  // namespace

void add_demo_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("demo", "Start a farm on this machine for a first look");
  const auto options = std::make_shared<DemoOptions>();
  command->add_option("SCENE", options->scene,
                      "Scene file (JSON), or the name of an example scene [default: still_life]");
  command->add_option("--http", options->http, "Address of the page; port 0 for a free one")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  command->add_flag("--once", options->once, "End when the image is done");
  command->add_flag(
      "--json", options->json,
      "Print JSON: a line with the addresses of page and coordinator, then one at every change of the job");
  cli::set_help(
      *command,
      {.notes = "Starts tessera-coordinator and tessera-worker from the folder of this program, with "
                "a temporary folder for their state. All of it ends with this command.",
       .exit_statuses = {{kExitOk, "ended by Ctrl-C; with --once: the image is done"},
                         {kExitFailed, "failed"},
                         {kExitUsage, "wrong command line"},
                         {kExitInterrupted, "with --once: interrupted"}},
       .examples = {"tessera demo", "tessera demo cornell --once"}});
  command->callback([options, &exit_code] { exit_code = run_demo(*options); });
}

}  // namespace tessera::client
