// SPDX-License-Identifier: Apache-2.0
#include "client/page/progress_lines.hpp"

#include <cstdint>
#include <nlohmann/json.hpp>

#include "client/console.hpp"

namespace tessera::client {
namespace {

constexpr std::chrono::seconds kBetweenLines{1};

}  // namespace

void ProgressLines::print() {
  printed_at_ = Clock::now();
  print_result(job_.header().json + "\n");
}

void ProgressLines::begin(const core::Film& film, const core::RenderSettings&) {
  job_.begin(film);
  print();
}

void ProgressLines::samples_added(const core::PixelRect& rect, const core::SampleRange& range) {
  job_.add(std::uint64_t{rect.pixel_count()} * range.count());
  if (Clock::now() >= printed_at_ + kBetweenLines) print();
}

void ProgressLines::finish(const std::vector<std::string>& written) {
  using Json = nlohmann::ordered_json;
  Json json = Json::parse(job_.header().json);
  json["written"] = written;
  print_result(json.dump(-1, ' ', true, Json::error_handler_t::replace) + "\n");
}

}  // namespace tessera::client
