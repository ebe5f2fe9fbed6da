// SPDX-License-Identifier: Apache-2.0
#include "core/view/page.hpp"

#include <array>
#include <utility>

#include "core/view/embedded_file.hpp"
#include "core/view/security_headers.hpp"

namespace tessera::view {
namespace {

constexpr std::string_view kAssets = "/assets/";

std::string_view content_type(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kTypes{{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".svg", "image/svg+xml"},
  }};
  for (const auto& [ending, type] : kTypes)
    if (name.ends_with(ending)) return type;
  return "application/octet-stream";
}

std::string_view file_name(std::string_view path) {
  if (path == "/") return "index.html";
  return path.starts_with(kAssets) ? path.substr(kAssets.size()) : std::string_view();
}

std::string_view as_text(const EmbeddedFile& file) {
  return {static_cast<const char*>(static_cast<const void*>(file.gzip)), file.gzip_bytes};
}

}  // namespace

std::optional<PageFile> find_page_file(std::string_view path) {
  const std::string_view name = file_name(path);
  for (const EmbeddedFile& file : embedded_files())
    if (name == file.name)
      return PageFile{content_type(name), as_text(file), '"' + std::string(file.etag) + '"'};
  return std::nullopt;
}

std::optional<http::Response> page_response(const http::Request& request) {
  const auto file = find_page_file(request.path);
  if (!file) return std::nullopt;
  http::Response response;
  response.headers = {{"Cache-Control", "no-cache"}, {"ETag", file->etag}};
  const bool is_resource =
      file->content_type.starts_with("text/javascript") || file->content_type.starts_with("text/css");
  if (is_resource)
    add_resource_headers(response);
  else
    add_security_headers(response);
  if (request.header("if-none-match") == file->etag) {
    response.status = 304;
    return response;
  }
  // Every browser takes gzip, and no other program wants the page.
  response.headers.emplace_back("Content-Encoding", "gzip");
  response.headers.emplace_back("Content-Type", file->content_type);
  response.body = file->gzip;
  return response;
}

}  // namespace tessera::view
