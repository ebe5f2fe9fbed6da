// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/console.hpp"
#include "client/farm/farm.hpp"
#include "client/farm/image_download.hpp"
#include "client/farm/job_lookup.hpp"
#include "client/farm/job_text.hpp"
#include "client/farm/single_commands.hpp"
#include "client/frames.hpp"
#include "client/image_files.hpp"
#include "client/scene_flags.hpp"

namespace tessera::client {
namespace {

struct ImageOptions {
  FarmOptions farm;
  std::string job;
  std::optional<std::uint32_t> image;
  std::vector<std::int32_t> frames;
  SceneFlags scene;  // its output paths and display options alone
  std::optional<core::PixelRect> region;
  std::string layer;
  bool json = false;
};

// An image of the job, and the files for it.
struct WantedImage {
  std::uint32_t image = 0;
  std::vector<std::string> paths;
};

core::Result<v1::Job> job_with_images(Farm& farm, const std::string& id) {
  v1::GetJobRequest request;
  request.set_job_id(id);
  const auto response = farm.call(&Farm::Stub::GetJob, request);
  return response ? core::Result<v1::Job>(response->job()) : core::fail(response.error());
}

// The images of the frames that are asked for, or of all.
core::Result<std::vector<WantedImage>> images_by_frame(Farm& farm, const ImageOptions& options,
                                                       const std::string& id) {
  const auto job = job_with_images(farm, id);
  if (!job) return core::fail(job.error());
  std::map<std::int32_t, std::uint32_t> images;
  for (int i = 0; i < job->images_size(); ++i)
    images.emplace(job->images(i).frame(), static_cast<std::uint32_t>(i));
  std::vector<std::int32_t> frames = options.frames;
  if (frames.empty())
    for (const auto& [frame, image] : images) frames.push_back(frame);
  std::vector<WantedImage> wanted;
  for (const std::int32_t frame : frames) {
    const auto found = images.find(frame);
    if (found == images.end())
      return core::fail(core::ErrorCode::kInvalidArgument,
                        fmt::format("--frames: job {} has no frame {}", short_id(id), frame));
    wanted.push_back({found->second, paths_of_frame(options.scene.output_paths, frame)});
  }
  return wanted;
}

// One by its number, unless frames are asked for.
core::Result<std::vector<WantedImage>> wanted_images(Farm& farm, const ImageOptions& options,
                                                     const std::string& id) {
  const auto& paths = options.scene.output_paths;
  const bool is_by_frame = !options.image && (!options.frames.empty() ||
                                              std::any_of(paths.begin(), paths.end(), has_frame_number));
  if (is_by_frame) return images_by_frame(farm, options, id);
  return std::vector<WantedImage>{{options.image.value_or(0), paths}};
}

int run_image(const ImageOptions& options) {
  warn_about_idle_display(options.scene.output_paths, options.scene.display);
  const auto opened = Farm::open(options.farm);
  if (!opened) return print_error(opened.error());
  Farm& farm = **opened;
  const auto found = find_job(farm, options.job);
  if (!found) return print_error(found.error());
  const auto images = wanted_images(farm, options, found->id());
  if (!images) return print_error(images.error());
  if (core::Status distinct = check_frame_paths(options.scene.output_paths, images->size()); !distinct)
    return print_error(distinct.error());
  core::Result<v1::Job> job = *found;
  std::vector<std::string> paths;
  for (const WantedImage& each : *images) {
    if (core::Status writable = check_image_paths(each.paths); !writable)
      return print_error(writable.error());
    job = download_images(farm, found->id(), each.paths,
                          {.display = options.scene.display,
                           .region = options.region,
                           .image = each.image,
                           .layer = options.layer});
    if (!job) return print_error(job.error());
    paths.insert(paths.end(), each.paths.begin(), each.paths.end());
  }
  if (options.json) {
    auto json = proto::to_json(*job);
    json["written"] = paths;
    print_result(proto::to_line(json) + "\n");
  }
  print_note(fmt::format("wrote {}: job {} ({}) is {}, {} of {} samples", fmt::join(paths, ", "),
                         short_id(job->id()), job->name(), state_name(job->state()), job->samples_done(),
                         job->samples_total()));
  return kExitOk;
}

}  // namespace

void add_image_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("image", "Download a job's image, finished or not");
  const auto options = std::make_shared<ImageOptions>();
  add_job_argument(*command, options->job);
  command
      ->add_option_function<std::uint32_t>(
          "--image", [options](std::uint32_t image) { options->image = image; },
          "Number of the image, of a job with several: 0 is the first [default: 0]")
      ->type_name("N");
  add_frame_list(*command, options->frames,
                 "Frames to write, such as 1-48; a run of # in the name of a file stands for the number "
                 "[default: all, if there is such a name]");
  add_output_option(*command, options->scene);
  command
      ->add_option_function<std::string>(
          "--region", [options](const std::string& text) { options->region = parse_rect("--region", text); },
          "Write only the pixels from (X0, Y0) at the top left to (X1, Y1), which is excluded")
      ->type_name("X0,Y0,X1,Y1");
  command
      ->add_option("--layer", options->layer,
                   "Write this layer of the job instead of the beauty, in three channels, such as albedo. "
                   "Without it, OpenEXR files have all layers")
      ->type_name("NAME");
  add_display_options(*command, options->scene.display);
  command->add_flag("--json", options->json,
                    "Print the job as one line of JSON, with the files as \"written\"");
  add_farm_options(*command, options->farm);
  cli::set_help(*command, {.notes = "An unfinished image has the samples that have been taken so far.",
                           .exit_statuses = kUsualExitStatuses,
                           .examples = {"tessera image 1f0c -o draft.png", "tessera image 1f0c -o final.exr",
                                        "tessera image 1f0c -o part.exr --region 100,40,164,72",
                                        "tessera image 1f0c -o out.####.exr"}});
  command->callback([options, &exit_code] {
    if (options->scene.output_paths.empty()) throw CLI::RequiredError("-o FILE");
    exit_code = run_image(*options);
  });
}

}  // namespace tessera::client
