// SPDX-License-Identifier: Apache-2.0
#include "client/screen/screen_image.hpp"

#include <algorithm>
#include <cmath>

#include "core/image/srgb.hpp"

namespace tessera::client {
namespace {

// The pixels [begin, end) of a row or column of `from` pixels that fall on pixel `i` of `to`.
struct Span {
  int begin, end;
};
Span covered(int i, int from, int to) {
  const auto edge = [&](int j) { return static_cast<int>(std::int64_t{j} * from / to); };
  return {edge(i), std::max(edge(i) + 1, edge(i + 1))};
}

core::Rgb mean(const core::Image& image, Span xs, Span ys) {
  double r = 0, g = 0, b = 0;
  for (int y = ys.begin; y < ys.end; ++y) {
    for (int x = xs.begin; x < xs.end; ++x) {
      const core::Rgb& pixel = image.at(x, y);
      r += pixel.r;
      g += pixel.g;
      b += pixel.b;
    }
  }
  const double count = static_cast<double>(xs.end - xs.begin) * (ys.end - ys.begin);
  return {static_cast<float>(r / count), static_cast<float>(g / count), static_cast<float>(b / count)};
}

}  // namespace

ScreenImage fit_to_screen(const core::Image& image, int max_width, int max_height,
                          const core::DisplaySettings& display) {
  const double scale = std::min({1.0, static_cast<double>(std::max(1, max_width)) / image.width,
                                 static_cast<double>(std::max(1, max_height)) / image.height});
  ScreenImage screen{.width = std::max(1, static_cast<int>(std::floor(image.width * scale + 1e-9))),
                     .height = std::max(1, static_cast<int>(std::floor(image.height * scale + 1e-9))),
                     .rgb = {}};
  const core::DisplayTransform transform(display);
  screen.rgb.reserve(3 * static_cast<std::size_t>(screen.width) * static_cast<std::size_t>(screen.height));
  for (int y = 0; y < screen.height; ++y) {
    const Span ys = covered(y, image.height, screen.height);
    for (int x = 0; x < screen.width; ++x) {
      const core::Rgb light = transform(mean(image, covered(x, image.width, screen.width), ys));
      for (const float channel : {light.r, light.g, light.b})
        screen.rgb.push_back(core::srgb_encode(channel));
    }
  }
  return screen;
}

}  // namespace tessera::client
