// SPDX-License-Identifier: Apache-2.0
// Reads how an image was made from the header of its OpenEXR file (core/scene/render_record.hpp). Stateless.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/scene/render_record.hpp"

namespace tessera::client {

// FAILED_PRECONDITION: the file does not say it. INVALID_ARGUMENT: it is broken, no OpenEXR file, or says
// what no render has. Messages name the file.
core::Result<core::RenderRecord> read_image_record(const std::string& path);

// The same for the bytes of a file; messages complete a sentence that begins with its name.
core::Result<core::RenderRecord> image_record_of(std::string_view bytes);

}  // namespace tessera::client
