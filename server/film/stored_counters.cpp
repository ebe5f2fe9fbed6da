// SPDX-License-Identifier: Apache-2.0
#include "server/film/stored_counters.hpp"

namespace tessera::film {

stored::v1::Counters to_stored(const core::RenderCounters& counters) {
  stored::v1::Counters stored;
  stored.set_samples(counters.samples);
  stored.set_closest_hit_rays(counters.closest_hit_rays);
  stored.set_shadow_rays(counters.shadow_rays);
  stored.set_non_finite_samples(counters.non_finite_samples);
  stored.set_saturated_samples(counters.saturated_samples);
  if (!counters.first_non_finite) return stored;
  stored.mutable_first_non_finite()->set_x(static_cast<std::uint32_t>(counters.first_non_finite->x));
  stored.mutable_first_non_finite()->set_y(static_cast<std::uint32_t>(counters.first_non_finite->y));
  stored.mutable_first_non_finite()->set_sample(counters.first_non_finite->sample);
  return stored;
}

core::RenderCounters from_stored(const stored::v1::Counters& stored) {
  core::RenderCounters counters;
  counters.samples = stored.samples();
  counters.closest_hit_rays = stored.closest_hit_rays();
  counters.shadow_rays = stored.shadow_rays();
  counters.non_finite_samples = stored.non_finite_samples();
  counters.saturated_samples = stored.saturated_samples();
  if (stored.has_first_non_finite())
    counters.first_non_finite =
        core::SampleId{static_cast<int>(stored.first_non_finite().x()),
                       static_cast<int>(stored.first_non_finite().y()), stored.first_non_finite().sample()};
  return counters;
}

}  // namespace tessera::film
