// SPDX-License-Identifier: Apache-2.0
#include "client/demo/demo_command.hpp"

#include <fmt/format.h>
#include <stdlib.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "client/console.hpp"
#include "client/demo/demo_farm.hpp"
#include "client/example_scenes.hpp"
#include "client/farm/bundle.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/submission.hpp"
#include "client/farm/watching.hpp"
#include "client/interrupt.hpp"
#include "client/notices.hpp"
#include "proto/json.hpp"

namespace tessera::client {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kPause{200};
// The best-looking example, and one that is always there.
constexpr const char* kFirstScene = "still_life";
constexpr const char* kOtherScene = "cornell";

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

std::string scene_of(const DemoOptions& options) {
  if (!options.scene.empty()) return find_scene(options.scene);
  const std::string first = find_scene(kFirstScene);
  return first == kFirstScene ? find_scene(kOtherScene) : first;
}

void print_addresses(const DemoFarm& farm, bool json) {
  const nlohmann::ordered_json addresses = {{"page", farm.page()}, {"coordinator", farm.address()}};
  print_result(json ? proto::to_line(addresses) + "\n"
                    : fmt::format("The page of this farm: {}\nCtrl-C ends the demo.\n", farm.page()));
}

core::Result<v1::Job> follow(Farm& farm, const std::string& job_id, bool json) {
  Notices none;
  return json ? watch_with_lines(farm, job_id, none) : watch_with_progress(farm, job_id, none);
}

// Renders the scene, and returns the exit status that its job deserves.
core::Result<int> render_on(const std::string& address, const LocalBundle& local, bool json) {
  const auto opened = Farm::open({.address = address});
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
                         short_id(job->id()), address));
  return kExitOk;
}

int run_demo(const DemoOptions& options) {
  if (const core::Status installed = check_demo_programs(); !installed) return print_error(installed.error());
  const auto local = bundle_scene(scene_of(options), {});
  if (!local) return print_error(local.error());
  print_warnings(local->warnings);
  const TemporaryFolder folder;
  if (folder.path().empty())
    return print_error("cannot make a temporary folder: set TMPDIR to one that can be written to");
  watch_for_interrupt();
  const auto farm = DemoFarm::start(folder.path(), options.http);
  if (!farm) return print_error(farm.error());
  print_addresses(**farm, options.json);
  const auto status = render_on((*farm)->address(), *local, options.json);
  if (interrupted()) return options.once ? kExitInterrupted : kExitOk;
  if (!status) return print_error(status.error());
  if (options.once || *status != kExitOk) return *status;
  while (sleep_unless_interrupted(kPause)) {
  }
  return kExitOk;
}

}  // namespace

void add_demo_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("demo", "Run a farm in this process for a first look");
  const auto options = std::make_shared<DemoOptions>();
  command
      ->add_option("SCENE", options->scene,
                   "Scene file (JSON), or the name of an example scene [default: still_life]")
      ->check(suggest_example);
  command->add_option("--http", options->http, "Address of the page; port 0 for a free one")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  command->add_flag("--once", options->once, "End when the image is done");
  command->add_flag(
      "--json", options->json,
      "Print JSON: a line with the addresses of page and coordinator, then one at every change of the job");
  cli::set_help(
      *command,
      {.notes = "Coordinator, worker and page run in this process, with a temporary folder for their "
                "state. Scenes are read in tessera-validator and tessera-scene-loader, which must be in the "
                "folder of this program.",
       .exit_statuses = {{kExitOk, "ended by Ctrl-C; with --once: the image is done"},
                         {kExitFailed, "failed"},
                         {kExitUsage, "wrong command line"},
                         {kExitInterrupted, "with --once: interrupted"}},
       .examples = {"tessera demo", "tessera demo cornell --once"}});
  command->callback([options, &exit_code] { exit_code = run_demo(*options); });
}

}  // namespace tessera::client
