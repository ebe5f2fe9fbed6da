// SPDX-License-Identifier: Apache-2.0
// Compares rays per second of the acceleration structure and of Embree, on one thread and the same rays,
// interleaved, so that disturbances affect both. Prints medians of CPU time over the rounds.
//
//   embree_bench [rounds [rays per side of the image [first letters of a set's name]]]
#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/soups.hpp"

namespace tessera::core {
namespace {

using Device = std::unique_ptr<RTCDeviceTy, decltype(&rtcReleaseDevice)>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, decltype(&rtcReleaseScene)>;

EmbreeScene build_embree(RTCDevice device, const Soup& soup, RTCBuildQuality quality) {
  EmbreeScene scene(rtcNewScene(device), rtcReleaseScene);
  rtcSetSceneBuildQuality(scene.get(), quality);
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
  rtcAttachGeometry(scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene.get());
  return scene;
}

RTCRay embree_ray(const Ray& ray) {
  return {ray.origin.x,
          ray.origin.y,
          ray.origin.z,
          0,
          ray.direction.x,
          ray.direction.y,
          ray.direction.z,
          0,
          ray.t_max,
          ~0u,
          0,
          0};
}

RTCIntersectContext context_for(RTCIntersectContextFlags flags) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = flags;
  return context;
}

// Each query returns its number of hits, to check that all trace the same geometry.

std::size_t ours_closest(const Primitives& primitives, const accel::Bvh& bvh, const std::vector<Ray>& rays) {
  std::size_t hits = 0;
  for (const Ray& ray : rays) hits += bvh.closest_hit(primitives, ray).found();
  return hits;
}

std::size_t ours_any(const Primitives& primitives, const accel::Bvh& bvh, const std::vector<Ray>& rays) {
  std::size_t hits = 0;
  for (const Ray& ray : rays) hits += bvh.any_hit(primitives, ray);
  return hits;
}

// The batch size of a renderer with this many active paths.
constexpr std::size_t kBatch = 1024;

// As path tracers have them: columns of one batch. Queries take a copy, as Embree's do, which write into
// their rays; so all read rays that are in a cache.
using Batches = std::vector<Columns<Ray>>;

Batches batches_of(std::span<const Ray> rays) {
  Batches batches;
  for (std::size_t i = 0; i < rays.size(); i += kBatch)
    batches.emplace_back(rays.subspan(i, std::min(kBatch, rays.size() - i)));
  return batches;
}

std::size_t ours_closest_batched(const Primitives& primitives, const accel::Bvh& bvh,
                                 const Batches& batches) {
  Columns<Hit> answers(kBatch);
  const ColumnsView<const std::uint32_t> met = std::as_const(answers).all().field(&Hit::primitive);
  Columns<Ray> rays;
  std::size_t hits = 0;
  for (const Columns<Ray>& batch : batches) {
    rays = batch;
    bvh.closest_hits(primitives, std::as_const(rays).all(), answers.all().rows(0, rays.size()));
    for (std::size_t k = 0; k < rays.size(); ++k) hits += met[k] != kNoPrimitive;
  }
  return hits;
}

std::size_t ours_any_batched(const Primitives& primitives, const accel::Bvh& bvh, const Batches& batches) {
  std::array<accel::Occlusion, kBatch> answers;
  Columns<Ray> rays;
  std::size_t hits = 0;
  for (const Columns<Ray>& batch : batches) {
    rays = batch;
    bvh.occlusions(primitives, std::as_const(rays).all(), {answers.data(), rays.size()});
    for (std::size_t k = 0; k < rays.size(); ++k) hits += answers[k] != accel::Occlusion::kNone;
  }
  return hits;
}

std::size_t embree_closest(RTCScene scene, const std::vector<Ray>& rays) {
  RTCIntersectContext context = context_for(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  std::size_t hits = 0;
  for (const Ray& ray : rays) {
    RTCRayHit query;
    query.ray = embree_ray(ray);
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &query);
    hits += query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }
  return hits;
}

std::size_t embree_any(RTCScene scene, const std::vector<Ray>& rays) {
  RTCIntersectContext context = context_for(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  std::size_t hits = 0;
  for (const Ray& ray : rays) {
    RTCRay query = embree_ray(ray);
    rtcOccluded1(scene, &context, &query);
    hits += query.tfar < 0;
  }
  return hits;
}

constexpr std::size_t kPacket = 16;

// Up to sixteen rays from `first` on; unused lanes have a negative length.
RTCRay16 embree_packet(const std::vector<Ray>& rays, std::size_t first) {
  RTCRay16 packet = {};
  for (std::size_t i = 0; i < kPacket; ++i) {
    const bool valid = first + i < rays.size();
    const RTCRay ray = embree_ray(rays[valid ? first + i : first]);
    packet.org_x[i] = ray.org_x, packet.org_y[i] = ray.org_y, packet.org_z[i] = ray.org_z;
    packet.dir_x[i] = ray.dir_x, packet.dir_y[i] = ray.dir_y, packet.dir_z[i] = ray.dir_z;
    packet.tfar[i] = valid ? ray.tfar : -1;
    packet.mask[i] = ~0u;
  }
  return packet;
}

std::vector<RTCRay16> embree_packets(const std::vector<Ray>& rays) {
  std::vector<RTCRay16> packets;
  for (std::size_t i = 0; i < rays.size(); i += kPacket) packets.push_back(embree_packet(rays, i));
  return packets;
}

alignas(64) constexpr int kAllValid[kPacket] = {-1, -1, -1, -1, -1, -1, -1, -1,
                                                -1, -1, -1, -1, -1, -1, -1, -1};

std::size_t embree_closest(RTCScene scene, const std::vector<RTCRay16>& packets,
                           RTCIntersectContextFlags coherence) {
  RTCIntersectContext context = context_for(coherence);
  std::size_t hits = 0;
  for (const RTCRay16& packet : packets) {
    RTCRayHit16 query;
    query.ray = packet;
    for (std::size_t i = 0; i < kPacket; ++i)
      query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect16(kAllValid, scene, &context, &query);
    for (const unsigned id : query.hit.geomID) hits += id != RTC_INVALID_GEOMETRY_ID;
  }
  return hits;
}

std::size_t embree_any(RTCScene scene, const std::vector<RTCRay16>& packets,
                       RTCIntersectContextFlags coherence) {
  RTCIntersectContext context = context_for(coherence);
  std::size_t hits = 0;
  for (const RTCRay16& packet : packets) {
    RTCRay16 query = packet;
    rtcOccluded16(kAllValid, scene, &context, &query);
    for (std::size_t i = 0; i < kPacket; ++i) hits += packet.tfar[i] > 0 && query.tfar[i] < 0;
  }
  return hits;
}

double cpu_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Contender {
  std::function<std::size_t()> trace;
  std::vector<double> seconds = {};
  std::size_t hits = 0;

  void run() {
    const double begin = cpu_seconds();
    hits = trace();
    seconds.push_back(cpu_seconds() - begin);
  }
  double median() {
    const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
    std::nth_element(seconds.begin(), middle, seconds.end());
    return *middle;
  }
};

// The ratios of our rates to Embree's, over all sets.
struct Ratios {
  std::vector<double> single_to_single, batch_to_single, batch_to_best;
};

enum Column {
  kOurSingle,
  kOurBatch,
  kTheirSingle,
  kTheirPackets = kTheirSingle + 2,
  kColumns = kTheirPackets + 4
};

double best_of(const std::vector<double>& rates, int begin, int end) {
  return *std::max_element(rates.begin() + begin, rates.begin() + end);
}

void print_row(const char* soup, const char* kind, std::size_t rays, std::vector<Contender> contenders,
               int rounds, Ratios& ratios) {
  for (int round = 0; round < rounds; ++round)
    for (Contender& contender : contenders) contender.run();
  std::vector<double> rates;
  for (Contender& contender : contenders)
    rates.push_back(1e-6 * static_cast<double>(rays) / contender.median());
  const double best_single = best_of(rates, kTheirSingle, kTheirPackets);
  ratios.single_to_single.push_back(rates[kOurSingle] / best_single);
  ratios.batch_to_single.push_back(rates[kOurBatch] / best_single);
  ratios.batch_to_best.push_back(rates[kOurBatch] / best_of(rates, kTheirSingle, kColumns));
  std::printf("| %-12s | %-7s |", soup, kind);
  for (const double rate : rates) std::printf(" %6.2f |", rate);
  std::printf("  %5.2f |  %5.2f |  %5.2f | %7.3f%% |\n", ratios.single_to_single.back(),
              ratios.batch_to_single.back(), ratios.batch_to_best.back(),
              100 *
                  (static_cast<double>(contenders[kOurBatch].hits) -
                   static_cast<double>(contenders[kTheirSingle].hits)) /
                  static_cast<double>(rays));
  std::fflush(stdout);
}

constexpr auto kCoherent = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
constexpr auto kIncoherent = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;

struct Trees {
  Trees(RTCDevice device, const Soup& soup)
      : primitives(soup.primitives()),
        bvh(accel::Bvh::build(primitives, 1)),
        high(build_embree(device, soup, RTC_BUILD_QUALITY_HIGH)),
        medium(build_embree(device, soup, RTC_BUILD_QUALITY_MEDIUM)) {}

  Primitives primitives;
  accel::Bvh bvh;
  EmbreeScene high, medium;
};

// The same rays in the form that each query takes.
struct RayForms {
  explicit RayForms(const std::vector<Ray>& set)
      : rays(set), batches(batches_of(set)), packets(embree_packets(set)) {}

  const std::vector<Ray>& rays;
  Batches batches;
  std::vector<RTCRay16> packets;
};

// In the order of the table's columns.
std::vector<Contender> closest_contenders(const Trees& trees, const RayForms& set) {
  const auto& [rays, batches, packets] = set;
  return {{[&] { return ours_closest(trees.primitives, trees.bvh, rays); }},
          {[&] { return ours_closest_batched(trees.primitives, trees.bvh, batches); }},
          {[&] { return embree_closest(trees.high.get(), rays); }},
          {[&] { return embree_closest(trees.medium.get(), rays); }},
          {[&] { return embree_closest(trees.high.get(), packets, kIncoherent); }},
          {[&] { return embree_closest(trees.medium.get(), packets, kIncoherent); }},
          {[&] { return embree_closest(trees.high.get(), packets, kCoherent); }},
          {[&] { return embree_closest(trees.medium.get(), packets, kCoherent); }}};
}

std::vector<Contender> any_contenders(const Trees& trees, const RayForms& set) {
  const auto& [rays, batches, packets] = set;
  return {{[&] { return ours_any(trees.primitives, trees.bvh, rays); }},
          {[&] { return ours_any_batched(trees.primitives, trees.bvh, batches); }},
          {[&] { return embree_any(trees.high.get(), rays); }},
          {[&] { return embree_any(trees.medium.get(), rays); }},
          {[&] { return embree_any(trees.high.get(), packets, kIncoherent); }},
          {[&] { return embree_any(trees.medium.get(), packets, kIncoherent); }},
          {[&] { return embree_any(trees.high.get(), packets, kCoherent); }},
          {[&] { return embree_any(trees.medium.get(), packets, kCoherent); }}};
}

void compare(RTCDevice device, const char* name, const Soup& soup, int rounds, int side, Ratios& ratios) {
  const Trees trees(device, soup);
  const RaySets rays = make_rays(soup, trees.primitives, trees.bvh, side);
  const auto closest = [&](const char* kind, const std::vector<Ray>& set) {
    const RayForms forms(set);
    print_row(name, kind, set.size(), closest_contenders(trees, forms), rounds, ratios);
  };
  closest("primary", rays.primary);
  closest("bounce", rays.bounce);
  const RayForms shadow(rays.shadow);
  print_row(name, "shadow", rays.shadow.size(), any_contenders(trees, shadow), rounds, ratios);
}

double geometric_mean(const std::vector<double>& values) {
  double log_sum = 0;
  for (const double value : values) log_sum += std::log(value);
  return std::exp(log_sum / static_cast<double>(values.size()));
}

constexpr const char* kHeading =
    "|              |         |      ours       |  Embree, 1 ray  | Embree, packets | told coherent   |     "
    "ours over Embree's       | hits of   |\n"
    "| set          | rays    | single |  batch |   high | medium |   high | medium |   high | medium | 1 : "
    "1 "
    " | b. : 1 | b. : best | ours - E. |\n";

void run(int rounds, int side, std::string_view only) {
  const Device device(rtcNewDevice("threads=1"), rtcReleaseDevice);
  std::printf("Million rays per second, one thread, medians of %d rounds.\n\n%s", rounds, kHeading);
  Ratios ratios;
  const auto compare_if_asked = [&](const char* name, const std::function<Soup()>& soup) {
    if (std::string_view(name).starts_with(only)) compare(device.get(), name, soup(), rounds, side, ratios);
  };
  compare_if_asked("blob, 69k", [] { return blob_on_plane(132); });
  compare_if_asked("go, 133k", [] { return go_board(); });
  compare_if_asked("blobs, 1.7M", [] { return blob_field(5, 132); });
  compare_if_asked("strands, 300k", [] { return strands_on_plane(); });
  std::printf(
      "\nGeometric means: single over Embree's single rays %.3f, batch over these %.3f, batch over the "
      "best of Embree %.3f\n",
      geometric_mean(ratios.single_to_single), geometric_mean(ratios.batch_to_single),
      geometric_mean(ratios.batch_to_best));
}

}  // namespace
}  // namespace tessera::core

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 7, side = argc > 2 ? std::atoi(argv[2]) : 1024;
  tessera::core::run(std::max(rounds, 1), std::max(side & ~7, 8), argc > 3 ? argv[3] : "");
}
