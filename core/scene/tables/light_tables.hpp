// SPDX-License-Identifier: Apache-2.0
// The keys of lights without extent and of the environment.
#pragma once

#include <string>

#include "core/scene/description.hpp"
#include "core/scene/tables/domains.hpp"

namespace tessera::core {

namespace domains {
inline constexpr Domain kConeAngle{.range = {.min = 0, .max = 180, .excludes_min = true}};
inline constexpr Domain kSpotFalloff = words(scene_keys::kSpotFalloffs);
inline constexpr Domain kProjectedImage{.definition = "projected_image",
                                        .values = "a [projected image](#projected-images)",
                                        .kind = "projected image"};
inline constexpr Domain kEnvironmentColor{.range = ranges::kNotNegative,
                                          .definition = "light_color",
                                          .hint = "; the texture is a key of its own: \"texture\": \"NAME\""};
inline constexpr Domain kTurns{.range = ranges::kDegrees};
}  // namespace domains

template <typename Light>
constexpr Key<Light, std::string> group_key() {
  return {"group", &Light::light_group, domains::kLightGroup, "the [light group](#light-groups)",
          KeyTraits{.otherwise = "none"}};
}

template <>
inline constexpr auto kKeys<PointLightDescription> = Table{
    TrackedKey{"position", &PointLightDescription::position, &LightAnimation::position, domains::kPoint,
               "the point that emits. The irradiance falls off with the square of the distance",
               KeyTraits{.required = true, .has_keyframes = true}},
    TrackedKey{"intensity", &PointLightDescription::intensity, &LightAnimation::color, domains::kLightColor,
               "the radiant intensity, in watts per steradian",
               KeyTraits{.required = true, .has_keyframes = true}},
    Key{"texture", &PointLightDescription::texture, domains::kTextureName,
        "an equirectangular image, as of the [environment](#environment), that multiplies the intensity by "
        "direction",
        KeyTraits{.otherwise = "none"}},
    OtherKey{"orientation",
             domains::kTransform,
             "a rotation or a reflection of this image, without keyframes",
             {.otherwise = "none"}},
    group_key<PointLightDescription>(),
    Unkeyed{&PointLightDescription::orientation},
};

template <>
inline constexpr auto kKeys<lights::ProjectedImage> = Table{
    Key{"texture", &lights::ProjectedImage::texture, domains::kTextureName,
        "the image, which multiplies the intensity. Beyond its edges there is no light",
        KeyTraits{.required = true}},
    Key{"right", &lights::ProjectedImage::right, domains::kEdge,
        "from the middle of the image to its right edge, at a distance of 1 along the axis of the cone; "
        "perpendicular to it",
        KeyTraits{.required = true}},
    Key{"up", &lights::ProjectedImage::up, domains::kEdge,
        "from the middle of the image to its upper edge, likewise", KeyTraits{.required = true}},
    Key{"flat_field", &lights::ProjectedImage::flat_field, domains::kTruth,
        "whether an even image evenly lights a wall perpendicular to the axis (intensity / cos³); otherwise "
        "its intensity is even"},
};

template <>
inline constexpr auto kKeys<SpotLightDescription> = Table{
    TrackedKey{"position", &SpotLightDescription::position, &LightAnimation::position, domains::kPoint,
               "the apex of the cone", KeyTraits{.required = true, .has_keyframes = true}},
    TrackedKey{"look_at", &SpotLightDescription::look_at, &LightAnimation::look_at, domains::kPoint,
               "another point, on the axis of the cone", KeyTraits{.required = true, .has_keyframes = true}},
    TrackedKey{"intensity", &SpotLightDescription::intensity, &LightAnimation::color, domains::kLightColor,
               "the radiant intensity on the axis, in watts per steradian",
               KeyTraits{.required = true, .has_keyframes = true}},
    TrackedKey{"angle_degrees", &SpotLightDescription::angle_degrees, &LightAnimation::angle_degrees,
               domains::kConeAngle, "the full opening angle of the cone"},
    TrackedKey{"softness", &SpotLightDescription::softness, &LightAnimation::softness, domains::kUnit,
               "the outer fraction of the cone over which the intensity falls off; 0 is a sharp edge"},
    Key{"falloff", &SpotLightDescription::falloff, domains::kSpotFalloff,
        "a cubic in the cosine of the angle to the axis, linear in the angle, or the square of a ramp that "
        "is "
        "linear in the cosine"},
    Key{"image", &SpotLightDescription::image, domains::kProjectedImage, "what the light projects",
        KeyTraits{.otherwise = "none"}},
    group_key<SpotLightDescription>(),
};

template <>
inline constexpr auto kKeys<DirectionalLightDescription> = Table{
    TrackedKey{"direction", &DirectionalLightDescription::direction, &LightAnimation::direction,
               domains::kVector, "the direction in which the light travels, of any length above 0",
               KeyTraits{.required = true, .has_keyframes = true}},
    TrackedKey{"irradiance", &DirectionalLightDescription::irradiance, &LightAnimation::color,
               domains::kLightColor, "the irradiance of a surface that faces the light",
               KeyTraits{.required = true, .has_keyframes = true}},
    group_key<DirectionalLightDescription>(),
};

template <>
inline constexpr auto kKeys<EnvironmentDescription> = Table{
    PartKey{
        "texture", &EnvironmentDescription::radiance, &ColorParameter::texture, domains::kTextureName,
        "an equirectangular image, twice as wide as high, preferably HDR. Its centre is at −z, to the right "
        "of that is +x, its upper edge is +y. The texture must not have `wrap`, `scale`, `shear`, `offset`, "
        "`filter` or `uv_set`",
        KeyTraits{.otherwise = "none"}},
    PartKey{"radiance", &EnvironmentDescription::radiance, &ColorParameter::value, domains::kEnvironmentColor,
            "the radiance from every direction; multiplies the texture", KeyTraits{.has_keyframes = true}},
    Key{"rotation_degrees", &EnvironmentDescription::rotation_degrees, domains::kTurns,
        "the rotation about +y, counter-clockwise seen from above", KeyTraits{.has_keyframes = true}},
    OtherKey{
        "orientation",
        domains::kTransform,
        "a rotation or a reflection that is applied after `rotation_degrees`, without keyframes. Steps that "
        "change lengths or angles are an error; what translates has no effect",
        {.otherwise = "none"}},
    Key{"visible_to_camera", &EnvironmentDescription::visible_to_camera, domains::kTruth,
        "whether camera rays that miss all shapes see the environment. Otherwise they are black, and the "
        "image "
        "has [alpha](layers.md); the environment still lights the scene, and shows in mirrors and through "
        "glass"},
    group_key<EnvironmentDescription>(),
    Unkeyed{&EnvironmentDescription::orientation},
};

}  // namespace tessera::core
