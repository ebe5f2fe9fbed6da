// SPDX-License-Identifier: Apache-2.0
// The part of a terminal in which an image is shown, and drawn again as it changes. Not thread-safe.
#pragma once

#include <optional>
#include <string>

#include "client/screen/graphics.hpp"
#include "core/base/error.hpp"
#include "core/image/display.hpp"
#include "core/image/image.hpp"

namespace tessera::client {

// The size of a terminal, in cells, and of a cell in pixels.
struct ScreenSize {
  int columns = 80, rows = 24;
  int cell_width = 8, cell_height = 16;
};

// What the environment and the answer to a query of the device attributes (DA1: "\033[?62;4c") say of a
// terminal.
Graphics graphics_of(const std::string& term, const std::string& term_program, bool is_multiplexed,
                     const std::string& device_attributes);

class Screen {
 public:
  // `graphics`: empty to ask the terminal, for at most a moment. FAILED_PRECONDITION: stdout is no terminal,
  // and no graphics are chosen.
  static core::Result<Screen> open(std::optional<Graphics> graphics);
  Screen(ScreenSize size, Graphics graphics) : size_(size), graphics_(graphics) {}

  // Shows the image, and a line of text below it, in the place of the image before. `is_live`: more will
  // follow, so the cursor is hidden.
  core::Status show(const core::Image& image, const core::DisplaySettings& display,
                    const std::string& caption, bool is_live);
  // Shows the cursor, below the image. Without effect if nothing was shown.
  void close();

 private:
  int rows_of(const ScreenImage& image) const;
  std::string begin_frame(int rows);

  ScreenSize size_;
  Graphics graphics_;
  int rows_ = 0;  // that are reserved, without the caption
};

}  // namespace tessera::client
