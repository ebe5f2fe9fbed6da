// SPDX-License-Identifier: Apache-2.0
// The files of the page, as the build has embedded them.
#pragma once

#include <cstddef>
#include <span>

namespace tessera::view {

struct EmbeddedFile {
  const char* name;
  const char* etag;  // without quotation marks
  const unsigned char* gzip;
  std::size_t gzip_bytes;
};

std::span<const EmbeddedFile> embedded_files();

}  // namespace tessera::view
