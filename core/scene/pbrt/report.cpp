// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/report.hpp"

#include <fmt/format.h>

#include "core/scene/loader/wording.hpp"

namespace tessera::core::pbrt {

void Report::tell(const Parameters& parameters, std::string_view owner) const {
  for (const Parameter* parameter : parameters.unused()) {
    const std::string text = fmt::format("the parameter {} of {} is not supported; it is ignored",
                                         in_quotes(parameter->name), owner);
    warn({parameters.place().file, parameter->line}, text, text);
  }
  for (const Parameters::Remark& remark : parameters.remarks()) {
    const std::string subject = fmt::format("the parameter {} of {}", in_quotes(remark.name), owner);
    warn({parameters.place().file, remark.line}, fmt::format("{} {}", subject, remark.kind),
         fmt::format("{} {}", subject, remark.text));
  }
}

tl::unexpected<Error> Report::error(const Place& place, std::string_view text) const {
  return mistake(fmt::format("{}:{}: {}", builder_.shown(*place.file), place.line, text));
}

}  // namespace tessera::core::pbrt
