// SPDX-License-Identifier: Apache-2.0
// The limits of a coordinator, so that no caller can exhaust it. Each is an option of tessera-coordinator
// (limit_flags.cpp), which the message of every rejection names. Plain data.
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/error.hpp"
#include "proto/error_reasons.hpp"

namespace tessera::server {

inline constexpr std::uint64_t kMib = std::uint64_t{1} << 20;

// Half of the memory that this process may use.
double default_film_gib();

struct Limits {
  // The memory of all films. What exceeds it is read back from the store when it is needed.
  double film_gib = default_film_gib();

  // Of a job: pixels of its window, samples per pixel, and images.
  std::uint64_t image_pixels = std::uint64_t{1} << 28;
  std::uint32_t spp = 1u << 20;
  std::uint32_t images = 10'000;
  // Jobs of one owner that are checked, running or paused. Without tokens, all jobs have the same
  // owner.
  std::uint64_t open_jobs = 1000;

  // Of a bundle: the number of files, their total size, and the size of each.
  std::uint64_t bundle_files = 10'000;
  std::uint64_t bundle_mib = 16 * 1024;
  std::uint64_t blob_mib = 4 * 1024;
  // The size of all scene files in the store or being uploaded, and the number of uploads at once.
  std::uint64_t store_mib = 256 * 1024;
  std::uint64_t uploads = 64;

  // Of a scene, checked during validation: the triangles of its meshes, its lights (emissive triangles, quads
  // and spheres, instances included), and the pixels of one texture image and of all of them.
  std::uint64_t triangles = 100'000'000;
  std::uint64_t lights = 10'000'000;
  std::uint64_t texture_pixels = std::uint64_t{1} << 28;
  std::uint64_t scene_texture_pixels = std::uint64_t{1} << 30;

  // Of validation: scenes at once, scenes that wait, and the memory and time of each.
  int validations = 2;
  std::uint64_t waiting_scenes = 64;
  std::uint64_t validator_mib = 16 * 1024;
  std::chrono::milliseconds validation_time = std::chrono::minutes(5);

  // Connections in total, and of one machine.
  std::uint64_t connections = 10'000;
  std::uint64_t machine_connections = 5'000;

  // Downloads by workers at once.
  std::uint64_t fetches = 2048;
  // WatchJob calls at once.
  std::uint64_t watches = 4096;
  // The memory of all images while they are encoded and sent. One image is always allowed.
  std::uint64_t image_mib = 8 * 1024;
  // Streams whose callers make no progress for so long are ended. It also bounds how long images wait for
  // memory.
  std::chrono::milliseconds stall_time = std::chrono::minutes(1);

  // Of calls: how many may be in progress, the memory of requests while they are received, and the memory of
  // answers that callers have not read yet.
  std::uint64_t calls = 32'768;
  std::uint64_t receive_mib = 1024;
  std::uint64_t answer_mib = 256;
  // The size of one message, and the calls per second of one caller. A caller that was idle may make the
  // calls of kBurstSeconds at once.
  int message_mib = 64;
  double calls_per_second = 1000;

  std::uint64_t film_bytes() const { return static_cast<std::uint64_t>(film_gib * double{1 << 30}); }
  std::uint64_t bundle_bytes() const { return bundle_mib * kMib; }
  std::uint64_t blob_bytes() const { return blob_mib * kMib; }
  std::uint64_t store_bytes() const { return store_mib * kMib; }
};

inline constexpr double kBurstSeconds = 10;

// "FOUND, and this farm takes at most MOST (tessera-coordinator OPTION)".
inline core::Error over_limit(std::string_view found, std::string_view most, std::string_view option) {
  const core::Error error{
      core::ErrorCode::kResourceExhausted,
      fmt::format("{}, and this farm takes at most {} (tessera-coordinator {})", found, most, option)};
  return error.with({.reason = proto::kLimitExceeded, .option = std::string(option)});
}

// The same for what the caller has used and can give back.
inline core::Error over_quota(std::string_view found, std::string_view most, std::string_view option) {
  return over_limit(found, most, option)
      .with({.reason = proto::kQuotaExceeded, .option = std::string(option)});
}

// The error of a condition that passes by itself: call again after this time.
inline core::Error temporary(const core::Error& error, std::chrono::steady_clock::duration retry_delay) {
  const auto delay_ms = std::chrono::ceil<std::chrono::milliseconds>(retry_delay).count();
  core::ErrorDetails details = core::details_of(error);
  details.reason = proto::kTryLater;
  details.retry_delay_ms = static_cast<std::uint32_t>(delay_ms);
  return error.with(std::move(details));
}

// The same for a quota that callers share (FairShare), of which the caller has `own`: "too many SCENES WAIT,
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
