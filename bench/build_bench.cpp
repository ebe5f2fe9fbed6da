// SPDX-License-Identifier: Apache-2.0
// Compares building the acceleration structure with Embree, interleaved on the same triangles: time,
// retained memory and peak memory. Of two consecutive builds the second is measured, so that each reuses
// memory that it has freed itself: a virtual machine may have returned other memory to its host. Prints
// medians of the rounds; on a busy machine compare CPU times. Linux only: peaks are the kernel's for this
// process.
//
//   embree_build_bench [rounds [threads, 0 for 1 and 2 [first letters of a set's name]]]
#include <embree3/rtcore.h>
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bench/soups.hpp"

namespace tessera::core {
namespace {

struct Measured {
  double wall_seconds, cpu_seconds;
  double kept_bytes, peak_bytes;  // relative to the memory used before
};

double cpu_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// "VmRSS" or "VmHWM" of this process.
double memory_bytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(key)) return 1024 * std::stod(line.substr(key.size() + 1));
  return 0;
}

// `build` returns the size of its result in bytes.
Measured measure(const std::function<double()>& build) {
  malloc_trim(0);
  const double before = memory_bytes("VmRSS");
  std::ofstream("/proc/self/clear_refs") << 5;  // resets the peak
  const auto wall = std::chrono::steady_clock::now();
  const double cpu = cpu_seconds();
  Measured result{};
  result.kept_bytes = build();
  result.cpu_seconds = cpu_seconds() - cpu;
  result.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
  result.peak_bytes = memory_bytes("VmHWM") - before;
  return result;
}

Measured build_ours(const Soup& soup, int threads) {
  const Primitives primitives = soup.primitives();
  accel::Bvh bvh;
  Measured result = measure([&] {
    bvh = accel::Bvh::build(primitives, threads);
    return static_cast<double>(bvh.memory_bytes());
  });
  return result;
}

// The memory that Embree reports as allocated.
std::atomic<long long> embree_bytes{0};

bool count_embree_bytes(void*, ssize_t bytes, bool) {
  embree_bytes += bytes;
  return true;
}

// The vertices and indices are in Embree's memory beforehand and not counted.
Measured build_embree(const Soup& soup, int threads, RTCBuildQuality quality) {
  const RTCDevice device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
  rtcSetDeviceMemoryMonitorFunction(device, count_embree_bytes, nullptr);
  const RTCScene scene = rtcNewScene(device);
  rtcSetSceneBuildQuality(scene, quality);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, quality);
  void* positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                            sizeof(Vec3), soup.positions.size());
  std::copy(soup.positions.begin(), soup.positions.end(), static_cast<Vec3*>(positions));
  using Triangle = std::array<std::uint32_t, 3>;
  void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof(Triangle), soup.triangles.size());
  std::copy(soup.triangles.begin(), soup.triangles.end(), static_cast<Triangle*>(triangles));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  const long long buffers = embree_bytes;
  const Measured result = measure([&] {
    rtcCommitScene(scene);
    return static_cast<double>(embree_bytes - buffers);
  });
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  return result;
}

Measured median(const std::vector<Measured>& all) {
  const auto of = [&](double Measured::*field) {
    std::vector<double> values;
    for (const Measured& m : all) values.push_back(m.*field);
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
  };
  return {of(&Measured::wall_seconds), of(&Measured::cpu_seconds), of(&Measured::kept_bytes),
          of(&Measured::peak_bytes)};
}

void compare(const char* name, const Soup& soup, int threads, int rounds) {
  struct Contender {
    const char* name;
    std::function<Measured()> build;
    std::vector<Measured> results = {};
  };
  std::vector<Contender> contenders{
      {"ours", [&] { return build_ours(soup, threads); }},
      {"Embree, low", [&] { return build_embree(soup, threads, RTC_BUILD_QUALITY_LOW); }},
      {"Embree, medium", [&] { return build_embree(soup, threads, RTC_BUILD_QUALITY_MEDIUM); }},
      {"Embree, high", [&] { return build_embree(soup, threads, RTC_BUILD_QUALITY_HIGH); }},
  };
  for (int round = 0; round < rounds; ++round)
    for (Contender& contender : contenders) {
      contender.build();
      contender.results.push_back(contender.build());
    }
  const auto triangles = static_cast<double>(soup.triangles.size());
  const Measured ours = median(contenders.front().results);
  for (const Contender& contender : contenders) {
    const Measured m = median(contender.results);
    std::printf("| %-12s | %7d | %-14s | %6.2f | %6.2f | %11.2f | %5.2f | %5.0f | %5.0f |\n", name, threads,
                contender.name, m.wall_seconds, m.cpu_seconds, ours.wall_seconds / m.wall_seconds,
                ours.cpu_seconds / m.cpu_seconds, m.kept_bytes / triangles, m.peak_bytes / triangles);
  }
  std::fflush(stdout);
}

void run(int rounds, int threads, std::string_view only) {
  std::printf("Medians of %d rounds; bytes per triangle, without vertices and indices.\n\n", rounds);
  std::printf(
      "| set          | threads | build          | wall s |  CPU s | ratio: wall |   CPU |  kept |  peak "
      "|\n");
  std::printf(
      "|--------------|---------|----------------|--------|--------|-------------|-------|-------|-------|"
      "\n");
  const auto compare_if_asked = [&](const char* name, const std::function<Soup()>& make) {
    if (!std::string_view(name).starts_with(only)) return;
    const Soup soup = make();
    for (const int n : {1, 2})
      if (threads == 0 || threads == n) compare(name, soup, n, rounds);
    if (threads > 2) compare(name, soup, threads, rounds);
  };
  compare_if_asked("go, 133k", [] { return go_board(); });
  compare_if_asked("blobs, 1.7M", [] { return blob_field(5, 132); });
  compare_if_asked("many, 10M", [] { return blob_field(12, 132); });
}

}  // namespace
}  // namespace tessera::core

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 3, threads = argc > 2 ? std::atoi(argv[2]) : 0;
  tessera::core::run(std::max(rounds, 1), std::max(threads, 0), argc > 3 ? argv[3] : "");
}
