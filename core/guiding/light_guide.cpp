#include "core/guiding/light_guide.hpp"

#include <algorithm>
#include <utility>

namespace tessera::core {
namespace {

// Cells of more photons are divided; fewer tell too little.
constexpr std::size_t kMostCellPhotons = 256, kLeastCellPhotons = 8;
constexpr float kLeastShare = 0.05f, kMostShare = 0.7f;
// How often other light is estimated for a cell.
constexpr std::size_t kProbes = 16;
// What the guide samples varies, being a guess; by about this factor in the mean square.
constexpr float kGuideSpread = 2;

// 0 to 5: the axis along which `normal` is longest, and whether it points backwards.
std::size_t facing(Vec3 normal) {
  const Vec3 a = abs(normal);
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
  return 2 * static_cast<std::size_t>(axis) + (normal[axis] < 0 ? 1 : 0);
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

// Of the box's largest side: what the surface in it has, if that is about flat.
float area_of(const Aabb& box) {
  std::array<double, 3> extents{box.extent(0), box.extent(1), box.extent(2)};
  std::sort(extents.begin(), extents.end());
  return static_cast<float>(extents[1] * extents[2]);
}

// A little larger, for what lies just beside the photons.
Aabb widened(const Aabb& box) {
  const float margin = static_cast<float>(box.extent(longest_axis(box))) * 0.1f;
  const Vec3 all{margin, margin, margin};
  return {box.lower - all, box.upper + all};
}

bool contains(const Aabb& box, Vec3 p) {
  return p.x >= box.lower.x && p.y >= box.lower.y && p.z >= box.lower.z && p.x <= box.upper.x &&
         p.y <= box.upper.y && p.z <= box.upper.z;
}

// Where the ray from `position`, inside, meets the sphere around `center`: how far along the ray, and by what
// the cosine there exceeds 1 / radius.
struct Meeting {
  float t, slope;
};
Meeting meet_sphere(const LightGuide::Cell& cell, Vec3 position, Vec3 wi) {
  const Vec3 o = position - cell.center;
  const float along = dot(o, wi);
  const float slope = std::sqrt(along * along - length_squared(o) + cell.radius * cell.radius);
  return {slope - along, slope};
}

// The direction in which that point lies from the centre.
Vec3 from_center(const LightGuide::Cell& cell, Vec3 position, Vec3 wi, float t) {
  return normalize(position - cell.center + wi * t);
}

}  // namespace

// Divides the photons into cells, then finds what each cell should be used for.
class LightGuide::Builder {
 public:
  LightGuide build(std::span<const Photon> photons, const OtherLight& other_light, int threads) {
    std::array<std::vector<Photon>, 6> by_facing;
    for (const Photon& photon : photons) by_facing[facing(photon.side_normal)].push_back(photon);
    for (std::size_t f = 0; f < by_facing.size(); ++f) {
      guide_.roots_[f] = static_cast<std::uint32_t>(guide_.nodes_.size());
      guide_.nodes_.emplace_back();
      divide(guide_.roots_[f], by_facing[f]);
    }
    const auto count = static_cast<std::int64_t>(guide_.cells_.size());
#pragma omp parallel for num_threads(threads) schedule(dynamic, 16)
    for (std::int64_t c = 0; c < count; ++c) choose_share(static_cast<std::size_t>(c), other_light);
    return std::move(guide_);
  }

 private:
  // What is only known while the guide is built.
  struct Evidence {
    float irradiance;  // by the photons
    std::array<Photon, kProbes> places;
  };

  void divide(std::uint32_t node, std::span<Photon> photons) {
    const Aabb box = bounds_of(photons);
    if (photons.size() <= kMostCellPhotons) {
      guide_.nodes_[node] = {0, kLeaf, add_cell(photons, box)};
      return;
    }
    const int axis = longest_axis(box);
    // The order among equals is kept, so that it is the same everywhere.
    std::stable_sort(photons.begin(), photons.end(), [axis](const Photon& a, const Photon& b) {
      return a.position[axis] < b.position[axis];
    });
    const std::size_t half = photons.size() / 2;
    const auto child = static_cast<std::uint32_t>(guide_.nodes_.size());
    guide_.nodes_[node] = {photons[half].position[axis], static_cast<std::uint32_t>(axis), child};
    guide_.nodes_.resize(guide_.nodes_.size() + 2);
    divide(child, photons.first(half));
    divide(child + 1, photons.subspan(half));
  }

  std::uint32_t add_cell(std::span<const Photon> photons, const Aabb& box) {
    if (photons.size() < kLeastCellPhotons || !(area_of(box) > 0)) return kNoCell;
    float flux = 0, flux_over_distance = 0;
    for (const Photon& photon : photons) {
      flux += photon.flux;
      flux_over_distance += photon.flux / photon.distance;
    }
    const float reach = std::max(flux / flux_over_distance, length(box.upper - box.lower));
    Cell cell{widened(box), (box.lower + box.upper) * 0.5f, reach, 0, 0};
    std::vector<WeightedDirection> directions;
    for (const auto& [position, normal, wi, distance, weight] : photons)
      directions.push_back({from_center(cell, position, wi, meet_sphere(cell, position, wi).t), weight});
    cell.directions = guide_.trees_.add(directions);
    guide_.cells_.push_back(cell);
    Evidence& evidence = evidence_.emplace_back(Evidence{flux / area_of(box), {}});
    for (std::size_t i = 0; i < kProbes; ++i) evidence.places[i] = photons[i * photons.size() / kProbes];
    return static_cast<std::uint32_t>(guide_.cells_.size() - 1);
  }

  // A sample is either of the guide's light, then worth about g, or of the other, then worth about r: its
  // mean square is g^2 / share + r^2 / (1 - share), which is least at g / (g + r).
  void choose_share(std::size_t cell, const OtherLight& other_light) {
    const auto& [irradiance, places] = evidence_[cell];
    float squares = 0;
    for (std::size_t i = 0; i < kProbes; ++i) {
      const float value = other_light(places[i], static_cast<std::uint32_t>(cell * kProbes + i));
      squares += value * value;
    }
    const float g = kGuideSpread * irradiance, r = std::sqrt(squares / static_cast<float>(kProbes));
    guide_.cells_[cell].share = std::clamp(g / (g + r), kLeastShare, kMostShare);
  }

  LightGuide guide_;
  std::vector<Evidence> evidence_;  // of each cell
};

LightGuide LightGuide::build(std::span<const Photon> photons, const OtherLight& other_light, int threads) {
  return Builder().build(photons, other_light, threads);
}

const LightGuide::Cell* LightGuide::find(Vec3 position, Vec3 side_normal) const {
  if (cells_.empty()) return nullptr;
  const Node* node = &nodes_[roots_[facing(side_normal)]];
  while (node->axis != kLeaf) {
    const bool upper = position[static_cast<int>(node->axis)] >= node->split;
    node = &nodes_[node->child + (upper ? 1 : 0)];
  }
  if (node->child == kNoCell || !contains(cells_[node->child].box, position)) return nullptr;
  return &cells_[node->child];
}

Vec3 LightGuide::sample(const Cell& cell, Vec3 position, Vec2 u) const {
  return normalize(cell.center + trees_.sample(cell.directions, u) * cell.radius - position);
}

// A patch of the sphere is seen from the position at the distance t and foreshortened by slope / radius, from
// the centre at the distance of the radius.
float LightGuide::pdf(const Cell& cell, Vec3 position, Vec3 wi) const {
  const auto [t, slope] = meet_sphere(cell, position, wi);
  const float density = trees_.pdf(cell.directions, from_center(cell, position, wi, t));
  return density * (t * t) / (cell.radius * slope);
}

}  // namespace tessera::core
