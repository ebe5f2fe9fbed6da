#include "core/guiding/light_guide.hpp"

#include <algorithm>
#include <utility>

#include "core/math/simd_double8.hpp"

namespace tessera::core {
namespace {

// Cells of more photons are divided; fewer tell too little.
constexpr std::size_t kMostCellPhotons = 256, kLeastCellPhotons = 8;
constexpr float kLeastShare = 0.05f, kMostShare = 0.7f;
// How often other light is estimated for a cell.
constexpr std::size_t kProbes = 16;
// How much of a caustic's light comes from directions that the guide cannot tell from those around them;
// where it can, the power alone says what to expect.
constexpr float kConcentration = 0.3f;
// Of a sample, in units of the cell's irradiance; so that sums stay finite.
constexpr float kLargestValue = 1e12f;

// 0 to 5: the axis along which `normal` is longest, and whether it points backwards.
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

// Where the ray from the place, inside, meets the sphere: how far along the ray, and by what the cosine there
// exceeds 1 / radius.
template <typename T>
struct Meeting {
  T t, slope;
};
template <typename T>
Meeting<T> meet_sphere(const LightGuide::GuidanceOf<T>& from, Vec3Of<T> wi) {
  using std::sqrt;
  const Vec3Of<T> o = from.position - from.center;
  const T along = dot(o, wi);
  const T slope = sqrt(along * along - length_squared(o) + from.radius * from.radius);
  return {slope - along, slope};
}

// The direction in which that point lies from the centre.
template <typename T>
Vec3Of<T> from_center(const LightGuide::GuidanceOf<T>& from, Vec3Of<T> wi, T t) {
  return normalize(from.position - from.center + wi * t);
}

}  // namespace

// Divides the photons into cells, then finds what each cell should be used for.
class LightGuide::Builder {
 public:
  LightGuide build(std::span<const Photon> photons, const OtherLight& other_light, int threads) {
    std::array<std::vector<Photon>, 6> by_facing;
    for (const Photon& photon : photons) by_facing[facing<float>(photon.side_normal)].push_back(photon);
    for (std::size_t f = 0; f < by_facing.size(); ++f) {
      guide_.roots_[f] = static_cast<std::uint32_t>(guide_.nodes_.size());
      guide_.nodes_.emplace_back();
      divide(guide_.roots_[f], by_facing[f]);
    }
    const auto count = static_cast<std::int64_t>(evidence_.size());
#pragma omp parallel for num_threads(threads) schedule(dynamic, 16)
    for (std::int64_t c = 0; c < count; ++c) choose_share(static_cast<std::size_t>(c), other_light);
    return std::move(guide_);
  }

 private:
  // What is only known while the guide is built.
  struct Evidence {
    float guided;  // root mean square of the irradiance by one sample of the guide's
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
    if (photons.size() < kLeastCellPhotons || !(area_of(box) > 0)) return 0;
    float flux = 0, flux_over_distance = 0;
    for (const Photon& photon : photons) {
      flux += photon.flux;
      flux_over_distance += photon.flux / photon.distance;
    }
    const float reach = std::max(flux / flux_over_distance, length(box.upper - box.lower));
    Cell cell{widened(box), (box.lower + box.upper) * 0.5f, reach, 0, 0};
    const float irradiance = flux / area_of(box);
    std::vector<DirectedLight> lights;
    for (const auto& [position, normal, wi, distance, power, radiance] : photons) {
      const GuidanceOf<float> from{1, position, cell.center, cell.radius, 0};
      const float value = std::min(kLargestValue, kConcentration * radiance * dot(normal, wi) / irradiance);
      const float part = power / flux;
      lights.push_back({from_center(from, wi, meet_sphere(from, wi).t), part, part * value});
    }
    const auto [directions, root_mean_square] = guide_.trees_.add(lights);
    cell.directions = directions;
    guide_.cells_.push_back(cell);
    Evidence& evidence = evidence_.emplace_back(Evidence{root_mean_square * irradiance, {}});
    for (std::size_t i = 0; i < kProbes; ++i) evidence.places[i] = photons[i * photons.size() / kProbes];
    return static_cast<std::uint32_t>(guide_.cells_.size() - 1);
  }

  // A sample is either of the guide's light, whose root mean square is g, or of the other, with r: its
  // mean square is g^2 / share + r^2 / (1 - share), which is least at g / (g + r).
  void choose_share(std::size_t cell, const OtherLight& other_light) {
    const auto& [guided, places] = evidence_[cell];
    float squares = 0;
    for (std::size_t i = 0; i < kProbes; ++i) {
      const float value = other_light(places[i], static_cast<std::uint32_t>(cell * kProbes + i));
      squares += value * value;
    }
    const float g = guided, r = std::sqrt(squares / static_cast<float>(kProbes));
    guide_.cells_[cell + 1].share = std::clamp(g / (g + r), kLeastShare, kMostShare);
  }

  LightGuide guide_;
  std::vector<Evidence> evidence_;  // of each cell but the first
};

LightGuide LightGuide::build(std::span<const Photon> photons, const OtherLight& other_light, int threads) {
  return Builder().build(photons, other_light, threads);
}

// The cell of the leaf around each place.
template <typename T>
WordOf<T> LightGuide::find(Vec3Of<T> position, Vec3Of<T> side_normal) const {
  using Word = WordOf<T>;
  constexpr std::uint32_t kStride = sizeof(Node) / sizeof(std::uint32_t);
  Word node = look_up(roots_.data(), facing<T>(side_normal));
  for (;;) {
    const Word axis = look_up(&nodes_[0].axis, node * kStride),
               child = look_up(&nodes_[0].child, node * kStride);
    const MaskOf<T> leaf = axis == kLeaf;
    if (all(leaf)) return child;
    const T split = look_up(&nodes_[0].split, node * kStride);
    const T along = select(axis == 0, position.x, select(axis == 1, position.y, position.z));
    node = select(leaf, node, child + select(along >= split, Word(1), Word(0)));
  }
}

template <typename T>
LightGuide::GuidanceOf<T> LightGuide::at(Vec3Of<T> position, Vec3Of<T> side_normal) const {
  if (nodes_.empty()) return {};
  constexpr std::uint32_t kStride = sizeof(Cell) / sizeof(float);
  const WordOf<T> cell = find<T>(position, side_normal) * kStride;
  const Cell& first = cells_[0];
  const auto look_up_place = [cell](const Vec3& place) {
    return Vec3Of<T>{look_up(&place.x, cell), look_up(&place.y, cell), look_up(&place.z, cell)};
  };
  const Vec3Of<T> lower = look_up_place(first.box.lower), upper = look_up_place(first.box.upper);
  const MaskOf<T> contained = (position.x >= lower.x) & (position.y >= lower.y) & (position.z >= lower.z) &
                              (position.x <= upper.x) & (position.y <= upper.y) & (position.z <= upper.z);
  return {select(contained, look_up(&first.share, cell), T(0.0f)), position, look_up_place(first.center),
          look_up(&first.radius, cell), look_up(&first.directions, cell)};
}

template <typename T>
Vec3Of<T> LightGuide::sample(const GuidanceOf<T>& from, Vec2Of<T> u) const {
  return normalize(from.center + trees_.sample<T>(from.directions, u) * from.radius - from.position);
}

// A patch of the sphere is seen from the position at the distance t and foreshortened by slope / radius, from
// the centre at the distance of the radius.
template <typename T>
T LightGuide::pdf(const GuidanceOf<T>& from, Vec3Of<T> wi) const {
  const auto [t, slope] = meet_sphere(from, wi);
  const T density = trees_.pdf<T>(from.directions, from_center(from, wi, t));
  return density * (t * t) / (from.radius * slope);
}

template LightGuide::GuidanceOf<float> LightGuide::at(Vec3Of<float>, Vec3Of<float>) const;
template LightGuide::GuidanceOf<Float8> LightGuide::at(Vec3Of<Float8>, Vec3Of<Float8>) const;
template Vec3Of<float> LightGuide::sample(const GuidanceOf<float>&, Vec2Of<float>) const;
template Vec3Of<Float8> LightGuide::sample(const GuidanceOf<Float8>&, Vec2Of<Float8>) const;
template float LightGuide::pdf(const GuidanceOf<float>&, Vec3Of<float>) const;
template Float8 LightGuide::pdf(const GuidanceOf<Float8>&, Vec3Of<Float8>) const;

}  // namespace tessera::core
