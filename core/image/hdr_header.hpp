// SPDX-License-Identifier: Apache-2.0
// The header of Radiance HDR files (Ward, "Real Pixels", Graphics Gems II, 1991). Stateless; thread-safe.
#pragma once

#include <cstddef>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::core {

struct HdrHeader {
  int width = 0, height = 0;
  // Lines of the file are rows of pixels, or columns if `is_by_columns`; from_bottom and from_right give
  // their start.
  bool is_by_columns = false, from_bottom = false, from_right = false;
  bool is_xyz = false;
  double exposure = 1;  // the product of all EXPOSURE lines; values are divided by it
  bool has_primaries = false, has_color_correction = false;
  std::size_t pixel_offset = 0;
};

// Lines may end with LF or CR LF. Errors complete a sentence, as in "it has no line that tells its size".
Result<HdrHeader> parse_hdr_header(std::string_view bytes);

}  // namespace tessera::core
