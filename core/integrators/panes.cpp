// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/panes.hpp"

#include <algorithm>
#include <variant>

#include "core/integrators/vertex.hpp"

namespace tessera::core::integrators {
namespace {

// Below this share of the photons' light, looking for straight light takes more time than it saves.
constexpr float kMinStraightShare = 0.01f;

// Follows all ways through panes.
class PaneWalk {
 public:
  PaneWalk(const Scene& scene, Vec3 direction, std::uint32_t max_surfaces, RenderCounters& counters)
      : scene_(scene), direction_(direction), max_surfaces_(max_surfaces), counters_(counters) {}

  void follow(const Ray& ray, const Hit& hit, Rgb throughput, PanePassage passage) {
    if (!hit.found()) {
      if (passage.surfaces > 0 && is_straight(direction_, normalize(ray.direction))) found_ += throughput;
      return;
    }
    if (passage.surfaces == max_surfaces_ || !is_pane_glass(scene_.material_of(hit))) return;
    const PathVertex vertex(scene_, ray, hit);
    if (!vertex.is_delta()) return;
    const bool inside = dot(vertex.surface().geometric_normal, vertex.wo()) < 0;
    const auto branches = vertex.delta_branches();
    for (const bool refracted : {false, true}) {
      const auto& branch = branches[refracted ? 1 : 0];
      if (!branch || !passage.may_continue(refracted, inside)) continue;
      const Ray next = vertex.ray_along(branch->wi);
      ++counters_.shadow_rays;
      follow(next, scene_.closest_hit(next), throughput * branch->weight, passage.beyond(refracted));
    }
  }
  Rgb found() const { return found_; }

 private:
  const Scene& scene_;
  Vec3 direction_;
  std::uint32_t max_surfaces_;
  RenderCounters& counters_;
  Rgb found_;
};

}  // namespace

bool is_pane_glass(const Material& material) {
  const auto* glass = std::get_if<Glass>(&material.model);
  return glass != nullptr && !disperses(*glass);
}

Rgb straight_transmittance(const Scene& scene, const Ray& ray, const Hit& hit, int max_surfaces,
                           RenderCounters& counters) {
  if (max_surfaces <= 0) return {};
  PaneWalk walk(scene, normalize(ray.direction), static_cast<std::uint32_t>(max_surfaces), counters);
  walk.follow(ray, hit, Rgb::gray(1), {});
  return walk.found();
}

// Light samples do not look for panes behind surfaces of partial opacity or among nested dielectrics.
bool remove_straight(const Scene& scene, std::vector<guiding::Photon>& photons) {
  if (!scene.is_opaque()) return false;
  float all = 0, straight = 0;
  for (const guiding::Photon& photon : photons) {
    all += photon.flux;
    if (photon.straight) straight += photon.flux;
  }
  if (!(straight > kMinStraightShare * all)) return false;
  std::erase_if(photons, [](const guiding::Photon& photon) { return photon.straight; });
  return true;
}

}  // namespace tessera::core::integrators
