// SPDX-License-Identifier: Apache-2.0
// The page for browsers, embedded in the program: "/" and "/assets/NAME". Thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/http/server.hpp"

namespace tessera::view {

struct PageFile {
  std::string_view content_type;
  std::string_view gzip;  // lives as long as the program
  std::string etag;       // with its quotation marks
};

// The file with this path of a URL.
std::optional<PageFile> find_page_file(std::string_view path);

// The response to a GET of this path, or nothing if the page has no such file. Browsers keep the files and
// ask each time whether they have changed.
std::optional<http::Response> page_response(const http::Request& request);

}  // namespace tessera::view
