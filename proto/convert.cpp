// SPDX-License-Identifier: Apache-2.0
#include "proto/convert.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <bit>
#include <limits>
#include <utility>

#include "core/base/printable.hpp"

namespace tessera::proto {
namespace {

using core::ErrorCode;
using core::fail;

// A value above all limits must not become negative, so that the limit's error reports it.
core::Result<int> to_int(std::uint32_t value, const char* field) {
  if (value > static_cast<std::uint32_t>(std::numeric_limits<int>::max()))
    return fail(ErrorCode::kInvalidArgument, fmt::format("{}: far too large: {}", field, value));
  return static_cast<int>(value);
}

// core::check_crop makes all other checks, since it knows the image's size.
core::Result<core::PixelRect> crop_of(const v1::PixelRect& message) {
  core::PixelRect crop;
  for (const auto& [to, value] : {std::pair{&crop.x0, message.x0()},
                                  {&crop.y0, message.y0()},
                                  {&crop.x1, message.x1()},
                                  {&crop.y1, message.y1()}}) {
    const core::Result<int> number = to_int(value, "crop");
    if (!number) return fail(number.error());
    *to = *number;
  }
  return crop;
}

core::Result<core::PixelFilter> filter_of(const v1::RenderSettings& message) {
  if (message.filter() == v1::PIXEL_FILTER_UNSPECIFIED) return core::PixelFilter{};
  const core::Result<core::FilterKind> kind = from_proto(message.filter());
  if (!kind) return fail(kind.error());
  return core::PixelFilter{*kind, message.filter_radius_px()};
}

}  // namespace

v1::Integrator to_proto(core::Integrator integrator) {
  switch (integrator) {
    case core::Integrator::kNaive:
      return v1::INTEGRATOR_NAIVE;
    case core::Integrator::kNee:
      return v1::INTEGRATOR_NEE;
    case core::Integrator::kMis:
      return v1::INTEGRATOR_MIS;
    case core::Integrator::kWhitted:
      return v1::INTEGRATOR_WHITTED;
  }
  return v1::INTEGRATOR_UNSPECIFIED;
}

core::Result<core::Integrator> from_proto(v1::Integrator integrator) {
  switch (integrator) {
    case v1::INTEGRATOR_NAIVE:
      return core::Integrator::kNaive;
    case v1::INTEGRATOR_NEE:
      return core::Integrator::kNee;
    case v1::INTEGRATOR_MIS:
      return core::Integrator::kMis;
    case v1::INTEGRATOR_WHITTED:
      return core::Integrator::kWhitted;
    default:
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("integrator: must be NAIVE, NEE, MIS or WHITTED, got number {}",
                              static_cast<int>(integrator)));
  }
}

v1::Heuristic to_proto(core::Heuristic heuristic) {
  switch (heuristic) {
    case core::Heuristic::kBalance:
      return v1::HEURISTIC_BALANCE;
    case core::Heuristic::kPower:
      return v1::HEURISTIC_POWER;
  }
  return v1::HEURISTIC_UNSPECIFIED;
}

core::Result<core::Heuristic> from_proto(v1::Heuristic heuristic) {
  switch (heuristic) {
    case v1::HEURISTIC_BALANCE:
      return core::Heuristic::kBalance;
    case v1::HEURISTIC_POWER:
      return core::Heuristic::kPower;
    default:
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("heuristic: must be BALANCE or POWER, got number {}", static_cast<int>(heuristic)));
  }
}

v1::PixelFilter to_proto(core::FilterKind kind) {
  switch (kind) {
    case core::FilterKind::kBox:
      return v1::PIXEL_FILTER_BOX;
    case core::FilterKind::kTent:
      return v1::PIXEL_FILTER_TENT;
    case core::FilterKind::kGaussian:
      return v1::PIXEL_FILTER_GAUSSIAN;
  }
  return v1::PIXEL_FILTER_UNSPECIFIED;
}

core::Result<core::FilterKind> from_proto(v1::PixelFilter filter) {
  switch (filter) {
    case v1::PIXEL_FILTER_BOX:
      return core::FilterKind::kBox;
    case v1::PIXEL_FILTER_TENT:
      return core::FilterKind::kTent;
    case v1::PIXEL_FILTER_GAUSSIAN:
      return core::FilterKind::kGaussian;
    default:
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("filter: must be BOX, TENT or GAUSSIAN, got number {}", static_cast<int>(filter)));
  }
}

v1::ChannelEncoding to_proto(core::ChannelEncoding encoding) {
  switch (encoding) {
    case core::ChannelEncoding::kRadiance:
      return v1::CHANNEL_ENCODING_RADIANCE;
    case core::ChannelEncoding::kSum:
      return v1::CHANNEL_ENCODING_SUM;
    case core::ChannelEncoding::kSigned:
      return v1::CHANNEL_ENCODING_SIGNED;
    case core::ChannelEncoding::kCount:
      return v1::CHANNEL_ENCODING_COUNT;
    case core::ChannelEncoding::kNearest:
      return v1::CHANNEL_ENCODING_NEAREST;
    case core::ChannelEncoding::kIds:
      return v1::CHANNEL_ENCODING_IDS;
  }
  return v1::CHANNEL_ENCODING_UNSPECIFIED;
}

v1::RenderSettings to_proto(const core::RenderSettings& settings) {
  v1::RenderSettings message;
  message.set_width_px(static_cast<std::uint32_t>(settings.width_px));
  message.set_height_px(static_cast<std::uint32_t>(settings.height_px));
  message.set_spp(settings.spp);
  message.set_seed(settings.seed);
  message.set_integrator(to_proto(settings.integrator));
  message.set_heuristic(to_proto(settings.heuristic));
  message.set_max_depth(static_cast<std::uint32_t>(settings.max_depth));
  message.set_filter(to_proto(settings.filter.kind));
  message.set_filter_radius_px(settings.filter.radius_px);
  message.set_clamp_indirect(settings.clamp_indirect);
  if (settings.crop) *message.mutable_crop() = to_proto(*settings.crop);
  add_layers(settings.layers, *message.mutable_layers());
  return message;
}

core::Result<core::RenderSettings> from_proto(const v1::RenderSettings& message) {
  const core::Result<int> width = to_int(message.width_px(), "width");
  if (!width) return fail(width.error());
  const core::Result<int> height = to_int(message.height_px(), "height");
  if (!height) return fail(height.error());
  const core::Result<int> max_depth = to_int(message.max_depth(), "max_depth");
  if (!max_depth) return fail(max_depth.error());
  const core::Result<core::Integrator> integrator = from_proto(message.integrator());
  if (!integrator) return fail(integrator.error());
  core::RenderSettings settings{.width_px = *width,
                                .height_px = *height,
                                .spp = message.spp(),
                                .seed = message.seed(),
                                .integrator = *integrator,
                                .max_depth = *max_depth,
                                .clamp_indirect = message.clamp_indirect()};
  if (message.heuristic() != v1::HEURISTIC_UNSPECIFIED) {
    const core::Result<core::Heuristic> heuristic = from_proto(message.heuristic());
    if (!heuristic) return fail(heuristic.error());
    settings.heuristic = *heuristic;
  }
  const core::Result<core::PixelFilter> filter = filter_of(message);
  if (!filter) return fail(filter.error());
  settings.filter = *filter;
  if (message.has_crop()) {
    const core::Result<core::PixelRect> crop = crop_of(message.crop());
    if (!crop) return fail(crop.error());
    settings.crop = *crop;
  }
  const core::Result<core::LayerSet> layers = layers_from(message.layers());
  if (!layers) return fail(layers.error());
  settings.layers = *layers;
  return core::resolve_settings(settings, {});
}

core::PixelRect window_of(const v1::RenderSettings& settings) {
  const auto rect = [](std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) {
    return core::PixelRect{static_cast<int>(x0), static_cast<int>(y0), static_cast<int>(x1),
                           static_cast<int>(y1)};
  };
  const v1::PixelRect& crop = settings.crop();
  return settings.has_crop() ? rect(crop.x0(), crop.y0(), crop.x1(), crop.y1())
                             : rect(0, 0, settings.width_px(), settings.height_px());
}

v1::RenderOverrides to_proto(const core::RenderOverrides& overrides) {
  v1::RenderOverrides message;
  if (overrides.width_px) message.set_width_px(static_cast<std::uint32_t>(*overrides.width_px));
  if (overrides.height_px) message.set_height_px(static_cast<std::uint32_t>(*overrides.height_px));
  if (overrides.spp) message.set_spp(*overrides.spp);
  if (overrides.seed) message.set_seed(*overrides.seed);
  if (overrides.integrator) message.set_integrator(to_proto(*overrides.integrator));
  if (overrides.heuristic) message.set_heuristic(to_proto(*overrides.heuristic));
  if (overrides.clamp_indirect) message.set_clamp_indirect(*overrides.clamp_indirect);
  if (overrides.crop) *message.mutable_crop() = to_proto(*overrides.crop);
  if (overrides.layers) add_layers(*overrides.layers, *message.mutable_layers()->mutable_names());
  return message;
}

core::Result<core::RenderOverrides> from_proto(const v1::RenderOverrides& message) {
  core::RenderOverrides overrides;
  if (message.has_width_px()) {
    const core::Result<int> width = to_int(message.width_px(), "width");
    if (!width) return fail(width.error());
    overrides.width_px = *width;
  }
  if (message.has_height_px()) {
    const core::Result<int> height = to_int(message.height_px(), "height");
    if (!height) return fail(height.error());
    overrides.height_px = *height;
  }
  if (message.has_spp()) overrides.spp = message.spp();
  if (message.has_seed()) overrides.seed = message.seed();
  if (message.integrator() != v1::INTEGRATOR_UNSPECIFIED) {
    const core::Result<core::Integrator> integrator = from_proto(message.integrator());
    if (!integrator) return fail(integrator.error());
    overrides.integrator = *integrator;
  }
  if (message.heuristic() != v1::HEURISTIC_UNSPECIFIED) {
    const core::Result<core::Heuristic> heuristic = from_proto(message.heuristic());
    if (!heuristic) return fail(heuristic.error());
    overrides.heuristic = *heuristic;
  }
  if (message.has_clamp_indirect()) overrides.clamp_indirect = message.clamp_indirect();
  if (message.has_crop()) {
    const core::Result<core::PixelRect> crop = crop_of(message.crop());
    if (!crop) return fail(crop.error());
    overrides.crop = *crop;
  }
  if (message.has_layers()) {
    const core::Result<core::LayerSet> layers = layers_from(message.layers().names());
    if (!layers) return fail(layers.error());
    overrides.layers = *layers;
  }
  return overrides;
}

v1::FilmLayout to_proto(const core::FilmLayout& layout) {
  v1::FilmLayout message;
  for (const core::FilmChannel& each : layout.channels) {
    v1::FilmChannel& channel = *message.add_channels();
    channel.set_name(each.name);
    channel.set_encoding(to_proto(each.encoding));
  }
  return message;
}

void add_layers(const core::LayerSet& layers, google::protobuf::RepeatedPtrField<std::string>& names) {
  for (std::string& name : core::layer_names(layers)) names.Add(std::move(name));
}

core::Result<core::LayerSet> layers_from(const google::protobuf::RepeatedPtrField<std::string>& names) {
  constexpr std::size_t kMaxNames = core::kLayerCount + 1 + core::kMaxLightGroups;
  if (static_cast<std::size_t>(names.size()) > kMaxNames)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("layers: there are at most {}, got {}", kMaxNames, names.size()));
  core::LayerSet layers;
  for (const std::string& name : names) {
    const auto named = core::parse_layers(name);
    if (!named || core::layer_names(*named) != std::vector{name})
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("layers: must be of {}, or group.NAME; got '{}'",
                              fmt::join(core::layer_names(), ", "), core::printable(name)));
    layers.bits |= named->bits;
    layers.light_groups |= named->light_groups;
    for (const std::string& group : named->groups)
      if (!layers.has_group(group)) layers.groups.push_back(group);
  }
  return layers;
}

v1::PixelRect to_proto(const core::PixelRect& rect) {
  v1::PixelRect message;
  message.set_x0(static_cast<std::uint32_t>(rect.x0));
  message.set_y0(static_cast<std::uint32_t>(rect.y0));
  message.set_x1(static_cast<std::uint32_t>(rect.x1));
  message.set_y1(static_cast<std::uint32_t>(rect.y1));
  return message;
}

core::Result<core::PixelRect> from_proto(const v1::PixelRect& rect) {
  const bool valid = rect.x0() < rect.x1() && rect.y0() < rect.y1() && rect.x1() <= core::kMaxImageSidePx &&
                     rect.y1() <= core::kMaxImageSidePx;
  if (!valid)
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("rect: must hold pixels of an image of at most {} px a side, got [{}, {}) x [{}, {})",
                    core::kMaxImageSidePx, rect.x0(), rect.x1(), rect.y0(), rect.y1()));
  return core::PixelRect{static_cast<int>(rect.x0()), static_cast<int>(rect.y0()),
                         static_cast<int>(rect.x1()), static_cast<int>(rect.y1())};
}

v1::WorkItem to_proto(const WorkItem& item) {
  v1::WorkItem message;
  *message.mutable_rect() = to_proto(item.rect);
  message.set_sample_begin(item.range.begin);
  message.set_sample_end(item.range.end);
  message.set_image(item.image);
  return message;
}

core::Result<WorkItem> from_proto(const v1::WorkItem& item) {
  const core::Result<core::PixelRect> rect = from_proto(item.rect());
  if (!rect) return fail(rect.error());
  if (item.sample_begin() >= item.sample_end() || item.sample_end() > core::kMaxSpp)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("samples: must be a range of [0, {}), got [{}, {})", core::kMaxSpp,
                            item.sample_begin(), item.sample_end()));
  return WorkItem{*rect, {item.sample_begin(), item.sample_end()}, item.image()};
}

v1::Counters to_proto(const core::RenderCounters& counters) {
  v1::Counters message;
  message.set_samples(counters.samples);
  message.set_closest_hit_rays(counters.closest_hit_rays);
  message.set_shadow_rays(counters.shadow_rays);
  message.set_non_finite_samples(counters.non_finite_samples);
  message.set_saturated_samples(counters.saturated_samples);
  if (counters.first_non_finite) {
    v1::Counters::SampleId* first = message.mutable_first_non_finite();
    first->set_x(static_cast<std::uint32_t>(counters.first_non_finite->x));
    first->set_y(static_cast<std::uint32_t>(counters.first_non_finite->y));
    first->set_sample(counters.first_non_finite->sample);
  }
  return message;
}

core::RenderCounters from_proto(const v1::Counters& message) {
  core::RenderCounters counters;
  counters.samples = message.samples();
  counters.closest_hit_rays = message.closest_hit_rays();
  counters.shadow_rays = message.shadow_rays();
  counters.non_finite_samples = message.non_finite_samples();
  counters.saturated_samples = message.saturated_samples();
  if (message.has_first_non_finite()) {
    const v1::Counters::SampleId& first = message.first_non_finite();
    counters.first_non_finite =
        core::SampleId{static_cast<int>(first.x()), static_cast<int>(first.y()), first.sample()};
  }
  return counters;
}

}  // namespace tessera::proto
