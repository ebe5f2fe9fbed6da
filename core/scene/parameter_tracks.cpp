// SPDX-License-Identifier: Apache-2.0
#include "core/scene/parameter_tracks.hpp"

#include <concepts>
#include <type_traits>

#include "core/scene/description.hpp"
#include "core/scene/tables/light_tables.hpp"
#include "core/scene/tables/material_tables.hpp"
#include "core/scene/tables/medium_tables.hpp"

namespace tessera::core {
namespace {

float extreme(float a, float b, bool greatest) {
  return (a < b) == greatest ? b : a;
}
Rgb extreme(Rgb a, Rgb b, bool greatest) {
  return {extreme(a.r, b.r, greatest), extreme(a.g, b.g, greatest), extreme(a.b, b.b, greatest)};
}

const Track<float>* track_for(const ParameterTracks& tracks, std::string_view key, float) {
  return tracks.number(key);
}
const Track<Rgb>* track_for(const ParameterTracks& tracks, std::string_view key, Rgb) {
  return tracks.color(key);
}

// Calls visit(value, track) for each number and colour that has keyframes. Of a parameter or map with a
// texture, it is the factor.
template <typename Visit>
class AnimatedVisitor {
 public:
  AnimatedVisitor(const ParameterTracks& tracks, const Visit& visit) : tracks_(tracks), visit_(visit) {}

  template <typename KeyType, typename Value>
  void operator()(const KeyType& key, Value& value) const {
    visit_value(key.name, value);
  }

 private:
  template <typename Value>
  void visit_value(std::string_view key, Value& value) const {
    if constexpr (std::same_as<Value, float> || std::same_as<Value, Rgb>) {
      if (const auto* track = track_for(tracks_, key, value)) visit_(value, *track);
    } else if constexpr (std::same_as<Value, ColorParameter> || std::same_as<Value, ScalarParameter>) {
      visit_value(key, value.value);
    } else if constexpr (HasTable<Value>) {
      visit_members(kKeys<Value>, value, [&](const auto&, auto& member) { visit_value(key, member); });
    }
  }

  const ParameterTracks& tracks_;
  const Visit& visit_;
};

template <typename Visit>
void visit_animated(Material& material, const ParameterTracks& tracks, const Visit& visit) {
  visit_keys(material, AnimatedVisitor(tracks, visit));
}
template <typename Owner, typename Visit>
void visit_animated(Owner& owner, const ParameterTracks& tracks, const Visit& visit) {
  visit_members(kKeys<Owner>, owner, AnimatedVisitor(tracks, visit));
}

template <typename Values>
Values animated_values(Values values, const ParameterTracks& tracks, float frame) {
  visit_animated(values, tracks,
                 [&](auto& value, const auto& track) { value = value_at(track, frame, value); });
  return values;
}

template <typename Values>
Values widest_values(Values values, const ParameterTracks& tracks, bool greatest) {
  visit_animated(values, tracks, [&](auto& value, const auto& track) {
    for (const auto& each : track.values) value = extreme(value, each, greatest);
  });
  return values;
}

}  // namespace

Material values_at(const Material& material, const ParameterTracks& tracks, float frame) {
  return animated_values(material, tracks, frame);
}
MediumDescription values_at(const MediumDescription& medium, const ParameterTracks& tracks, float frame) {
  return animated_values(medium, tracks, frame);
}
EnvironmentDescription values_at(const EnvironmentDescription& environment, const ParameterTracks& tracks,
                                 float frame) {
  return animated_values(environment, tracks, frame);
}

Material extreme_values(const Material& material, const ParameterTracks& tracks, bool greatest) {
  return widest_values(material, tracks, greatest);
}
MediumDescription extreme_values(const MediumDescription& medium, const ParameterTracks& tracks,
                                 bool greatest) {
  return widest_values(medium, tracks, greatest);
}
EnvironmentDescription extreme_values(const EnvironmentDescription& environment,
                                      const ParameterTracks& tracks, bool greatest) {
  return widest_values(environment, tracks, greatest);
}

}  // namespace tessera::core
