// SPDX-License-Identifier: Apache-2.0
// Renders SPP samples of each pixel of a small image in one call on one thread, for tests/counters and for
// recording compiler profiles (record_profile.sh). `tessera render` divides its work by the clock, so its
// work varies between runs.
#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string_view>
#include <system_error>

#include "core/base/error.hpp"
#include "core/film/film.hpp"
#include "core/integrators/render.hpp"
#include "core/scene/loader/loader.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {
namespace {

std::optional<int> count_from(std::string_view text) {
  int count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc{} || end != text.data() + text.size() || count < 1) return std::nullopt;
  return count;
}

Status render_samples(const char* path, int side_px, int spp) {
  auto description = load_scene_file(path);
  if (!description) return fail(description.error());
  description->settings.width_px = description->settings.height_px = side_px;
  const auto scene = Scene::build(*std::move(description), 1);
  if (!scene) return fail(scene.error());
  const SampleRange samples{0, static_cast<std::uint32_t>(spp)};
  const FilmTile tile =
      render(integrators::prepare(*scene, scene->settings(), 1), {0, 0, side_px, side_px}, samples, 1);
  fmt::print("{} samples\n", tile.counters.samples);
  return {};
}

}  // namespace
}  // namespace tessera::core

int main(int argc, char** argv) {
  const auto side_px = argc == 4 ? tessera::core::count_from(argv[2]) : std::nullopt;
  const auto spp = argc == 4 ? tessera::core::count_from(argv[3]) : std::nullopt;
  if (!side_px || !spp) {
    fmt::print(stderr, "render_samples: usage: render_samples SCENE SIDE_PX SPP, both at least 1\n");
    return 2;
  }
  const auto done = tessera::core::render_samples(argv[1], *side_px, *spp);
  if (done) return 0;
  fmt::print(stderr, "render_samples: {}\n", done.error().message);
  return 1;
}
