// SPDX-License-Identifier: Apache-2.0
// Reads grids and media of a scene file.
#include <fmt/format.h>

#include <algorithm>

#include "core/scene/loader/scene_file.hpp"
#include "core/scene/loader/table_reader.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/tables/medium_tables.hpp"

namespace tessera::core {
namespace {

// The index of the named entry; -1 after a mistake.
template <typename Entry>
int index_of_name(const Field& field, const std::vector<Entry>& entries, std::string_view kind) {
  const std::string name = read_text(field);
  const auto found =
      std::find_if(entries.begin(), entries.end(), [&](const auto& e) { return e.name == name; });
  if (found != entries.end()) return static_cast<int>(found - entries.begin());
  std::vector<std::string_view> known;
  for (const auto& entry : entries) known.push_back(entry.name);
  if (!name.empty())
    field.mistake(fmt::format("there is no {} {}{}", kind, in_quotes(name), suggestion(name, known)));
  return -1;
}

Transform read_grid_transform(const Field& field) {
  const TransformEntry entry = read_transform(field);
  if (!entry.motion.empty()) field.mistake("the transform of a medium's grids cannot be animated");
  return entry.transform;
}

MediumDescription read_medium(const Field& field, const std::string& name,
                              const std::vector<GridEntry>& grids, ParameterTracks& tracks) {
  const KnownNames names{.grids = &grids};
  const TableReader read(field, "medium", rules_of(kKeys<MediumDescription>), names);
  MediumDescription medium;
  medium.name = name;
  read.read(kKeys<MediumDescription>, medium, tracks);
  const auto transform = read.find("transform");
  if (transform) medium.grid_to_world = read_grid_transform(*transform);
  const bool names_grid =
      read.find("absorption_grid") || read.find("scattering_grid") || read.find("emission_grid");
  if (transform && !names_grid)
    transform->mistake("a medium without grids has no place of its own; leave this out");
  return medium;
}

}  // namespace

std::vector<GridEntry> read_grids(const Field& field) {
  std::vector<GridEntry> grids;
  for (const auto& [name, entry] : read_named(field)) {
    const ObjectReader object(entry, scene_keys::kGrid);
    GridEntry grid;
    grid.name = name;
    if (const auto file = object.find("file")) {
      grid.file = read_text(*file);
      grid.file_place = file->place();
    }
    grid.filter = read_or(object, "filter", grid.filter, read_choice,
                          std::span<const std::string_view>(scene_keys::kGridFilters));
    grid.border = read_or(object, "border", grid.border, read_choice,
                          std::span<const std::string_view>(scene_keys::kGridBorders));
    grids.push_back(std::move(grid));
  }
  return grids;
}

std::vector<MediumDescription> read_media(const Field& field, const std::vector<GridEntry>& grids,
                                          std::vector<IndexedTracks>& animations) {
  std::vector<MediumDescription> media;
  for (const auto& [name, entry] : read_named(field)) {
    IndexedTracks animation{.index = static_cast<std::uint32_t>(media.size()), .tracks = {}};
    media.push_back(read_medium(entry, name, grids, animation.tracks));
    if (!animation.tracks.empty()) animations.push_back(std::move(animation));
  }
  return media;
}

int read_grid_name(const Field& field, const std::vector<GridEntry>& grids) {
  return index_of_name(field, grids, "grid");
}

int read_medium_name(const Field& field, const std::vector<MediumDescription>& media) {
  return index_of_name(field, media, "medium");
}

}  // namespace tessera::core
