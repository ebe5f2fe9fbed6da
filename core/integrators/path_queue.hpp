// The paths of a batch that go on, each at its next ray: what has to be known of a path's past to follow it.
// Structure of arrays, so that eight paths can be taken up at once. Lives as long as its thread renders.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "core/geometry/ray.hpp"
#include "core/lights/light_tree.hpp"
#include "core/math/rgb.hpp"

namespace tessera::core {

// Paths that are traced together: enough for full vectors where few paths are left, few enough for the
// caches.
inline constexpr std::size_t kBatchPaths = 512;

// Stands for the density of a direction that nothing but one way of sampling finds.
inline constexpr float kDeltaPdf = std::numeric_limits<float>::infinity();

// What the past of a path adds up to, before its next ray.
struct PathHead {
  std::uint32_t path = 0;         // its number in the batch
  Rgb throughput = Rgb::gray(1);  // the product of the BSDF weights: what radiance found is multiplied by
  float eta_scale = 1;            // undoes the compression of radiance by refraction in `throughput`
  float last_pdf = kDeltaPdf;     // of the ray's direction, per solid angle, shared out among the samples of
                                  // lights beside it; kDeltaPdf also at the camera, whose ray finds lights
                                  // that nothing else could
  LitPoint last{};                // where the ray was scattered
  float met_scale = 1;            // of light that the ray itself meets, which is left to the BSDF's samples
  float promise = 1;              // how much more light than without a guide is expected, by the throughput
};

class PathQueue {
 public:
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  void clear() { size_ = 0; }

  void push(const Ray& ray, const PathHead& head) {
    assert(size_ < kBatchPaths);
    rays_[size_] = ray;
    heads_[size_] = head;
    ++size_;
  }

  std::span<const Ray> rays() const { return {rays_.data(), size_}; }
  const PathHead& head(std::size_t slot) const { return heads_[slot]; }

 private:
  std::size_t size_ = 0;
  std::array<Ray, kBatchPaths> rays_;
  std::array<PathHead, kBatchPaths> heads_;
};

}  // namespace tessera::core
