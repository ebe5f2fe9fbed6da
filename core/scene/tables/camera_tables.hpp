// SPDX-License-Identifier: Apache-2.0
// The keys of cameras.
#pragma once

#include "core/camera/camera_description.hpp"
#include "core/scene/animation.hpp"
#include "core/scene/tables/domains.hpp"

namespace tessera::core {

namespace domains {
inline constexpr Domain kCameraType = words(scene_keys::kCameraTypes);
inline constexpr Domain kFieldOfView{
    .range = {.min = 0, .max = 180, .excludes_min = true, .excludes_max = true}};
inline constexpr Domain kRadius{.range = {.min = 0, .max = 1e15}};
inline constexpr Domain kViewHeight{.range = {.min = 0, .max = 1e15, .excludes_min = true},
                                    .values = "above 0"};
inline constexpr Domain kBlades{.range = {.min = kMinApertureBlades,
                                          .max = kMaxApertureBlades,
                                          .or_zero = true,
                                          .phrase = "0 for a round opening, or a whole number from 3 to 64"},
                                .values = "0, or 3 to 64"};
inline constexpr Domain kTurn{.range = {.min = -360, .max = 360}};
inline constexpr Domain kLensShift{.range = {.min = -double{kMaxLensShift},
                                             .max = double{kMaxLensShift},
                                             .unit = "widths or heights of the image"},
                                   .definition = "shift",
                                   .values = "two numbers from −1000 to 1000"};
inline constexpr Domain kShutter{
    .range = {.min = -double{kMaxShutterFrames}, .max = double{kMaxShutterFrames}, .unit = "frames"},
    .definition = "shutter",
    .values = "`[open, close]`, two numbers from −1000 to 1000"};
}  // namespace domains

template <>
inline constexpr auto kKeys<CameraDescription> = Table{
    Key{"type", &CameraDescription::type, domains::kCameraType,
        "a thin lens; parallel rays; or all directions, as an equirectangular image with `look_at` in its "
        "centre"},
    TrackedKey{"position", &CameraDescription::position, &CameraAnimation::position, domains::kPoint,
               "the centre of the lens", KeyTraits{.required = true, .has_keyframes = true}},
    TrackedKey{"look_at", &CameraDescription::look_at, &CameraAnimation::look_at, domains::kPoint,
               "another point, in the centre of the image",
               KeyTraits{.required = true, .has_keyframes = true}},
    TrackedKey{"up", &CameraDescription::up, &CameraAnimation::up, domains::kVector,
               "the direction that points up in the image, not parallel to the line of sight"},
    TrackedKey{"vertical_fov_degrees", &CameraDescription::vertical_fov_degrees,
               &CameraAnimation::vertical_fov_degrees, domains::kFieldOfView,
               "the vertical field of view: the angle from the lower to the upper edge of the image"},
    TrackedKey{"aperture_radius", &CameraDescription::aperture_radius, &CameraAnimation::aperture_radius,
               domains::kRadius, "the lens radius; 0 is a pinhole, with everything in focus"},
    Key{"aperture_blades", &CameraDescription::aperture_blades, domains::kBlades,
        "the number of corners of a regular polygon, inscribed in the circle of `aperture_radius`. It gives "
        "the bokeh its shape. 0 is a round aperture"},
    TrackedKey{"aperture_rotation_degrees", &CameraDescription::aperture_rotation_degrees,
               &CameraAnimation::aperture_rotation_degrees, domains::kTurn,
               "rotates the polygon counter-clockwise in the image; at 0 a corner points up. Objects nearer "
               "than the focus distance show it upside down"},
    TrackedKey{"focus_distance", &CameraDescription::focus_distance, &CameraAnimation::focus_distance,
               domains::kPositive, "the focus distance along the line of sight",
               KeyTraits{.has_keyframes = true, .otherwise = "the distance to `look_at`"}},
    OtherKey{
        "medium", domains::kMediumName, "the [medium](#media) that the camera is in", {.otherwise = "none"}},
    TrackedKey{"view_height", &CameraDescription::view_height, &CameraAnimation::view_height,
               domains::kViewHeight,
               "the height of the image of an orthographic camera, in the world; required there",
               KeyTraits{.has_keyframes = true, .otherwise = "—"}},
    TrackedKey{"lens_shift", &CameraDescription::lens_shift, &CameraAnimation::lens_shift,
               domains::kLensShift,
               "the offset of the image from the line of sight to the right and upwards, in widths and "
               "heights of the image. At `[0.5, 0]`, `look_at` is on the left edge. It corrects converging "
               "lines: aim horizontally and shift up"},
    Key{"mirror", &CameraDescription::mirrored, domains::kTruth,
        "whether the image is exchanged left to right, as in a mirror"},
    OtherKey{"shutter",
             domains::kShutter,
             "when the shutter opens and closes, in frames from the frame of the image. What has "
             "[keyframes](#keyframes) moves meanwhile: [motion blur](#motion-blur). If both are equal, it is "
             "shown "
             "at that instant",
             {.otherwise = "`[0, 0]`"}},
    Unkeyed{&CameraDescription::shutter_open},
    Unkeyed{&CameraDescription::shutter_close},
};

}  // namespace tessera::core
