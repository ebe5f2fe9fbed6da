// SPDX-License-Identifier: Apache-2.0
// Admission control: checks jobs against the limits on images. Stateless; thread-safe. Errors are
// RESOURCE_EXHAUSTED and name the option that raises the limit.
#pragma once

#include <cstdint>

#include "core/base/error.hpp"
#include "server/film/film_memory.hpp"
#include "server/limits.hpp"
#include "server/scheduler/job_shape.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::jobs {

// Counts the pixels of the window that is rendered, not of the whole image.
core::Status check_image_size(const v1::RenderSettings& settings, const server::Limits& limits);
// Whether there may be so many images in a job.
core::Status check_image_count(std::uint64_t images, const server::Limits& limits);
// Whether the memory of films has room for the tiles of all images of another job.
core::Status check_film_memory(const scheduler::JobShape& shape, const film::FilmMemory& memory);
core::Status check_spp(std::uint32_t spp, const server::Limits& limits);

}  // namespace tessera::jobs
