// SPDX-License-Identifier: Apache-2.0
// Queues of paths that wait for the same step: each with its next ray and the path state needed to continue
// it.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/geometry/ray.hpp"
#include "core/lights/light_tree.hpp"
#include "core/math/rgb.hpp"

namespace tessera::core {

// The number of paths that advance together: enough for full ray groups, few enough for the caches.
inline constexpr std::size_t kBatchPaths = 512;

// The density of a direction that only one technique can sample.
inline constexpr float kDeltaPdf = std::numeric_limits<float>::infinity();

// The state of a path before its next ray.
struct PathHead {
  std::uint32_t path = 0;         // the index passed to PathTracer::begin
  Rgb throughput = Rgb::gray(1);  // product of the BSDF weights, which multiplies radiance found
  float eta_scale = 1;            // undoes the compression of radiance by refraction in `throughput`
  float last_pdf = kDeltaPdf;     // of the ray's direction, per solid angle; kDeltaPdf also at the camera
  LightSampleContext last{};      // where the ray was scattered; of a camera ray, where it is in focus
  float emitter_mis_scale = 1;    // scales emission that the ray hits; 0 for guided rays
  float guiding_pdf_ratio = 1;    // product of mixture density / BSDF density, for roulette
};

class PathQueue {
 public:
  // Valid until paths are pushed or dropped.
  struct Batch {
    std::span<Ray> rays;
    std::span<PathHead> heads;  // of the rays
  };

  std::size_t size() const { return size_; }

  // Makes room for `count` more paths; call it before pushing.
  void make_room(std::size_t count) {
    if (size_ + count <= rays_.size()) return;
    rays_.resize(size_ + count);
    heads_.resize(rays_.size());
  }
  void push(const Ray& ray, const PathHead& head) {
    assert(size_ < rays_.size());
    rays_[size_] = ray;
    heads_[size_] = head;
    ++size_;
  }

  // The most recent paths, at most kBatchPaths.
  Batch last() {
    const std::size_t count = std::min(size_, kBatchPaths);
    return {std::span(rays_).subspan(size_ - count, count), std::span(heads_).subspan(size_ - count, count)};
  }
  void drop_last(std::size_t count) { size_ -= count; }

 private:
  std::size_t size_ = 0;
  std::vector<Ray> rays_;
  std::vector<PathHead> heads_;
};

}  // namespace tessera::core
