// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/image_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/film/layout.hpp"
#include "proto/error_reasons.hpp"

namespace tessera::jobs {

namespace {

core::Status invalid(const char* field, std::string sentence) {
  const core::Error error{core::ErrorCode::kInvalidArgument, std::move(sentence)};
  return core::fail(error.with({.reason = proto::kInvalidField, .field = field}));
}

}  // namespace

core::Status check_image(const scheduler::JobShape& shape, std::uint32_t image) {
  if (image < static_cast<std::uint32_t>(shape.images)) return {};
  return invalid("image", fmt::format("image: must be below {}, the number of the job's images, got {}",
                                      shape.images, image));
}

core::Status check_channels(const google::protobuf::RepeatedPtrField<std::string>& channels) {
  const auto& known = core::rgb_layout().channels;
  const bool is_layout =
      std::equal(channels.begin(), channels.end(), known.begin(), known.end(),
                 [](const std::string& name, const core::FilmChannel& each) { return name == each.name; });
  if (channels.empty() || is_layout) return {};
  std::vector<std::string_view> names;
  for (const core::FilmChannel& each : known) names.push_back(each.name);
  return invalid("channels", fmt::format("channels: must be {} in this order, or none, which means the same",
                                         fmt::join(names, ", ")));
}

}  // namespace tessera::jobs
