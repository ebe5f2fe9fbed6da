// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/admission.hpp"

#include <fmt/format.h>

#include <string>

#include "proto/convert.hpp"

namespace tessera::jobs {

core::Status check_image_size(const v1::RenderSettings& settings, const server::Limits& limits) {
  const core::PixelRect window = proto::window_of(settings);
  if (window.pixel_count() <= limits.image_pixels) return {};
  return core::fail(server::over_limit(
      fmt::format("the image has {} x {} = {} pixels", window.width(), window.height(), window.pixel_count()),
      std::to_string(limits.image_pixels), "--max-image-pixels"));
}

core::Status check_image_count(std::uint64_t images, const server::Limits& limits) {
  if (images <= limits.images) return {};
  return core::fail(server::over_limit(fmt::format("the job has {} images", images),
                                       std::to_string(limits.images), "--max-images"));
}

core::Status check_film_memory(const scheduler::JobShape& shape, const film::FilmMemory& memory) {
  const core::TileGrid grid = shape.grid().of_image();
  const std::uint64_t tiles =
      static_cast<std::uint64_t>(grid.tile_count()) * static_cast<std::uint64_t>(shape.images);
  if (tiles <= scheduler::kMaxTilesPerJob && memory.has_room_for(tiles)) return {};
  const std::string images =
      shape.images == 1 ? "this one" : fmt::format("this one with {} images", shape.images);
  return core::fail(server::over_limit(
      fmt::format("the unfinished jobs and {} of {} x {} pixels have too many tiles together", images,
                  grid.width(), grid.height()),
      fmt::format("{:.1f} GiB of films", static_cast<double>(memory.budget_bytes()) / (1 << 30)),
      "--max-film-gib"));
}

core::Status check_spp(std::uint32_t spp, const server::Limits& limits) {
  if (spp <= limits.spp) return {};
  return core::fail(server::over_limit(fmt::format("the job has {} samples per pixel", spp),
                                       std::to_string(limits.spp), "--max-spp"));
}

}  // namespace tessera::jobs
