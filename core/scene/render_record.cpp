// SPDX-License-Identifier: Apache-2.0
#include "core/scene/render_record.hpp"

#include <fmt/format.h>

namespace tessera::core {

std::string settings_text(const RenderRecord& record) {
  const RenderSettings& s = record.settings;
  const PixelRect window = s.window();
  std::string json = fmt::format("{{\"width\":{},\"height\":{},\"crop\":[{},{},{},{}]", s.width_px,
                                 s.height_px, window.x0, window.y0, window.x1, window.y1);
  json += fmt::format(",\"spp\":{},\"seed\":{},\"integrator\":\"{}\",\"heuristic\":\"{}\"", s.spp, s.seed,
                      integrator_name(s.integrator), heuristic_name(s.heuristic));
  json += fmt::format(",\"max_depth\":{},\"clamp_indirect\":{},\"filter\":\"{}\",\"filter_radius\":{}",
                      s.max_depth, s.clamp_indirect, filter_name(s.filter.kind), s.filter.radius_px);
  return json + fmt::format(",\"layers\":\"{}\",\"frame\":{},\"complete\":{}}}", layers_text(s.layers),
                            record.frame, record.complete);
}

TextAttributes attributes_of(const RenderRecord& record) {
  return {{"tessera/version", record.version},
          {"tessera/fingerprint", record.fingerprint},
          {"tessera/scene", record.scene},
          {"tessera/settings", settings_text(record)}};
}

}  // namespace tessera::core
