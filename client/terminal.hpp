// SPDX-License-Identifier: Apache-2.0
// What the terminal behind stdout can show. Stateless.
#pragma once

#include <optional>
#include <string_view>

namespace tessera::client {

// How text is laid out. The default is that of files and pipes.
struct TextStyle {
  std::optional<int> columns{};  // of the terminal; empty: lines may be of any length
  bool colored = false;
};

// Colours are off if NO_COLOR is set and not empty (no-color.org), and on terminals that are dumb.
TextStyle stdout_style();

enum class Color { kNone, kRed, kGreen, kYellow, kCyan, kDim };

// The escape sequence that begins the colour, and the one that ends every colour.
std::string_view begin_color(Color color);
std::string_view end_color();

}  // namespace tessera::client
