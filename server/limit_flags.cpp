// SPDX-License-Identifier: Apache-2.0
#include "server/limit_flags.hpp"

#include <chrono>
#include <cstdint>
#include <limits>
#include <string>

#include "core/common/number_range.hpp"
#include "core/scene/settings.hpp"
#include "server/validator/flags.hpp"

namespace tessera::server {

namespace {

constexpr std::uint64_t kMany = 1'000'000'000;
constexpr std::uint32_t kMaxImages = 1'000'000;
constexpr std::uint64_t kMaxMib = std::uint64_t{1} << 30;  // a pebibyte
// A validator maps more than this before it reads anything, and results of workers need more.
constexpr std::uint64_t kMinValidatorMib = 128;
constexpr std::uint64_t kMinReceiveMib = 64, kMinCalls = 16;
constexpr int kMinMessageMib = 16, kMaxMessageMib = 1024;
// The limit on one texture image that always applies.
constexpr std::uint64_t kMaxTexturePixels = std::uint64_t{1} << 28;
constexpr double kMaxSeconds = 86400;
constexpr double kMinFilmGib = 0.0625, kMaxFilmGib = 1 << 20;

template <typename T>
void add(CLI::App& app, const char* flag, T& value, T least, T most, const char* what) {
  app.add_option(flag, value, what)
      ->check(common::number_between(least, most))
      ->type_name("N")
      ->capture_default_str()
      ->group("Limits");
}

void add_seconds(CLI::App& app, const char* flag, std::chrono::milliseconds& value, const char* what) {
  using Seconds = std::chrono::duration<double>;
  app.add_option_function<double>(
         flag,
         [&value](double seconds) {
           value = std::chrono::duration_cast<std::chrono::milliseconds>(Seconds(seconds));
         },
         what)
      ->check(common::number_between(1.0, kMaxSeconds))
      ->type_name("N")
      ->default_str(std::to_string(std::chrono::duration_cast<std::chrono::seconds>(value).count()))
      ->group("Limits");
}

void add_job_flags(CLI::App& app, Limits& limits) {
  app.add_option(
         "--max-film-gib", limits.film_gib,
         "Maximum GiB of memory for the images of unfinished jobs; what exceeds it is read back from the "
         "state folder")
      ->check(common::number_between(kMinFilmGib, kMaxFilmGib))
      ->type_name("N")
      ->default_str("half of the memory")
      ->group("Limits");
  const auto most_pixels = static_cast<std::uint64_t>(core::kMaxImagePixels);
  // The second name is that of 0.1.0, which files of options may have.
  add<std::uint64_t>(app, "--max-image-pixels,--max-picture-pixels", limits.image_pixels, 1, most_pixels,
                     "Maximum pixels of an image");
  add<std::uint32_t>(app, "--max-spp", limits.spp, 1, core::kMaxSpp, "Maximum samples per pixel of a job");
  add<std::uint32_t>(app, "--max-images", limits.images, 1, kMaxImages, "Maximum images (frames) of a job");
  add<std::uint64_t>(app, "--max-open-jobs", limits.open_jobs, 1, kMany,
                     "Maximum unfinished jobs of one owner; without --tokens, of all together");
}

void add_scene_flags(CLI::App& app, Limits& limits) {
  add<std::uint64_t>(app, "--max-bundle-mib", limits.bundle_mib, 1, kMaxMib,
                     "Maximum MiB of a scene with all its files");
  add<std::uint64_t>(app, "--max-bundle-files", limits.bundle_files, 1, kMany, "Maximum files of a scene");
  add<std::uint64_t>(app, "--max-blob-mib", limits.blob_mib, 1, kMaxMib,
                     "Maximum MiB of one file of a scene");
  add<std::uint64_t>(app, "--max-store-mib", limits.store_mib, 1, kMaxMib,
                     "Maximum MiB of the files of all scenes, uploads in progress included");
  add<std::uint64_t>(app, "--max-uploads", limits.uploads, 1, kMany, "Maximum uploads at once");
  add<std::uint64_t>(app, validator::kTrianglesFlag, limits.triangles, 1, kMany,
                     "Maximum triangles of a scene's meshes");
  add<std::uint64_t>(
      app, validator::kLightsFlag, limits.lights, 1, kMany,
      "Maximum lights of a scene: emissive triangles and other shapes, again for every instance");
  add<std::uint64_t>(app, validator::kTexturePixelsFlag, limits.texture_pixels, 1, kMaxTexturePixels,
                     "Maximum pixels of a texture");
  add<std::uint64_t>(app, validator::kSceneTexturePixelsFlag, limits.scene_texture_pixels, 1,
                     std::numeric_limits<std::uint32_t>::max() * kMib,
                     "Maximum pixels of all textures of a scene");
}

void add_validator_flags(CLI::App& app, Limits& limits) {
  add(app, "--validations", limits.validations, 1, 256, "Maximum scenes that are validated at once");
  add<std::uint64_t>(app, "--max-waiting-scenes", limits.waiting_scenes, 1, kMany,
                     "Maximum scenes that wait to be validated");
  add<std::uint64_t>(app, validator::kMemoryFlag, limits.validator_mib, kMinValidatorMib, kMaxMib,
                     "Maximum MiB of memory for validating one scene");
  add_seconds(app, validator::kSecondsFlag, limits.validation_time,
              "Maximum seconds for validating one scene");
}

void add_call_flags(CLI::App& app, Limits& limits) {
  add<std::uint64_t>(app, "--max-connections", limits.connections, 1, kMany,
                     "Maximum connections of all callers; further ones are closed at once");
  add<std::uint64_t>(app, "--max-machine-connections", limits.machine_connections, 1, kMany,
                     "Maximum connections of one machine (an IPv4 address, or 64 bits of an IPv6 address)");
  add<std::uint64_t>(app, "--max-fetches", limits.fetches, 1, kMany,
                     "Maximum files that workers fetch at once");
  add<std::uint64_t>(app, "--max-watches", limits.watches, 1, kMany, "Maximum jobs that are watched at once");
  add<std::uint64_t>(app, "--max-image-mib", limits.image_mib, 1, kMaxMib,
                     "Maximum MiB of memory for images that are downloaded at once; one is always served");
  add_seconds(app, "--stall-seconds", limits.stall_time,
              "End an upload, download or watch whose caller takes nothing for so many seconds");
  add<std::uint64_t>(app, "--max-calls", limits.calls, kMinCalls, kMany,
                     "Maximum calls in progress of all callers, waiting workers included");
  add<std::uint64_t>(app, "--max-receive-mib", limits.receive_mib, kMinReceiveMib, kMaxMib,
                     "Maximum MiB of memory for connections, calls and messages while they are received");
  add<std::uint64_t>(app, "--max-answer-mib", limits.answer_mib, 1, kMaxMib,
                     "Maximum MiB of responses that callers have not read yet");
  add(app, "--max-message-mib", limits.message_mib, kMinMessageMib, kMaxMessageMib,
      "Maximum MiB of one message");
  add(app, "--max-calls-per-second", limits.calls_per_second, 1.0, 1e9,
      "Maximum calls a second of one owner (without --tokens: of one machine) or one worker; bursts can "
      "have ten "
      "seconds' worth");
}

}  // namespace

void add_limit_flags(CLI::App& app, Limits& limits) {
  add_job_flags(app, limits);
  add_scene_flags(app, limits);
  add_validator_flags(app, limits);
  add_call_flags(app, limits);
}

}  // namespace tessera::server
