// SPDX-License-Identifier: Apache-2.0
// The header of an OpenEXR file, looked at before OpenEXR takes memory for what it claims. Stateless;
// thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/image/codec.hpp"

namespace tessera::core {

struct ExrHeader {
  // The header from the file's first byte on, as OpenEXR may read it in place of the file's own. Attributes
  // that are of no use here are made opaque, so that OpenEXR does not interpret them.
  std::string bytes;
  ImageSize size;  // of the data window
};

// Errors: an attribute reaches beyond the file or is not of its type, the image or its tiles are larger than
// the file can hold, or it is of several parts or deep.
Result<ExrHeader> checked_exr_header(std::string_view bytes);

}  // namespace tessera::core
