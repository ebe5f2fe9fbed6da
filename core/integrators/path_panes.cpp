// SPDX-License-Identifier: Apache-2.0
// What PathTracer does about panes (panes.hpp), in scenes whose light samples pass them.
#include <cstddef>
#include <vector>

#include "core/integrators/panes.hpp"
#include "core/integrators/path.hpp"
#include "core/integrators/path_lanes.hpp"
#include "core/integrators/path_weights.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core::integrators {

// Overwrites the columns that stay those of the vertex before the panes. A part of a blend is no pane, as in
// PaneWalk.
void PathTracer::put_straight(const Paths& paths, const Scattering& at, const NewRows<PathState>& states,
                              int depth) const {
  unsigned passing = 0;
  WordLanes surfaces, reflections;
  const unsigned delta = at.delta.bits(), refracted = at.refracted.bits(), inside = at.inside.bits();
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const PanePassage before = paths.states.get(&PathState::panes, lane);
    const bool refracts = (refracted >> lane & 1) != 0;
    const bool passes = (delta >> lane & 1) != 0 && is_pane_glass(scene_.material_of(paths.hits[lane])) &&
                        before.may_continue(refracts, (inside >> lane & 1) != 0);
    passing |= (passes ? 1u : 0u) << lane;
    const PanePassage after = passes ? before.beyond(refracts) : PanePassage{};
    surfaces.set(lane, after.surfaces);
    reflections.set(lane, after.reflections);
  }
  const MaskN passes = MaskN::from_bits(passing),
              starts = MaskN::from_bits(passes_panes_at(depth) ? ~delta & ((1u << kLaneCount) - 1) : 0);
  const lights::LightSampleContexts last = paths.states.all(&PathState::last);
  states.put(&PathState::last, {select(passes, last.position, at.context.position),
                                select(passes, last.normal, at.context.normal)});
  states.put(&PathState::emitter_mis_scale,
             select(passes, paths.states.all(&PathState::emitter_mis_scale), at.emitter_mis_scale));
  states.put(&PathState::straight,
             select(passes, paths.states.all(&PathState::straight), select(starts, at.wi, Vec3Of<FloatN>{})));
  states.put(&PathState::straight_pdf,
             select(passes, paths.states.all(&PathState::straight_pdf), at.bsdf_pdf));
  const auto counts = states.field(&PathState::panes);
  counts.put(&PanePassage::surfaces, surfaces.all());
  counts.put(&PanePassage::reflections, reflections.all());
}

// Whether the path has left the scene straight.
bool PathTracer::is_straight(RowView<PathState> state) const {
  return through_panes_ && state.get(&PathState::last_pdf) == kDeltaPdf &&
         core::integrators::is_straight(state.get(&PathState::straight),
                                        normalize(state.get(&PathState::ray).direction));
}

// The weight of straight light of the environment, against light samples of the vertex before the panes.
float PathTracer::straight_weight(RowView<PathState> state) const {
  const float scale = state.get(&PathState::emitter_mis_scale);
  if (settings_.integrator == Integrator::kNee || scale == 0) return 0;
  const lights::LightSampleContext last = state.get(&PathState::last);
  const Vec3 wi = state.get(&PathState::straight);
  const float light_pdf =
      environment_sample_pdf(last, wi, scene_.environment().pdf(last.normal, wi, compensation_));
  return scale * mis_weight(settings_.heuristic, state.get(&PathState::straight_pdf), light_pdf);
}

// Adds the straight light of occluded connections to the environment. Its depth
// counts as that of two surfaces: all of it is indirect.
void PathTracer::add_straight(RenderCounters& counters, int depth) {
  const ColumnsView<const Connection> all = connections_.all();
  std::vector<std::size_t> occluded;
  Columns<Ray> rays;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (occluded_[i] == accel::Occlusion::kNone ||
        all.get(&Connection::light, i) != scene_.environment_light())
      continue;
    occluded.push_back(i);
    rays.push(all.get(&Connection::ray, i));
  }
  Columns<Hit> hits(rays.size());
  counters.shadow_rays += rays.size();
  scene_.closest_hits(rays.all(), hits.all());
  const int max_depth = settings_.max_depth > 0 ? settings_.max_depth : kMaxPathDepth;
  for (std::size_t k = 0; k < occluded.size(); ++k) {
    const auto [ray, path, radiance, light] = all[occluded[k]];
    const Rgb share = straight_transmittance(scene_, ray, hits[k], max_depth - depth - 1, counters);
    if (!is_black(share)) add(path, radiance * share, depth + 3, light);
  }
}

}  // namespace tessera::core::integrators
