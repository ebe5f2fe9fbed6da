// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>

#include "client/render_checkpoint.hpp"
#include "core/base/determinism_fingerprint.hpp"
#include "core/base/printable.hpp"
#include "core/base/version.hpp"

namespace tessera::client {
namespace {

constexpr std::size_t kMaxVersion = 100;

std::string crop_text(const std::optional<core::PixelRect>& crop) {
  return crop ? fmt::format("{},{},{},{}", crop->x0, crop->y0, crop->x1, crop->y1) : "the whole image";
}

std::string filter_text(const core::PixelFilter& filter) {
  return fmt::format("{} with a radius of {} pixels", core::filter_name(filter.kind), filter.radius_px);
}

template <typename T>
std::string differ(std::string_view name, const T& of_file, const T& of_render) {
  return of_file == of_render ? "" : fmt::format("its {} is {}, and not {}", name, of_file, of_render);
}

std::string difference(const core::RenderSettings& a, const core::RenderSettings& b) {
  const auto size = [](const core::RenderSettings& settings) {
    return fmt::format("{}x{}", settings.width_px, settings.height_px);
  };
  for (const std::string& what :
       {differ("size", size(a), size(b)), differ("crop", crop_text(a.crop), crop_text(b.crop)),
        differ("seed", a.seed, b.seed),
        differ("integrator", core::integrator_name(a.integrator), core::integrator_name(b.integrator)),
        differ("heuristic", core::heuristic_name(a.heuristic), core::heuristic_name(b.heuristic)),
        differ("max_depth", a.max_depth, b.max_depth),
        differ("clamp_indirect", a.clamp_indirect, b.clamp_indirect),
        differ("filter", filter_text(a.filter), filter_text(b.filter)),
        differ("set of layers", core::layers_text(a.layers), core::layers_text(b.layers))})
    if (!what.empty()) return what;
  return "";
}

std::string difference(const core::SceneDigest& a, const core::SceneDigest& b) {
  using Part = core::Checksum core::SceneDigest::*;
  constexpr std::array<std::pair<Part, std::string_view>, 6> kParts{
      {{&core::SceneDigest::camera, "the camera of the scene differs"},
       {&core::SceneDigest::shapes, "the shapes of the scene differ"},
       {&core::SceneDigest::materials, "the materials of the scene differ"},
       {&core::SceneDigest::textures, "the textures of the scene differ"},
       {&core::SceneDigest::lights, "the lights of the scene differ"},
       {&core::SceneDigest::environment, "the environment of the scene differs"}}};
  for (const auto& [part, what] : kParts)
    if (a.*part != b.*part) return std::string(what);
  return "";
}

}  // namespace

RenderIdentity identity_of(const core::RenderSettings& settings, const core::SceneDigest& scene) {
  return {std::string(core::version()), std::string(core::kDeterminismFingerprint), settings, scene};
}

std::string difference(const RenderIdentity& of_file, const RenderIdentity& of_render) {
  if (of_file.determinism_fingerprint != of_render.determinism_fingerprint)
    return fmt::format("it was written by Tessera {}, whose images are not bit-compatible with those of {}",
                       core::printable(of_file.version.substr(0, kMaxVersion)), of_render.version);
  const std::string settings = difference(of_file.settings, of_render.settings);
  return settings.empty() ? difference(of_file.scene, of_render.scene) : settings;
}

}  // namespace tessera::client
