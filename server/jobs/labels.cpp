// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/labels.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "proto/text.hpp"

namespace tessera::jobs {

core::Status check_labels(const Labels& labels) {
  if (labels.size() > kMaxLabels)
    return core::fail(proto::invalid_field(
        "labels", fmt::format("there may be at most {}, got {}", kMaxLabels, labels.size())));
  for (const auto& [key, value] : labels) {
    if (key.empty()) return core::fail(proto::invalid_field("labels", "a key is empty"));
    if (auto fit = proto::check_text("labels", key, kMaxLabelKeyBytes); !fit) return fit;
    if (auto fit = proto::check_text("labels", value, kMaxLabelValueBytes); !fit) return fit;
  }
  return {};
}

bool has_labels(const v1::Job& job, const Labels& wanted) {
  return std::all_of(wanted.begin(), wanted.end(), [&](const auto& label) {
    const auto found = job.labels().find(label.first);
    return found != job.labels().end() && found->second == label.second;
  });
}

}  // namespace tessera::jobs
