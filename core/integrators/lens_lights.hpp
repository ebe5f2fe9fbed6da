// SPDX-License-Identifier: Apache-2.0
// Lens light sampling: finds lamps that the camera sees out of focus. All camera rays through one point of
// the image pass through a point in focus, and a small lamp is hit by few of them. A second technique beside
// uniform points of the lens chooses a lamp that the lens can see through the point in focus, a point of it,
// and the point of the lens that sees that. This is light tracing of length one (Veach 1997, section 10.3),
// restricted to the rays of a pixel; multiple importance sampling combines the two.
//
// Lamps whose images are not much blurred are left to the lens, and so are all lamps of a point in focus
// through which they fill much of the lens. Immutable, shared by all threads.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/lights/light_tree.hpp"
#include "core/lights/lights_in_cone.hpp"
#include "core/scene/scene.hpp"
#include "core/scene/settings.hpp"

namespace tessera::core::integrators {

class LensLights {
 public:
  // None.
  LensLights() = default;
  // Those that the camera can see, at the frame that the scene shows. Keeps a reference to the scene. The
  // result does not depend on `threads`.
  LensLights(const Scene& scene, int threads);

  bool empty() const { return tree_.empty(); }

  // Light that arrives at the lens unless something is in the way of the ray.
  struct Connection {
    Ray ray;       // from the lens to the lamp
    Rgb radiance;  // weighted, per sample
    std::uint32_t light;
  };
  // One sample of the lamps that are seen through a point in focus. `u`: position on the lamp; choice of it,
  // coarse and fine.
  std::optional<Connection> connect(Heuristic heuristic, Vec3 focus, float time,
                                    const std::array<float, 4>& u) const;

  // A camera ray that hits a light.
  struct Found {
    Vec3 focus, direction;  // the direction has unit length
    float time;
    std::uint32_t light;
    float light_pdf;  // of the direction at the focus, given the light
  };
  // The weight of the light's emission.
  float weight(Heuristic heuristic, const Found& found) const;

 private:
  std::optional<Connection> connect(const Camera& camera, Heuristic heuristic, Vec3 focus, float time,
                                    const std::array<float, 4>& u) const;

  const Scene* scene_ = nullptr;
  lights::LightTree tree_;
};

}  // namespace tessera::core::integrators
