// SPDX-License-Identifier: Apache-2.0
// `tessera view` of files and of jobs, whose image is drawn again as it changes.
#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "client/console.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/job_lookup.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/single_commands.hpp"
#include "client/farm/tile_image.hpp"
#include "client/farm/watching.hpp"
#include "client/interrupt.hpp"
#include "client/screen/image_facts.hpp"
#include "client/screen/screen.hpp"
#include "client/screen/view_command.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "proto/json.hpp"

namespace tessera::client {
namespace {

constexpr std::chrono::milliseconds kRedrawPause{200};
// Of an image that is kept in memory: 400 MB.
constexpr std::size_t kMaxPixels = std::size_t{1} << 25;

struct JobViewOptions {
  FarmOptions farm;
  ViewOptions view;
};

std::string caption_of(const v1::Job& job, std::uint64_t samples_done) {
  const double share = job.samples_total() == 0
                           ? 0
                           : static_cast<double>(samples_done) / static_cast<double>(job.samples_total());
  // The job is of the time when its state changed; tiles that came since tell that it waits no more.
  const std::string state = samples_done > job.samples_done() ? state_name(job.state()) : shown_state(job);
  return fmt::format("{} ({})  {}  {} pixels  {} %", job.name(), short_id(job.id()), state,
                     size_text(job.settings()), static_cast<int>(100 * share));
}

// The image of a job as it arrives.
class LiveImage {
 public:
  using Show = std::function<core::Status(const LiveImage&)>;
  explicit LiveImage(Show show) : show_(std::move(show)) {}

  const v1::Job& job() const { return job_; }
  const core::Image& image() const { return image_; }
  std::uint64_t samples_done() const { return samples_done_; }
  std::uint64_t revision() const { return revision_; }

  core::Status accept(const v1::WatchTilesResponse& response) {
    if (response.has_job())
      if (core::Status changed = accept_job(response.job()); !changed) return changed;
    for (const v1::TileImage& tile : response.tiles()) {
      if (core::Status painted = paint_tile(tile, window_, image_); !painted) return painted;
      count(tile);
    }
    if (response.revision() > 0) revision_ = response.revision();
    const auto now = std::chrono::steady_clock::now();
    if (now - drawn_at_ < kRedrawPause && response.revision() == 0) return {};
    drawn_at_ = now;
    return redraw();
  }

  core::Status redraw() { return window_.empty() ? core::Status() : show_(*this); }

 private:
  // The job itself is sent only when its state changes.
  void count(const v1::TileImage& tile) {
    const v1::PixelRect& rect = tile.rect();
    const std::uint64_t samples =
        std::uint64_t{tile.samples()} * (rect.x1() - rect.x0()) * (rect.y1() - rect.y0());
    std::uint64_t& before = samples_of_tiles_[{rect.x0(), rect.y0()}];
    samples_done_ += samples - std::exchange(before, samples);
  }

  core::Status accept_job(const v1::Job& job) {
    job_ = job;
    const core::PixelRect window = proto::window_of(job.settings());
    if (window.empty() || window == window_) return {};
    if (window.pixel_count() > kMaxPixels)
      return core::fail(core::ErrorCode::kResourceExhausted,
                        "the image is too large to be shown: tessera image --region fetches parts of it");
    window_ = window;
    image_ = core::Image(window.width(), window.height());
    return {};
  }

  const Show show_;
  v1::Job job_;
  core::PixelRect window_;
  core::Image image_;
  std::uint64_t revision_ = 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> samples_of_tiles_;  // by their top left
  std::uint64_t samples_done_ = 0;
  std::chrono::steady_clock::time_point drawn_at_{};
};

// Shows one stream to its end.
core::Result<bool> follow_tiles(Farm& farm, const std::string& job_id, const std::string& layer,
                                LiveImage& live, bool& progress) {
  grpc::ClientContext context;
  const std::jthread canceller = cancel_at_interrupt(context);
  v1::WatchTilesRequest request;
  request.set_job_id(job_id);
  request.set_since_revision(live.revision());
  request.set_format(v1::TILE_FORMAT_RGB16F);
  request.set_layer(layer);
  const auto stream = farm.stub().WatchTiles(&context, request);
  v1::WatchTilesResponse response;
  core::Status shown;
  while (shown && stream->Read(&response)) {
    progress = true;
    shown = live.accept(response);
    if (results_are_lost()) interrupt();
  }
  if (!shown) context.TryCancel();
  const grpc::Status status = stream->Finish();
  if (!shown) return core::fail(shown.error());
  if (interrupted()) return core::fail(core::ErrorCode::kCancelled, "interrupted");
  if (!status.ok()) return core::fail(farm.explain(status, context));
  return true;
}

core::Status draw(Screen& screen, const core::DisplayOverrides& overrides, const LiveImage& live) {
  const auto display = proto::resolve_display(live.job().display(), proto::to_proto(overrides));
  if (!display) return core::fail(display.error());
  return screen.show(live.image(), *display, caption_of(live.job(), live.samples_done()), true);
}

core::Status print_facts(const LiveImage& live) {
  nlohmann::ordered_json facts = image_facts(live.job().id(), live.image());
  facts["state"] = shown_state(live.job());
  facts["samples_done"] = live.samples_done();
  facts["samples_total"] = live.job().samples_total();
  print_result(proto::to_line(facts) + "\n");
  return {};
}

int view_job(const JobViewOptions& options) {
  std::optional<Screen> screen;
  if (!options.view.json) {
    auto there = Screen::open(options.view.graphics);
    if (!there) return print_error(there.error());
    screen.emplace(*std::move(there));
  }
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto found = find_job(farm, options.view.image);
  if (!found) return print_error(found.error());
  watch_for_interrupt();
  LiveImage live([&](const LiveImage& image) {
    return screen ? draw(*screen, options.view.display, image) : print_facts(image);
  });
  auto ended = patiently<bool>(farm, [&](bool& progress) {
    return follow_tiles(farm, found->id(), options.view.layer, live, progress);
  });
  const core::Status last = ended ? live.redraw() : core::Status{};
  if (screen) screen->close();
  if (interrupted()) return results_are_lost() ? kExitOk : kExitInterrupted;
  if (!ended) return print_error(ended.error());
  return last ? report_end(live.job()) : print_error(last.error());
}

bool is_present(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

// A name with an ending is not meant as an id.
int run_view(const JobViewOptions& options) {
  const std::string& image = options.view.image;
  const bool is_file = is_present(image) || image.find_first_of("./") != std::string::npos;
  return is_file ? view_file(options.view) : view_job(options);
}

}  // namespace

void add_job_view_command(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<JobViewOptions>();
  CLI::App* command = add_view_options(
      app, "Image file (.png, .exr, .hdr or .pfm), or the id of a job, or its first digits", options->view);
  add_farm_options(*command, options->farm);
  cli::set_help(*command,
                {.notes = "The image of a job is drawn again as it changes, until the job ends. Ctrl-C stops "
                          "watching. The job goes on.",
                 .exit_statuses = {{kExitOk, "shown; of a job: it is done"},
                                   {kExitFailed, "failed, or the job failed or was cancelled"},
                                   {kExitUsage, "wrong command line"},
                                   {kExitInterrupted, "interrupted"}},
                 .examples = {"tessera view image.exr --exposure 1", "tessera view 1f0c"}});
  command->callback([options, &exit_code] { exit_code = run_view(*options); });
}

}  // namespace tessera::client
