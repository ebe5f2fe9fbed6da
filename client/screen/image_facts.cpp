// SPDX-License-Identifier: Apache-2.0
#include "client/screen/image_facts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tessera::client {
namespace {

using Json = nlohmann::ordered_json;

struct ChannelFacts {
  double minimum = std::numeric_limits<double>::infinity(), sum = 0;
  double maximum = -std::numeric_limits<double>::infinity();

  void add(float value) {
    minimum = std::min(minimum, static_cast<double>(value));
    maximum = std::max(maximum, static_cast<double>(value));
    sum += static_cast<double>(value);
  }
};

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace

Json image_facts(const std::string& name, const core::Image& image) {
  std::array<ChannelFacts, 3> channels;
  for (const core::Rgb& pixel : image.pixels) {
    channels[0].add(pixel.r);
    channels[1].add(pixel.g);
    channels[2].add(pixel.b);
  }
  Json facts = {{"image", name}, {"width", image.width}, {"height", image.height}};
  for (const char* list : {"minimum", "mean", "maximum"}) facts[list] = Json::array();
  for (const ChannelFacts& each : channels) {
    facts["minimum"].push_back(number(each.minimum));
    facts["mean"].push_back(number(each.sum / static_cast<double>(image.pixels.size())));
    facts["maximum"].push_back(number(each.maximum));
  }
  return facts;
}

}  // namespace tessera::client
