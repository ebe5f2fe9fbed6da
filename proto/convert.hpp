// SPDX-License-Identifier: Apache-2.0
// Conversions between the messages of the protocol and core's types. Untrusted values are checked: every
// from_proto returns INVALID_ARGUMENT with the field's name for an invalid value.
#pragma once

#include <google/protobuf/repeated_ptr_field.h>

#include <cstdint>
#include <string>

#include "core/base/error.hpp"
#include "core/film/film.hpp"
#include "core/film/layers.hpp"
#include "core/film/layout.hpp"
#include "core/film/region.hpp"
#include "core/scene/settings.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::proto {

v1::Integrator to_proto(core::Integrator integrator);
// UNSPECIFIED is an error.
core::Result<core::Integrator> from_proto(v1::Integrator integrator);

v1::Heuristic to_proto(core::Heuristic heuristic);
// UNSPECIFIED is an error.
core::Result<core::Heuristic> from_proto(v1::Heuristic heuristic);

v1::PixelFilter to_proto(core::FilterKind kind);
// UNSPECIFIED is an error.
core::Result<core::FilterKind> from_proto(v1::PixelFilter filter);

v1::RenderSettings to_proto(const core::RenderSettings& settings);
// Checks the limits of core/scene/settings.hpp.
core::Result<core::RenderSettings> from_proto(const v1::RenderSettings& settings);
// The pixels to render: the crop window, or the whole image. For settings that were checked.
core::PixelRect window_of(const v1::RenderSettings& settings);

v1::RenderOverrides to_proto(const core::RenderOverrides& overrides);
// Checks only that the values are representable. core::resolve_settings checks the limits, with the same
// messages as for a local render.
core::Result<core::RenderOverrides> from_proto(const v1::RenderOverrides& overrides);

v1::ChannelEncoding to_proto(core::ChannelEncoding encoding);
v1::FilmLayout to_proto(const core::FilmLayout& layout);
// The names of layers. INVALID_ARGUMENT names `layers`: one is unknown, or there are more than there are
// layers.
void add_layers(const core::LayerSet& layers, google::protobuf::RepeatedPtrField<std::string>& names);
core::Result<core::LayerSet> layers_from(const google::protobuf::RepeatedPtrField<std::string>& names);

v1::PixelRect to_proto(const core::PixelRect& rect);
// Checks that the rectangle is not empty and lies within the largest possible image.
core::Result<core::PixelRect> from_proto(const v1::PixelRect& rect);

// Samples `range` of every pixel of `rect` in an image of a job.
struct WorkItem {
  core::PixelRect rect;
  core::SampleRange range;
  std::uint32_t image = 0;
  bool operator==(const WorkItem&) const = default;
};
v1::WorkItem to_proto(const WorkItem& item);
// Checks that neither rectangle nor range is empty.
core::Result<WorkItem> from_proto(const v1::WorkItem& item);

v1::Counters to_proto(const core::RenderCounters& counters);
core::RenderCounters from_proto(const v1::Counters& counters);

}  // namespace tessera::proto
