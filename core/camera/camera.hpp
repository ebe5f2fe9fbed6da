// SPDX-License-Identifier: Apache-2.0
// The camera of a scene: which rays sample a pixel. Immutable.
#pragma once

#include <optional>

#include "core/camera/aperture.hpp"
#include "core/camera/camera_description.hpp"
#include "core/geometry/double_cone.hpp"
#include "core/geometry/ray.hpp"
#include "core/math/frame.hpp"

namespace tessera::core {

class Camera {
 public:
  Camera() = default;
  explicit Camera(const CameraDescription& description);

  // The ray through `raster` (pixels from the top left of the image, y downwards) and the lens point
  // selected by `u_lens` in [0, 1)^2. The direction has unit length. T is float or FloatN.
  template <typename T = float>
  RayOf<T> ray(Vec2Of<T> raster, int width_px, int height_px, Vec2Of<T> u_lens) const;
  // How far a point is from the origin of a camera ray that meets it, along the line of sight; for panoramic
  // cameras, their distance. Not negative.
  float depth(Vec3 origin, Vec3 point) const;

  // Whether the rays of a point of the image start at different points, those of a lens. If so, all of them
  // pass through one point in focus, from which the following functions start.
  bool has_lens() const { return type_ != CameraType::kPanoramic && !aperture_.is_pinhole(); }
  // The direction of the line of sight; unit length.
  Vec3 forward() const { return forward_; }
  // The point in focus of `raster`.
  Vec3 focus(Vec2 raster, int width_px, int height_px) const;
  // The density, per solid angle at the point in focus, with which ray() generates the unit direction of a
  // ray that comes from the lens.
  float lens_pdf(Vec3 direction) const;
  // Where a ray along the unit direction that meets the point in focus comes from; nothing beside the lens.
  std::optional<Vec3> lens_point(Vec3 focus, Vec3 direction) const;
  // Contains the rays of a point in focus, continued backwards.
  DoubleCone lens_cone(Vec3 focus) const;
  // The share of the lens that `area` fills when a point in focus projects it from `point`, or at most from
  // `radius` away, onto the lens. 0 if it is behind the lens or around
  // it, infinity if it may be in focus.
  float share_of_lens(float area, Vec3 point, float radius) const;

 private:
  // A line through the middle of the lens; `direction` is 1 long along the line of sight.
  template <typename T>
  struct LineOf {
    Vec3Of<T> position, direction;
  };
  template <typename T>
  LineOf<T> chief_ray(Vec2Of<T> raster, int width_px, int height_px) const;
  // The middle of the lens, from which the ray to a point in focus comes.
  Vec3 lens_center(Vec3 focus) const;
  template <typename T>
  RayOf<T> panoramic_ray(Vec2Of<T> image) const;
  // A ray from a point of the lens that meets `line` at the focus distance.
  template <typename T>
  RayOf<T> through_lens(const LineOf<T>& line, Vec2Of<T> u_lens) const;

  CameraType type_ = CameraType::kPerspective;
  Vec3 position_;
  Vec3 right_, up_, forward_;
  float height_ = 2;  // of the image: at the distance 1 if perspective, in the world if orthographic
  Vec2 shift_;
  Aperture aperture_;
  float focus_distance_ = 1;
};

}  // namespace tessera::core
