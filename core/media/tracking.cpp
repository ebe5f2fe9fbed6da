// SPDX-License-Identifier: Apache-2.0
#include "core/media/tracking.hpp"

#include <algorithm>

#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

// Shadow rays with less transmittance end with this probability.
constexpr float kFaint = 0.05f, kEndOfFaint = 0.75f;

// The maximum number of tentative collisions along a ray: what needs more, as a grid with enormous
// differences within a few voxels, is black.
constexpr int kMaxTentativeCollisions = 1 << 16;

// c where it is above 0, and 0 elsewhere: the null collisions, in spite of rounding.
Rgb positive(Rgb c) {
  return {std::max(0.0f, c.r), std::max(0.0f, c.g), std::max(0.0f, c.b)};
}

double length_to(const Ray& ray, float t_max) {
  const double scale = static_cast<double>(length(ray.direction));
  return std::min(static_cast<double>(t_max) * scale, static_cast<double>(kMediumReach));
}

// The distance with density `sigma * exp(-sigma * distance)`.
double free_path(float sigma, float u) {
  return -log(1 - static_cast<double>(u)) / static_cast<double>(sigma);
}

float quotient(float a, float b) {
  return b > 0 ? a / b : 0;
}

// What a homogeneous medium emits along a length with this transmittance towards its start.
Rgb emitted_along(const MediumPoint& medium, Rgb transmitted) {
  const Rgb sigma_t = medium.sigma_t();
  const Rgb share{quotient(medium.sigma_a.r, sigma_t.r), quotient(medium.sigma_a.g, sigma_t.g),
                  quotient(medium.sigma_a.b, sigma_t.b)};
  return medium.emission * share * (Rgb::gray(1) - transmitted);
}

Collision sample_homogeneous(const Medium& medium, const Ray& ray, float t_max, int hero,
                             sampling::NumberStream& numbers, SpectralWeights& weights) {
  const MediumPoint& everywhere = medium.everywhere();
  const Rgb sigma_t = everywhere.sigma_t();
  const double whole = length_to(ray, t_max);
  const Rgb transmitted = beam_transmittance(sigma_t, whole);
  Collision collision;
  if (!is_black(everywhere.emission))
    collision.emitted =
        weights.throughput * emitted_along(everywhere, transmitted) / mean(weights.unidirectional);
  if (!medium.scatters()) {
    weights.throughput *= transmitted;
    return collision;
  }
  const float density = sigma_t[hero];
  const double distance = density > 0 ? free_path(density, numbers.next()) : whole;
  if (distance < whole) {
    const Rgb passed = beam_transmittance(sigma_t, distance);
    const float pdf = passed[hero] * density;
    weights.throughput *= passed * everywhere.sigma_s / pdf;
    weights.unidirectional *= passed * sigma_t / pdf;
    collision.t = static_cast<float>(distance / static_cast<double>(length(ray.direction)));
    return collision;
  }
  const float pdf = transmitted[hero];
  weights.throughput *= transmitted / pdf;
  weights.unidirectional *= transmitted / pdf;
  weights.light *= 1 / pdf;
  return collision;
}

// The way through a medium of grids, from one tentative collision to the next.
class Tracker {
 public:
  Tracker(const Medium& medium, const Ray& ray, float t_max, int hero, sampling::NumberStream& numbers)
      : way_(medium, ray, t_max), hero_(hero), numbers_(numbers) {
    enter_next_segment();
  }

  // Goes to the next tentative collision; false at the end of the way. `passed` becomes the transmittance of
  // the majorant on the way there, over the hero's.
  bool next(Rgb& passed) {
    passed = Rgb::gray(1);
    if (collisions_++ == kMaxTentativeCollisions) {
      passed = {};
      return false;
    }
    while (segment_) {
      const double rest = static_cast<double>(segment_->t1) - static_cast<double>(t_);
      const float density = majorant()[hero_] * way_.length_per_t();
      const double step = density > 0 ? free_path(density, numbers_.next()) : rest;
      if (step < rest) {
        passed *= relative_transmittance(step);
        t_ += static_cast<float>(step);
        return true;
      }
      passed *= relative_transmittance(rest);
      enter_next_segment();
    }
    return false;
  }

  // At the tentative collision:
  Rgb majorant() const { return segment_->majorant; }
  float t() const { return t_; }
  MediumPoint point() const { return way_.at(t_); }

 private:
  void enter_next_segment() {
    segment_ = way_.next();
    if (segment_) t_ = segment_->t0;
  }
  Rgb relative_transmittance(double t) const {
    const Rgb passed = beam_transmittance(majorant(), t * static_cast<double>(way_.length_per_t()));
    return passed / passed[hero_];
  }

  MediumRay way_;
  const int hero_;
  sampling::NumberStream& numbers_;
  std::optional<MajorantSegment> segment_;
  float t_ = 0;
  int collisions_ = 0;
};

// The weights of a null collision that decides nothing: where the medium does not scatter, or of shadow rays.
void attenuate(SpectralWeights& weights, Rgb null, Rgb majorant, float density) {
  weights.throughput *= null / density;
  weights.light *= majorant / density;
}

}  // namespace

Collision sample_collision(const Medium& medium, const Ray& ray, float t_max, int hero,
                           sampling::NumberStream& numbers, SpectralWeights& weights) {
  if (medium.is_homogeneous()) return sample_homogeneous(medium, ray, t_max, hero, numbers, weights);
  Collision collision;
  Tracker tracker(medium, ray, t_max, hero, numbers);
  Rgb passed;
  while (tracker.next(passed)) {
    weights *= passed;
    const Rgb majorant = tracker.majorant();
    const float density = majorant[hero];
    const MediumPoint point = tracker.point();
    const Rgb sigma_t = point.sigma_t(), null = positive(majorant - sigma_t);
    if (const Rgb source = point.sigma_a * point.emission; !is_black(source))
      collision.emitted += weights.throughput * source / mean(weights.unidirectional * majorant);
    if (!medium.scatters()) {
      attenuate(weights, null, majorant, density);
      weights.unidirectional *= majorant / density;
      continue;
    }
    if (numbers.next() * density < sigma_t[hero]) {
      weights.throughput *= point.sigma_s / sigma_t[hero];
      weights.unidirectional *= sigma_t / sigma_t[hero];
      collision.t = tracker.t();
      return collision;
    }
    attenuate(weights, null, majorant, null[hero]);
    weights.unidirectional *= null / null[hero];
  }
  weights *= passed;
  return collision;
}

void estimate_transmittance(const Medium& medium, const Ray& ray, float t_max, int hero,
                            sampling::NumberStream& numbers, SpectralWeights& weights) {
  if (medium.is_homogeneous()) {
    const Rgb transmitted = beam_transmittance(medium.everywhere().sigma_t(), length_to(ray, t_max));
    weights.throughput *= transmitted;
    if (medium.scatters()) weights.unidirectional *= transmitted;
    return;
  }
  Tracker tracker(medium, ray, t_max, hero, numbers);
  Rgb passed;
  while (tracker.next(passed)) {
    weights *= passed;
    const Rgb majorant = tracker.majorant();
    const float density = majorant[hero];
    const Rgb null = positive(majorant - tracker.point().sigma_t());
    attenuate(weights, null, majorant, density);
    weights.unidirectional *= (medium.scatters() ? null : majorant) / density;
    if (max_component(weights.throughput) >= kFaint * mean(weights.light)) continue;
    if (numbers.next() < kEndOfFaint) weights.throughput = {};
    if (is_black(weights.throughput)) return;
    weights.throughput *= 1 / (1 - kEndOfFaint);
  }
  weights *= passed;
}

}  // namespace tessera::core
