// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/report.hpp"

#include <fmt/format.h>

#include "core/scene/loader/wording.hpp"

namespace tessera::core::pbrt {

void Report::tell(const Parameters& parameters, std::string_view owner) const {
  for (const Parameter* parameter : parameters.unused()) {
    const std::string text =
        fmt::format("the parameter {} of {} {}", in_quotes(parameter->name), owner,
                    parameters.is_repeated(*parameter) ? "is given again; the last one counts"
                                                       : "is not supported; it is ignored");
    warn(parameter->place, text, text);
  }
  for (const Parameters::Remark& remark : parameters.remarks()) {
    const std::string subject = fmt::format("the parameter {} of {}", in_quotes(remark.name), owner);
    warn(remark.place, fmt::format("{} {}", subject, remark.kind),
         fmt::format("{} {}", subject, remark.text));
  }
}

std::string Report::shown(const Place& place) const {
  return fmt::format("{}:{}", builder_.shown(*place.file), place.line);
}

tl::unexpected<Error> Report::error(const Place& place, std::string_view text) const {
  return mistake(fmt::format("{}: {}", shown(place), text));
}

}  // namespace tessera::core::pbrt
