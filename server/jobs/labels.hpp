// SPDX-License-Identifier: Apache-2.0
// The labels of jobs: pairs of texts that users set, to find jobs by. Pure functions.
#pragma once

#include <cstddef>
#include <string>

#include "core/base/error.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::jobs {

using Labels = google::protobuf::Map<std::string, std::string>;

inline constexpr std::size_t kMaxLabels = 32;
inline constexpr std::size_t kMaxLabelKeyBytes = 63;
inline constexpr std::size_t kMaxLabelValueBytes = 255;

// INVALID_ARGUMENT if there are too many, or one is too long, has an empty key, or cannot be shown.
core::Status check_labels(const Labels& labels);
// Whether the job has all of these labels, with these values.
bool has_labels(const v1::Job& job, const Labels& wanted);

}  // namespace tessera::jobs
