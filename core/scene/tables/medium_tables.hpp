// SPDX-License-Identifier: Apache-2.0
// The keys of participating media.
#pragma once

#include "core/media/medium_description.hpp"
#include "core/scene/tables/domains.hpp"

namespace tessera::core {

namespace domains {
inline constexpr Domain kAsymmetry{
    .range = {.min = -1, .max = 1, .excludes_min = true, .excludes_max = true}};
inline constexpr Domain kGridName{.names = NamesOf::kGrids, .definition = "grid_name"};
}  // namespace domains

template <>
inline constexpr auto kKeys<MediumDescription> = Table{
    Key{"sigma_a", &MediumDescription::sigma_a, domains::kLightColor,
        "the coefficient of absorption, per unit of length", KeyTraits{.has_keyframes = true}},
    Key{"sigma_s", &MediumDescription::sigma_s, domains::kLightColor,
        "the coefficient of scattering, per unit of length", KeyTraits{.has_keyframes = true}},
    Key{"scale", &MediumDescription::scale, domains::kNotNegative,
        "multiplies both coefficients: the density", KeyTraits{.has_keyframes = true}},
    Key{"g", &MediumDescription::g, domains::kAsymmetry,
        "the mean cosine of the angle of scattering (Henyey–Greenstein): 0 scatters equally in all "
        "directions, above 0 mostly onward, below 0 mostly back",
        KeyTraits{.has_keyframes = true}},
    Key{"emission", &MediumDescription::emission, domains::kLightColor,
        "the radiance of an opaque amount of the medium: per unit of length it emits `sigma_a` · `scale` · "
        "`emission`",
        KeyTraits{.has_keyframes = true}},
    Key{"absorption_grid", &MediumDescription::absorption_grid, domains::kGridName,
        "multiplies `sigma_a` point by point", KeyTraits{.otherwise = "none"}},
    Key{"scattering_grid", &MediumDescription::scattering_grid, domains::kGridName,
        "multiplies `sigma_s` point by point", KeyTraits{.otherwise = "none"}},
    Key{"emission_grid", &MediumDescription::emission_grid, domains::kGridName,
        "multiplies `emission` point by point. Several may name the same grid",
        KeyTraits{.otherwise = "none"}},
    OtherKey{"transform",
             domains::kTransform,
             "places the unit cube of the grids in the world. It cannot be animated",
             {.otherwise = "none"}},
    Unkeyed{&MediumDescription::grid_to_world},
    Unkeyed{&MediumDescription::name},
};

}  // namespace tessera::core
