// SPDX-License-Identifier: Apache-2.0
// Between the messages of the contract and core's types. What comes from outside is checked: every from_proto
// answers INVALID_ARGUMENT with the field's name where a value cannot be.
#pragma once

#include "core/base/error.hpp"
#include "core/film/film.hpp"
#include "core/film/region.hpp"
#include "core/scene/settings.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::proto {

v1::Integrator to_proto(core::Integrator integrator);
// Not for UNSPECIFIED: that is an error here.
core::Result<core::Integrator> from_proto(v1::Integrator integrator);

v1::Heuristic to_proto(core::Heuristic heuristic);
// UNSPECIFIED is an error here, too.
core::Result<core::Heuristic> from_proto(v1::Heuristic heuristic);

v1::PixelFilter to_proto(core::FilterKind kind);
// Not for UNSPECIFIED: that is an error here.
core::Result<core::FilterKind> from_proto(v1::PixelFilter filter);

v1::RenderSettings to_proto(const core::RenderSettings& settings);
// Within the limits of core/scene/settings.hpp.
core::Result<core::RenderSettings> from_proto(const v1::RenderSettings& settings);
// What they ask to render: the crop window, or the whole picture. For settings that were checked.
core::PixelRect window_of(const v1::RenderSettings& settings);

v1::RenderOverrides to_proto(const core::RenderOverrides& overrides);
// Only representable, not within limits: core::resolve_settings checks those, in the same words as for a
// local render.
core::Result<core::RenderOverrides> from_proto(const v1::RenderOverrides& overrides);

v1::PixelRect to_proto(const core::PixelRect& rect);
// Not empty, and within the largest picture there can be.
core::Result<core::PixelRect> from_proto(const v1::PixelRect& rect);

// Samples `range` of the pixels of `rect`.
struct WorkItem {
  core::PixelRect rect;
  core::SampleRange range;
  bool operator==(const WorkItem&) const = default;
};
v1::WorkItem to_proto(const WorkItem& item);
// Neither rectangle nor range empty.
core::Result<WorkItem> from_proto(const v1::WorkItem& item);

v1::Counters to_proto(const core::RenderCounters& counters);
core::RenderCounters from_proto(const v1::Counters& counters);

}  // namespace tessera::proto
