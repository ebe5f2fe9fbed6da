// SPDX-License-Identifier: Apache-2.0
#include "core/guiding/light_guide.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>
#include <utility>

#include "core/base/parallel_errors.hpp"
#include "core/math/simd_double.hpp"

namespace tessera::core::guiding {
namespace {

// Cells with more photons are divided; cells with fewer are not reliable.
constexpr std::size_t kMaxCellPhotons = 256, kMinCellPhotons = 8;
constexpr float kMinShare = 0.05f, kMaxShare = 0.7f;
// The number of places in a cell for which its light is estimated.
constexpr std::size_t kPlaces = 16;
// The fraction of a caustic's light that comes from directions that the guide cannot distinguish from their
// neighbours. Elsewhere the power alone predicts sample values.
constexpr float kConcentration = 0.3f;
// Clamps a sample's value, in units of the cell's irradiance, so that sums stay finite.
constexpr float kLargestValue = 1e12f;
// The radius of a parallax sphere, over the diagonal of its cell, is at most this.
constexpr float kFarthest = 1000;
// The maximum number of splits above a cell, so that the indices of nodes have room for all.
constexpr int kMaxSplits = 15;

// 0 to 5: the axis along which `normal` is longest, and its sign.
template <typename T>
WordOf<T> facing(Vec3Of<T> normal) {
  using Word = WordOf<T>;
  const Vec3Of<T> a = abs(normal);
  const MaskOf<T> is_x = (a.x >= a.y) & (a.x >= a.z), is_y = a.y >= a.z;
  const T along = select(is_x, normal.x, select(is_y, normal.y, normal.z));
  return select(is_x, Word(0), select(is_y, Word(2), Word(4))) + select(along < 0, Word(1), Word(0));
}

Aabb bounds_of(std::span<const Photon> photons) {
  Aabb box;
  for (const Photon& photon : photons) box.include(photon.position);
  return box;
}

int longest_axis(const Aabb& box) {
  const double x = box.extent(0), y = box.extent(1), z = box.extent(2);
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

// The product of the box's two largest extents: about the area of a nearly flat surface inside.
float area_of(const Aabb& box) {
  std::array<double, 3> extents{box.extent(0), box.extent(1), box.extent(2)};
  std::sort(extents.begin(), extents.end());
  return static_cast<float>(extents[1] * extents[2]);
}

// Slightly enlarged, to include positions just beside the photons.
Aabb widened(const Aabb& box) {
  const float margin = static_cast<float>(box.extent(longest_axis(box))) * 0.1f;
  const Vec3 all{margin, margin, margin};
  return {box.lower - all, box.upper + all};
}

// Of an opening through which light comes from infinity: how much its direction turns back along a way
// between places. A linear regression; 0 if it does not.
float inverse_distance_of_opening(std::span<const Photon> photons) {
  const Vec3 start = photons.front().position;
  Vec3 position, wi;
  for (const Photon& photon : photons) {
    position += photon.position - start;
    wi += photon.wi;
  }
  const float per_photon = 1 / static_cast<float>(photons.size());
  position = start + position * per_photon;
  wi = wi * per_photon;
  if (!(length_squared(wi) > 0)) return 0;
  const Vec3 axis = normalize(wi);
  float turned = 0, way = 0;
  for (const Photon& photon : photons) {
    const Vec3 from = photon.position - position, across = from - axis * dot(from, axis);
    turned -= dot(across, photon.wi - wi);
    way += length_squared(across);
  }
  return way > 0 ? std::max(0.0f, turned / way) : 0;
}

// The distance to the sphere from a point inside.
template <typename T>
T distance_to_sphere(Vec3Of<T> in_sphere, T radius, Vec3Of<T> wi) {
  using std::sqrt;
  const T along = dot(in_sphere, wi);
  return sqrt(along * along - length_squared(in_sphere) + radius * radius) - along;
}

// The direction from the centre to the sphere's point.
template <typename T>
Vec3Of<T> from_center(Vec3Of<T> in_sphere, T radius, Vec3Of<T> wi) {
  return (in_sphere + wi * distance_to_sphere(in_sphere, radius, wi)) * (1 / radius);
}

constexpr int kNodeSplits = 3;  // levels of splits in a node
constexpr std::uint32_t kAxesBits = 14;

// Maps split results to a node's child. There is one bit for each of a node's splits, set if the position
// is not below it: one for the first split, two for the second level, four for the third.
constexpr auto kChildByBits = [] {
  std::array<std::uint8_t, 128> child{};
  for (unsigned bits = 0; bits < 128; ++bits) {
    unsigned slot = 1;
    for (int split = 0; split < kNodeSplits; ++split) slot = 2 * slot + (bits >> (slot - 1) & 1);
    child[bits] = static_cast<std::uint8_t>(slot - 8);
  }
  return child;
}();

}  // namespace

// Divides the photons into cells, then computes for each cell how it should be used.
class LightGuide::Builder {
 public:
  LightGuide build(std::span<const Photon> photons, const ShareOf& share_of, int threads) {
    std::array<std::vector<Photon>, 6> by_facing;
    for (const Photon& photon : photons) by_facing[facing<float>(photon.side_normal)].push_back(photon);
    std::vector<std::uint32_t> roots(by_facing.size());
    int splits = 0;
    for (std::size_t f = 0; f < by_facing.size(); ++f) {
      roots[f] = static_cast<std::uint32_t>(splits_.size());
      splits_.emplace_back();
      splits = std::max(splits, divide(roots[f], by_facing[f], kMaxSplits));
    }
    join(std::move(roots), splits);
    const auto count = static_cast<std::int64_t>(evidence_.size());
    ParallelErrors errors;
#pragma omp parallel for num_threads(threads) schedule(dynamic, 16)
    for (std::int64_t c = 0; c < count; ++c)
      errors.run([&] { choose_share(static_cast<std::uint32_t>(c), share_of); });
    errors.rethrow();
    return std::move(guide_);
  }

 private:
  // A split of space, before splits are packed into nodes.
  struct Split {
    float place;
    std::uint32_t axis;   // or kLeaf
    std::uint32_t child;  // the lower child, followed by the other; for a leaf, its cell
  };
  static constexpr std::uint32_t kLeaf = 3;

  // Statistics needed only during the build.
  struct Evidence {
    float guided;  // root mean square of the irradiance estimated by one guided sample
    std::array<Photon, kPlaces> places;
  };

  // Returns the depth of the splits, at most `max_splits`.
  int divide(std::uint32_t split, std::span<Photon> photons, int max_splits) {
    const Aabb box = bounds_of(photons);
    const int axis = longest_axis(box);
    if (photons.size() <= kMaxCellPhotons || !(box.extent(axis) > 0) || max_splits == 0) {
      splits_[split] = {0, kLeaf, add_cell(photons, box)};
      return 0;
    }
    // A stable sort makes the order of equal keys the same everywhere.
    std::stable_sort(photons.begin(), photons.end(), [axis](const Photon& a, const Photon& b) {
      return a.position[axis] < b.position[axis];
    });
    const std::size_t below_split = split_near_middle(photons, axis);
    const auto child = static_cast<std::uint32_t>(splits_.size());
    splits_[split] = {photons[below_split].position[axis], static_cast<std::uint32_t>(axis), child};
    splits_.resize(splits_.size() + 2);
    const int below = divide(child, photons.first(below_split), max_splits - 1);
    return 1 + std::max(below, divide(child + 1, photons.subspan(below_split), max_splits - 1));
  }

  // Where to split photons that are sorted along the axis and not all at the same coordinate: so that none
  // before it have the coordinate of those behind it, as many as there may be in a plane.
  static std::size_t split_near_middle(std::span<const Photon> photons, int axis) {
    const std::size_t half = photons.size() / 2;
    const float middle = photons[half].position[axis];
    const auto count_of = [&](const auto& is_before) {
      return static_cast<std::size_t>(std::partition_point(photons.begin(), photons.end(), is_before) -
                                      photons.begin());
    };
    const auto before = count_of([&](const Photon& photon) { return photon.position[axis] < middle; });
    const auto behind = count_of([&](const Photon& photon) { return photon.position[axis] <= middle; });
    return before > 0 && (behind == photons.size() || half - before <= behind - half) ? before : behind;
  }

  // Packs the splits into nodes, level by level, so that all leaves have equal depth.
  void join(std::vector<std::uint32_t> row, int splits) {
    for (; splits > 0; ++guide_.levels_) {
      const int joined = (splits - 1) % kNodeSplits + 1;
      splits -= joined;
      const std::size_t next_row = splits > 0 ? guide_.nodes_.size() + row.size() : 0;
      std::vector<std::uint32_t> below;
      for (const std::uint32_t split : row) {
        const auto first_child = static_cast<std::uint32_t>(next_row + below.size());
        assert(first_child < 1u << (32 - kAxesBits));
        Node& node = guide_.nodes_.emplace_back();
        node.splits.fill(as_bits(std::numeric_limits<float>::infinity()));
        node.axes_and_children = first_child << kAxesBits;
        below.resize(below.size() + (std::size_t{1} << joined));
        fill(node, 1, split, kNodeSplits - joined, &below[below.size() - (std::size_t{1} << joined)]);
      }
      row = std::move(below);
    }
    for (const std::uint32_t leaf : row) guide_.cell_of_leaf_.push_back(splits_[leaf].child);
  }

  // Fills the subtree of the node's heap of splits at `slot` with the splits from `split` on, below `empty`
  // padding splits. A padding split lies at infinity, so that everything is below it.
  void fill(Node& node, std::uint32_t slot, std::uint32_t split, int empty, std::uint32_t* below) const {
    if (slot > node.splits.size()) {
      below[slot - node.splits.size() - 1] = split;
      return;
    }
    const auto [place, axis, child] = splits_[split];
    if (empty > 0 || axis == kLeaf) return fill(node, 2 * slot, split, empty - 1, below);
    node.splits[slot - 1] = as_bits(place);
    node.axes_and_children |= axis << 2 * (slot - 1);
    fill(node, 2 * slot, child, 0, below);
    fill(node, 2 * slot + 1, child + 1, 0, below);
  }

  std::uint32_t add_cell(std::span<const Photon> photons, const Aabb& box) {
    if (photons.size() < kMinCellPhotons || !(area_of(box) > 0)) return 0;
    float flux = 0, flux_over_distance = 0;
    for (const Photon& photon : photons) {
      flux += photon.flux;
      flux_over_distance += photon.flux / photon.distance;
    }
    if (!std::isfinite(flux)) return 0;
    const bool through_opening = std::isinf(photons.front().distance);
    const float over_distance =
        through_opening ? inverse_distance_of_opening(photons) : flux_over_distance / flux;
    const float diagonal = length(box.upper - box.lower), reach = over_distance * kFarthest * diagonal > 1
                                                                      ? std::max(1 / over_distance, diagonal)
                                                                      : kFarthest * diagonal;
    Cell cell{widened(box), (box.lower + box.upper) * 0.5f, reach, 0, 0};
    const float irradiance = flux / area_of(box);
    std::vector<DirectedLight> lights;
    for (const auto& [position, normal, wi, distance, power, radiance, straight] : photons) {
      const float value = std::min(kLargestValue, kConcentration * radiance * dot(normal, wi) / irradiance);
      const float part = power / flux;
      lights.push_back({from_center(position - cell.center, cell.radius, wi), part, part * value});
    }
    const auto [directions, root_mean_square] =
        guide_.trees_.add(lights, through_opening ? DirectionTrees::kCoarse : DirectionTrees::kFine);
    cell.directions = directions;
    guide_.cells_.push_back(cell);
    Evidence& evidence = evidence_.emplace_back(Evidence{root_mean_square * irradiance, {}});
    for (std::size_t i = 0; i < kPlaces; ++i) evidence.places[i] = photons[i * photons.size() / kPlaces];
    return static_cast<std::uint32_t>(guide_.cells_.size() - 1);
  }

  void choose_share(std::uint32_t cell, const ShareOf& share_of) {
    const auto& [guided, places] = evidence_[cell];
    const float share = share_of({cell, guided, places});
    guide_.cells_[cell + 1].share = share > 0 ? share : 0;
  }

  LightGuide guide_;
  std::vector<Split> splits_{{0, kLeaf, 0}};  // entry 0 is unused
  std::vector<Evidence> evidence_;            // of each cell from index 1
};

LightGuide LightGuide::build(std::span<const Photon> photons, const ShareOf& share_of, int threads) {
  return Builder().build(photons, share_of, threads);
}

// With root mean squares g of the guided light and r of the other, the mean square of a sample is g^2 / share
// + r^2 / (1 - share), which is minimal at share = g / (g + r).
ShareOf share_beside(OtherLight other) {
  return [other = std::move(other)](const CellLight& light) {
    float squares = 0;
    std::uint32_t n = light.cell * static_cast<std::uint32_t>(light.places.size());
    for (const Photon& place : light.places) {
      const float value = other(place, n++);
      squares += value * value;
    }
    const float g = light.guided, r = std::sqrt(squares / static_cast<float>(light.places.size()));
    return std::clamp(g / (g + r), kMinShare, kMaxShare);
  };
}

bool LightGuide::guides_nothing() const {
  return std::none_of(cells_.begin(), cells_.end(), [](const Cell& cell) { return cell.share > 0; });
}

std::uint32_t LightGuide::cell_at(std::uint32_t facing, Vec3 position) const {
  const CoordinateLanes coordinates(position);
  std::uint32_t at = facing;
  for (int level = 0; level < levels_; ++level) {
    const Node& node = nodes_[at];
    const FloatN splits = as_float(U32xN::load(node.splits.data()));  // the eighth lane is not a split
    const MaskN above = coordinates.along(unpack_pairs_of_bits(node.axes_and_children)) >= splits;
    at = (node.axes_and_children >> kAxesBits) + kChildByBits[above.bits() & 0x7f];
  }
  return cell_of_leaf_[at];
}

U32xN LightGuide::cell_at(U32xN facing, Vec3Of<FloatN> position) const {
  const WordLanes facings(facing);
  const Vec3Lanes positions(position);
  WordLanes cells;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    cells.set(lane, cell_at(facings[lane], positions[lane]));
  return cells.all();
}

template <typename T>
LightGuide::GuidanceOf<T> LightGuide::at(Vec3Of<T> position, Vec3Of<T> side_normal) const {
  if (cell_of_leaf_.empty()) return {};
  static_assert(offsetof(Cell, share) == 11 * sizeof(float));
  const WordOf<T> cell = cell_at(facing<T>(side_normal), position) * (sizeof(Cell) / sizeof(float));
  const float* words = &cells_[0].box.lower.x;
  const auto [lower_x, lower_y, lower_z, upper_x] = look_up_row<4>(words, cell);
  const auto [upper_y, upper_z, center_x, center_y] = look_up_row<4>(words + 4, cell);
  const auto [center_z, radius, directions, share] = look_up_row<4>(words + 8, cell);
  const MaskOf<T> contained = (position.x >= lower_x) & (position.y >= lower_y) & (position.z >= lower_z) &
                              (position.x <= upper_x) & (position.y <= upper_y) & (position.z <= upper_z);
  return {select(contained, share, T(0.0f)), position - Vec3Of<T>{center_x, center_y, center_z}, radius,
          as_bits(directions)};
}

// A patch of the sphere is seen from the position at a certain distance and foreshortened by slope /
// radius; from the centre, at the distance of the radius.
template <typename T>
DirectionTrees::DirectionOf<T> LightGuide::sample_or(const GuidanceOf<T>& from, MaskOf<T> sampled,
                                                     Vec2Of<T> u, Vec3Of<T> other) const {
  const auto [direction, pdf] =
      trees_.sample_or<T>(from.directions, sampled, u, from_center(from.in_sphere, from.radius, other));
  const Vec3Of<T> toward = direction * from.radius - from.in_sphere;
  const T distance = length(toward);
  const Vec3Of<T> wi = select(sampled, toward * (1 / distance), other);
  const T slope = distance + dot(from.in_sphere, wi);
  return {wi, pdf * (distance / from.radius) * (distance / slope)};
}

template LightGuide::GuidanceOf<float> LightGuide::at(Vec3, Vec3) const;
template LightGuide::GuidanceOf<FloatN> LightGuide::at(Vec3Of<FloatN>, Vec3Of<FloatN>) const;
template DirectionTrees::DirectionOf<float> LightGuide::sample_or(const GuidanceOf<float>&, bool, Vec2,
                                                                  Vec3) const;
template DirectionTrees::DirectionOf<FloatN> LightGuide::sample_or(const GuidanceOf<FloatN>&, MaskN,
                                                                   Vec2Of<FloatN>, Vec3Of<FloatN>) const;

}  // namespace tessera::core::guiding
