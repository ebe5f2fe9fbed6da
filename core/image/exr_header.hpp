// SPDX-License-Identifier: Apache-2.0
// Validates the header of an OpenEXR file before OpenEXR allocates memory for what it claims. Stateless;
// thread-safe.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/image/codec.hpp"

namespace tessera::core {

enum class ExrStructure { kFlat, kDeep, kSeveralParts };
ExrStructure exr_structure(std::string_view bytes);

struct ExrHeader {
  // A replacement for the file's header, from the first byte on, to be passed to OpenEXR. Attributes that
  // are not needed are made opaque, so that OpenEXR does not interpret them.
  std::string bytes;
  ImageSize size;  // of the data window
  // Those that the file names, if they are not those of Rec. 709, which a file without them has.
  std::optional<PrimaryCoordinates> primaries{};
};

// Errors: an attribute exceeds the file or has the wrong type, the image or its tiles are larger than the
// file can hold. The file must be flat.
Result<ExrHeader> checked_exr_header(std::string_view bytes);

// The texts in the header by their names. Errors: it is no OpenEXR file, or an attribute exceeds it.
Result<std::map<std::string, std::string>> exr_texts(std::string_view bytes);

}  // namespace tessera::core
