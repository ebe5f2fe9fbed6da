// The header of an OpenEXR file, looked at before OpenEXR takes memory for what it claims. Stateless;
// thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::core {

// The header's bytes, from the file's first one on, as OpenEXR may read them in place of the file's own: what
// is of no use here is made opaque, so that nothing of it is taken at its word. Errors: an attribute reaches
// beyond the file or is not of its type, the picture or its tiles are larger than the file can hold, or it is
// of several parts or deep.
Result<std::string> checked_exr_header(std::string_view bytes);

}  // namespace tessera::core
