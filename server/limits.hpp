// SPDX-License-Identifier: Apache-2.0
// What a farm takes from those who call it, so that none of them can use it up. Each is an option of
// tessera-coordinator (limit_flags.cpp), and the sentence of every refusal names it. Plain data.
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::server {

inline constexpr std::uint64_t kMib = std::uint64_t{1} << 20;

struct Limits {
  // Of a job. Its film takes up to 48 bytes of memory for each pixel until it is finished.
  std::uint64_t picture_pixels = std::uint64_t{1} << 28;
  std::uint32_t spp = 1u << 20;
  // Jobs of one submitter that are checked, running or paused. Without tokens all are of one submitter.
  std::uint64_t open_jobs = 1000;

  // Of a bundle: how many files, all of them together, and each.
  std::uint64_t bundle_files = 10'000;
  std::uint64_t bundle_mib = 16 * 1024;
  std::uint64_t blob_mib = 4 * 1024;
  // Of all files of scenes that are here or on their way, and how many may be on their way at once.
  std::uint64_t store_mib = 256 * 1024;
  std::uint64_t uploads = 64;

  // Of a scene, found when it is validated: the triangles of its meshes, its lights (emissive triangles,
  // quads and spheres, those of every instance included), and the pixels of one picture and of all pictures
  // that its textures are read from.
  std::uint64_t triangles = 100'000'000;
  std::uint64_t lights = 10'000'000;
  std::uint64_t texture_pixels = std::uint64_t{1} << 28;
  std::uint64_t scene_texture_pixels = std::uint64_t{1} << 30;

  // Of validating: how many scenes at once, how many may wait for that, and what each may take.
  int validations = 2;
  std::uint64_t waiting_scenes = 64;
  std::uint64_t validator_mib = 16 * 1024;
  std::chrono::milliseconds validation_time = std::chrono::minutes(5);

  // Of connections: all together, and of one machine.
  std::uint64_t connections = 10'000;
  std::uint64_t machine_connections = 5'000;

  // Files that workers fetch at once.
  std::uint64_t fetches = 2048;
  // Jobs that are watched at once; a job that several watch counts for each.
  std::uint64_t watches = 4096;
  // Of pictures that are fetched: the memory of all together, while they are made and sent. One is always
  // made.
  std::uint64_t image_mib = 8 * 1024;
  // Streams whose callers stand still for so long are ended, and pictures wait for memory no longer.
  std::chrono::milliseconds stall_time = std::chrono::minutes(1);

  // Of calls: how many may be under way, the memory of all while they are received, and that of answers whose
  // callers have not taken them yet.
  std::uint64_t calls = 32'768;
  std::uint64_t receive_mib = 1024;
  std::uint64_t answer_mib = 256;
  // One message, and how often a caller may call. Who has been quiet may call as often at once as in
  // kBurstSeconds.
  int message_mib = 64;
  double calls_per_second = 1000;

  std::uint64_t bundle_bytes() const { return bundle_mib * kMib; }
  std::uint64_t blob_bytes() const { return blob_mib * kMib; }
  std::uint64_t store_bytes() const { return store_mib * kMib; }
};

inline constexpr double kBurstSeconds = 10;

// "FOUND, and this farm takes at most MOST (tessera-coordinator OPTION)".
inline core::Error over_limit(std::string_view found, std::string_view most, std::string_view option) {
  return {core::ErrorCode::kResourceExhausted,
          fmt::format("{}, and this farm takes at most {} (tessera-coordinator {})", found, most, option)};
}

// The same for places that callers share (FairShare), of which the caller has `own`: "too many SCENES WAIT,
// ...", or "OWN SCENES from here WAIT already, ...".
inline core::Error over_share(std::uint64_t own, std::string_view things, std::string_view what_they_do,
                              std::uint64_t most, std::string_view option) {
  if (own == 0)
    return over_limit(fmt::format("too many {} {}", things, what_they_do), std::to_string(most), option);
  core::Error error = over_limit(fmt::format("{} {} from here {} already", own, things, what_they_do),
                                 fmt::format("{} from all callers", most), option);
  error.message += ", some of which it keeps for others";
  return error;
}

}  // namespace tessera::server
