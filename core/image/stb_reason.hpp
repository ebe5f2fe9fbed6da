// Why stb_image refused a file, fit to be shown. Thread-safe.
#pragma once

#include <stb_image.h>

#include <algorithm>
#include <string>

namespace tessera::core {

// Of this thread's last failure. stb_image quotes the names of PNG's chunks with whatever bytes they have.
inline std::string stb_reason() {
  std::string reason = stbi_failure_reason();
  std::replace_if(
      reason.begin(), reason.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return reason;
}

}  // namespace tessera::core
