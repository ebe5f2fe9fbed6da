#include "server/limit_flags.hpp"

#include <chrono>
#include <cstdint>
#include <limits>
#include <string>

#include "core/scene/settings.hpp"
#include "proto/number_range.hpp"
#include "server/validator/flags.hpp"

namespace tessera::server {

namespace {

constexpr std::uint64_t kMany = 1'000'000'000;
constexpr std::uint64_t kMostMib = std::uint64_t{1} << 30;  // a pebibyte
// Less than a validator maps before it reads anything, and results of workers do not fit into less.
constexpr std::uint64_t kLeastValidatorMib = 128;
constexpr std::uint64_t kLeastReceiveMib = 64;
constexpr int kLeastMessageMib = 16, kMostMessageMib = 1024;
// What a texture can have in any case.
constexpr std::uint64_t kMostTexturePixels = std::uint64_t{1} << 28;
constexpr double kMostSeconds = 86400;

template <typename T>
void add(CLI::App& app, const char* flag, T& value, T least, T most, const char* what) {
  app.add_option(flag, value, what)
      ->check(proto::number_between(least, most))
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
      ->check(proto::number_between(1.0, kMostSeconds))
      ->type_name("N")
      ->default_str(std::to_string(std::chrono::duration_cast<std::chrono::seconds>(value).count()))
      ->group("Limits");
}

void add_job_flags(CLI::App& app, Limits& limits) {
  const auto most_pixels = static_cast<std::uint64_t>(core::kMaxImagePixels);
  add<std::uint64_t>(app, "--max-picture-pixels", limits.picture_pixels, 1, most_pixels,
                     "Pixels of a picture; a job takes up to 48 bytes of memory for each");
  add<std::uint32_t>(app, "--max-spp", limits.spp, 1, core::kMaxSpp, "Samples per pixel of a job");
  add<std::uint64_t>(app, "--max-open-jobs", limits.open_jobs, 1, kMany,
                     "Unfinished jobs of one submitter; without --tokens, of all together");
}

void add_scene_flags(CLI::App& app, Limits& limits) {
  add<std::uint64_t>(app, "--max-bundle-mib", limits.bundle_mib, 1, kMostMib, "A scene and all its files");
  add<std::uint64_t>(app, "--max-bundle-files", limits.bundle_files, 1, kMany, "Most files of a scene");
  add<std::uint64_t>(app, "--max-blob-mib", limits.blob_mib, 1, kMostMib, "One file of a scene");
  add<std::uint64_t>(app, "--max-store-mib", limits.store_mib, 1, kMostMib,
                     "All files of scenes together, those on their way included");
  add<std::uint64_t>(app, "--max-uploads", limits.uploads, 1, kMany, "Files that are uploaded at once");
  add<std::uint64_t>(app, validator::kTrianglesFlag, limits.triangles, 1, kMany,
                     "Triangles of a scene's meshes");
  add<std::uint64_t>(app, validator::kTexturePixelsFlag, limits.texture_pixels, 1, kMostTexturePixels,
                     "Pixels of a texture");
  add<std::uint64_t>(app, validator::kSceneTexturePixelsFlag, limits.scene_texture_pixels, 1,
                     std::numeric_limits<std::uint32_t>::max() * kMib, "Pixels of all textures of a scene");
}

void add_validator_flags(CLI::App& app, Limits& limits) {
  add(app, "--validations", limits.validations, 1, 256, "Scenes that are validated at once");
  add<std::uint64_t>(app, "--max-waiting-scenes", limits.waiting_scenes, 1, kMany,
                     "Scenes that wait to be validated");
  add<std::uint64_t>(app, validator::kMemoryFlag, limits.validator_mib, kLeastValidatorMib, kMostMib,
                     "Memory for validating one scene");
  add_seconds(app, validator::kSecondsFlag, limits.validation_time, "Time for validating one scene");
}

void add_call_flags(CLI::App& app, Limits& limits) {
  add<std::uint64_t>(app, "--max-connections", limits.connections, 1, kMany,
                     "Connections of workers and users, all together; more are closed at once");
  add<std::uint64_t>(app, "--max-machine-connections", limits.machine_connections, 1, kMany,
                     "Connections of one machine (IPv4 address, or 64 bits of an IPv6 address)");
  add<std::uint64_t>(app, "--max-fetches", limits.fetches, 1, kMany, "Files that workers fetch at once");
  add<std::uint64_t>(app, "--max-watches", limits.watches, 1, kMany, "Jobs that are watched at once");
  add<std::uint64_t>(app, "--max-image-mib", limits.image_mib, 1, kMostMib,
                     "Memory for pictures that are fetched at once; one is always made");
  add_seconds(app, "--stall-seconds", limits.stall_time,
              "Uploads, files and pictures that are fetched, and jobs that are watched, whose callers stand "
              "still for so long are ended");
  add<std::uint64_t>(app, "--max-calls", limits.calls, 16, kMany, "Most calls under way at once");
  add<std::uint64_t>(app, "--max-receive-mib", limits.receive_mib, kLeastReceiveMib, kMostMib,
                     "Most MiB of memory for connections, calls and messages while they are received");
  add<std::uint64_t>(app, "--max-answer-mib", limits.answer_mib, 1, kMostMib,
                     "Most MiB of answers that callers have not read yet");
  add(app, "--max-message-mib", limits.message_mib, kLeastMessageMib, kMostMessageMib, "One message");
  add(app, "--max-calls-per-second", limits.calls_per_second, 1.0, 1e9,
      "Calls of one submitter (without --tokens: of one machine), or of one worker; ten seconds' worth at "
      "once");
}

}  // namespace

void add_limit_flags(CLI::App& app, Limits& limits) {
  add_job_flags(app, limits);
  add_scene_flags(app, limits);
  add_validator_flags(app, limits);
  add_call_flags(app, limits);
}

}  // namespace tessera::server
