// SPDX-License-Identifier: Apache-2.0
// Paths that wait for the same step: each at its next ray, with what has to be known of its past to follow
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

// Paths that take a step together: enough for full groups of rays, few enough for the caches.
inline constexpr std::size_t kBatchPaths = 512;

// Stands for the density of a direction that nothing but one way of sampling finds.
inline constexpr float kDeltaPdf = std::numeric_limits<float>::infinity();

// What the past of a path adds up to, before its next ray.
struct PathHead {
  std::uint32_t path = 0;         // its number, as PathTracer::begin was told
  Rgb throughput = Rgb::gray(1);  // the product of the BSDF weights: what radiance found is multiplied by
  float eta_scale = 1;            // undoes the compression of radiance by refraction in `throughput`
  float last_pdf = kDeltaPdf;     // of the ray's direction, per solid angle; kDeltaPdf also at the camera,
                                  // whose ray finds lights that nothing else could
  LightSampleContext last{};      // where the ray was scattered
  float emitter_mis_scale = 1;    // of light that the ray itself meets, which is left to the BSDF's samples
  float guiding_pdf_ratio = 1;    // how much more light than without a guide is expected, by the throughput
};

class PathQueue {
 public:
  // Valid until something is pushed or dropped.
  struct Batch {
    std::span<Ray> rays;
    std::span<const PathHead> heads;  // of the rays
  };

  std::size_t size() const { return size_; }

  // For `count` more, before they are pushed.
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

  // The last that came, kBatchPaths if there are as many.
  Batch last() {
    const std::size_t count = std::min(size_, kBatchPaths);
    return {std::span(rays_).subspan(size_ - count, count),
            std::span<const PathHead>(heads_).subspan(size_ - count, count)};
  }
  void drop_last(std::size_t count) { size_ -= count; }

 private:
  std::size_t size_ = 0;
  std::vector<Ray> rays_;
  std::vector<PathHead> heads_;
};

}  // namespace tessera::core
