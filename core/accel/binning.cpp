#include "core/accel/binning.hpp"

#include <algorithm>
#include <cmath>

#include "core/accel/binary_bvh.hpp"

namespace tessera::core {
namespace {

// The half area of a box in units of a given length, in which it neither overflows nor vanishes.
class RelativeArea {
 public:
  // The longest side of `bounds` becomes a quarter.
  explicit RelativeArea(const BuildBox& bounds) {
    const Aabb box = bounds.box();
    const double longest = std::max({box.extent(0), box.extent(1), box.extent(2)});
    const double scale = std::min(0.25 / longest, double{std::numeric_limits<float>::max()});
    scale_ = Float8::broadcast(static_cast<float>(scale));
  }

  float operator()(const BuildBox& box) const {
    const Float8 scaled = box.v * scale_;
    return sum_of_products_in_pairs(lower_half(scaled) + upper_half(scaled));
  }

 private:
  Float8 scale_;
};

// The chance that a ray meets a leaf times the packets that it would take. NaN if it is empty, which is
// cheaper than nothing.
float cost(float area, std::uint32_t count) {
  return area * static_cast<float>((count + kMaxLeafSize - 1) / kMaxLeafSize);
}

float bins_per_length(double extent) {
  constexpr double kBelowTheLast = 1 - 1e-6;
  const double bins = kBins * kBelowTheLast / extent;
  return bins < std::numeric_limits<float>::max() ? static_cast<float>(bins) : 0;
}

}  // namespace

Binning::Binning(const BuildBox& centroids) {
  const Aabb box = centroids.box();
  origin_ = Float4::of(box.lower.x, box.lower.y, box.lower.z, 0);
  bins_per_length_ = Float4::of(bins_per_length(box.extent(0)), bins_per_length(box.extent(1)),
                                bins_per_length(box.extent(2)), 0);
}

void Bins::add(const Binning& binning, std::span<const BuildItem> items) {
  for (const BuildItem& item : items) {
    const BuildBox box = item.box();
    alignas(16) int bins[4];
    binning.bins(box).store(bins);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto bin = static_cast<std::size_t>(bins[axis]);
      boxes_[axis][bin].include(box);
      ++counts_[axis][bin];
    }
  }
}

void Bins::add(const Bins& other) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      boxes_[axis][bin].include(other.boxes_[axis][bin]);
      counts_[axis][bin] += other.counts_[axis][bin];
    }
}

Split Bins::best_split(const BuildBox& bounds) const {
  const RelativeArea area(bounds);
  Split best;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto& boxes = boxes_[axis];
    const auto& counts = counts_[axis];
    std::array<float, kBins> right_cost{};
    BuildBox right;
    std::uint32_t right_count = 0;
    for (std::size_t bin = kBins - 1; bin > 0; --bin) {
      right.include(boxes[bin]);
      right_count += counts[bin];
      right_cost[bin] = cost(area(right), right_count);
    }
    BuildBox left;
    std::uint32_t left_count = 0;
    for (std::size_t bin = 1; bin < kBins; ++bin) {
      left.include(boxes[bin - 1]);
      left_count += counts[bin - 1];
      const float total = cost(area(left), left_count) + right_cost[bin];
      if (total < best.cost) best = {total, static_cast<int>(axis), static_cast<int>(bin)};
    }
  }
  return best;
}

}  // namespace tessera::core
