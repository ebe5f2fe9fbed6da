// SPDX-License-Identifier: Apache-2.0
// Which image and channels of a job a caller asks for. Pure functions; errors are INVALID_ARGUMENT.
#pragma once

#include <google/protobuf/repeated_ptr_field.h>

#include <cstdint>
#include <string>

#include "core/base/error.hpp"
#include "server/scheduler/job_shape.hpp"

namespace tessera::jobs {

// Whether the job has an image of this index.
core::Status check_image(const scheduler::JobShape& shape, std::uint32_t image);
// Whether these are the channels of the layout that this release knows, in its order; none: all.
core::Status check_channels(const google::protobuf::RepeatedPtrField<std::string>& channels);

}  // namespace tessera::jobs
