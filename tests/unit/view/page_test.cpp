// SPDX-License-Identifier: Apache-2.0
#include "core/view/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <libdeflate.h>

#include <filesystem>

#include "core/view/security_headers.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::view {
namespace {

std::string inflate_gzip(std::string_view bytes, std::size_t size) {
  std::string inflated(size, '\0');
  libdeflate_decompressor* const inflater = libdeflate_alloc_decompressor();
  std::size_t count = 0;
  EXPECT_EQ(libdeflate_gzip_decompress(inflater, bytes.data(), bytes.size(), inflated.data(), size, &count),
            LIBDEFLATE_SUCCESS);
  libdeflate_free_decompressor(inflater);
  return inflated;
}

std::string value_of(const http::Response& response, const std::string& name) {
  for (const auto& [key, value] : response.headers)
    if (key == name) return value;
  return {};
}

http::Request request_of(const std::string& path, const std::string& etag = {}) {
  http::Request request;
  request.method = "GET";
  request.path = path;
  if (!etag.empty()) request.headers["if-none-match"] = etag;
  return request;
}

// The bytes of a response over the wire.
std::size_t wire_bytes(const http::Response& response) {
  std::size_t bytes = std::string_view(
                          "HTTP/1.1 200 OK\r\n"
                          "Date: Fri, 27 Nov 2026 08:00:00 GMT\r\n"
                          "Content-Length: 10000\r\n\r\n")
                          .size() +
                      response.body.size();
  for (const auto& [name, value] : response.headers) bytes += name.size() + value.size() + 4;
  return bytes;
}

TEST(Page, HasEveryFileOfItsFolder) {
  std::size_t total = 0;
  for (const auto& entry : std::filesystem::directory_iterator(TESSERA_SOURCE_DIR "/core/view/page")) {
    const std::string name = entry.path().filename().string();
    const auto file = find_page_file(name == "index.html" ? "/" : "/assets/" + name);
    ASSERT_TRUE(file) << name;
    const std::string bytes = read_file(entry.path());
    EXPECT_EQ(inflate_gzip(file->gzip, bytes.size()), bytes) << name;
    EXPECT_NE(file->content_type, "application/octet-stream") << name;
    total += wire_bytes(*page_response(request_of(name == "index.html" ? "/" : "/assets/" + name)));
  }
  EXPECT_GT(total, 0u);
  EXPECT_LT(total, 100'000u) << "what a browser loads at the first visit";
}

TEST(Page, IsSentWithItsHeaders) {
  const auto response = page_response(request_of("/"));
  ASSERT_TRUE(response);
  EXPECT_EQ(response->status, 200);
  EXPECT_EQ(value_of(*response, "Content-Encoding"), "gzip");
  EXPECT_EQ(value_of(*response, "Content-Type"), "text/html; charset=utf-8");
  EXPECT_THAT(value_of(*response, "Content-Security-Policy"), testing::StartsWith("default-src 'none'; "));
  EXPECT_EQ(value_of(*response, "X-Content-Type-Options"), "nosniff");
  for (const char* const name : {"/assets/main.js", "/assets/style.css"})
    EXPECT_EQ(value_of(*page_response(request_of(name)), "X-Content-Type-Options"), "nosniff");
  EXPECT_NE(value_of(*page_response(request_of("/assets/icon.svg")), "Content-Security-Policy"), "");
  const auto unchanged = page_response(request_of("/", value_of(*response, "ETag")));
  ASSERT_TRUE(unchanged);
  EXPECT_EQ(unchanged->status, 304);
  EXPECT_EQ(unchanged->body, "");
}

TEST(Page, HasNoOtherFiles) {
  for (const char* const path : {"", "/index.html", "/assets/", "/assets/../index.html", "/assets/none.js"})
    EXPECT_FALSE(page_response(request_of(path))) << path;
}

TEST(LocalHost, IsNoName) {
  for (const char* const host : {"127.0.0.1:8080", "localhost:1", "localhost", "[::1]:80", "10.0.0.5"})
    EXPECT_TRUE(is_local_host(host)) << host;
  for (const char* const host : {"", "evil.example", "evil.example:8080", "localhost.evil.example:80"})
    EXPECT_FALSE(is_local_host(host)) << host;
}

}  // namespace
}  // namespace tessera::view
