// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/realistic_lens.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/files.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr double kFarMm = 1e9;

// The surfaces in the lens file, with the stop as it is set; a thin lens of 50 mm if it cannot be read.
LensSystem lens_of(const Parameters& p, SceneBuilder& builder, const Report& report) {
  const std::string file = p.file_name("lensfile");
  const Place place = p.place_of(p.find("lensfile"));
  const auto path = file.empty() || !place.file ? std::nullopt : find_file(builder, place, file);
  const auto text = path ? builder.read(*path) : Result<std::string>(std::string());
  LensSystem lens = text ? parse_lens(*text) : LensSystem{};
  if (lens.empty() || !focused(lens, kFarMm)) {
    report.warn(place, fmt::format("the lens {} cannot be read; a lens of 50 mm is used", in_quotes(file)));
    lens = {{50, 0, 1.5, 50}, {-50, 0, 1, 50}, {0, 50, 1, 50}};
  }
  const double stop_mm = static_cast<double>(p.positive("aperturediameter").value_or(1));
  for (LensSurface& surface : lens) {
    if (surface.radius != 0) continue;
    if (stop_mm > surface.diameter)
      p.remark("aperturediameter", fmt::format("is limited to that of the lens, {:g}", surface.diameter));
    surface.diameter = std::min(surface.diameter, stop_mm);
  }
  return lens;
}

}  // namespace

FocusedLens realistic_lens(const Parameters& p, SceneBuilder& builder, const Report& report) {
  report.warn(p.place(),
              "the camera 'realistic' is approximated by a perspective camera with a thin lens: without "
              "distortion, vignetting and the shape of the aperture");
  p.find("aperture");
  const LensSystem lens = lens_of(p, builder, report);
  const double distance_mm = static_cast<double>(p.positive("focusdistance").value_or(10)) / kMetresPerMm;
  if (const auto made = focused(lens, distance_mm)) return *made;
  p.remark("focusdistance", "is too short for this lens, which is focused at infinity");
  return focused(lens, kFarMm).value_or(FocusedLens{});
}

}  // namespace tessera::core::pbrt
