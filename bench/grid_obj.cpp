// SPDX-License-Identifier: Apache-2.0
#include "bench/grid_obj.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace tessera::bench {
namespace {

void add_vertices(std::string& text, int side, GridData data) {
  auto out = std::back_inserter(text);
  for (int i = 0; i <= side; ++i)
    for (int j = 0; j <= side; ++j) {
      const double x = i / static_cast<double>(side), y = j / static_cast<double>(side);
      const double height = 0.05 * std::sin(40 * x) * std::sin(50 * y);
      fmt::format_to(out, "v {:.6f} {:.6f} {:.6f}\n", 10 * x - 5, height, 10 * y - 5);
      if (data == GridData::kPositions) continue;
      const double slope_x = -0.2 * std::cos(40 * x) * std::sin(50 * y);
      const double slope_y = -0.25 * std::sin(40 * x) * std::cos(50 * y);
      const double length = std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);
      fmt::format_to(out, "vt {:.6f} {:.6f}\nvn {:.4f} {:.4f} {:.4f}\n", x, y, slope_x / length, 1 / length,
                     slope_y / length);
    }
}

void add_triangle(std::string& text, int a, int b, int c, GridData data) {
  auto out = std::back_inserter(text);
  if (data == GridData::kPositions) {
    fmt::format_to(out, "f {} {} {}\n", a, b, c);
  } else {
    fmt::format_to(out, "f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", a, b, c);
  }
}

}  // namespace

std::string grid_obj(int triangles, GridData data) {
  const int side = static_cast<int>(std::ceil(std::sqrt(triangles / 2.0)));
  std::string text = "# A bumpy sheet\no sheet\n";
  add_vertices(text, side, data);
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const int a = i * (side + 1) + j + 1, b = a + side + 1;
      add_triangle(text, a, a + 1, b + 1, data);
      add_triangle(text, a, b + 1, b, data);
    }
  text.shrink_to_fit();
  return text;
}

}  // namespace tessera::bench
