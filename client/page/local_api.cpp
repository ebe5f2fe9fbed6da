// SPDX-License-Identifier: Apache-2.0
#include "client/page/local_api.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "client/page/local_events.hpp"
#include "client/page/local_image.hpp"
#include "core/base/version.hpp"
#include "core/view/page.hpp"
#include "core/view/security_headers.hpp"
#include "core/view/tile_statistics.hpp"

namespace tessera::client {
namespace {

using Json = nlohmann::ordered_json;

// How long a request may read tiles; the next one goes on.
constexpr std::chrono::milliseconds kReadingTime{200};

http::Response json_response(std::string text) {
  return {.headers = {{"Content-Type", "application/json"}, {"Cache-Control", "no-store"}},
          .body = std::move(text)};
}

struct HttpStatus {
  int status;
  const char* code;
};

HttpStatus http_status(core::ErrorCode code) {
  switch (code) {
    case core::ErrorCode::kInvalidArgument:
      return {400, "INVALID_ARGUMENT"};
    case core::ErrorCode::kOutOfRange:
      return {400, "OUT_OF_RANGE"};
    case core::ErrorCode::kNotFound:
      return {404, "NOT_FOUND"};
    case core::ErrorCode::kPermissionDenied:
      return {403, "PERMISSION_DENIED"};
    case core::ErrorCode::kUnavailable:
      return {503, "UNAVAILABLE"};
    case core::ErrorCode::kFailedPrecondition:
      return {409, "FAILED_PRECONDITION"};
    default:
      return {500, "INTERNAL"};
  }
}

http::Response error_response(const core::Error& error) {
  const HttpStatus status = http_status(error.code);
  Json body = {{"code", status.code}, {"message", error.message}};
  if (const std::string field = core::details_of(error).field; !field.empty()) body["field"] = field;
  const Json json = {{"error", std::move(body)}};
  http::Response response = json_response(json.dump(-1, ' ', false, Json::error_handler_t::replace));
  response.status = status.status;
  return response;
}

http::Response no_such_path() {
  return error_response({core::ErrorCode::kNotFound, "a local render has nothing here"});
}

std::chrono::steady_clock::time_point deadline() {
  return std::chrono::steady_clock::now() + kReadingTime;
}

core::Result<int> number(const http::Request& request, const std::string& name, int most) {
  const auto value = view::parse_parameter(name, request.parameter(name).value_or(""), 0, most);
  if (!value) return core::fail(value.error());
  return static_cast<int>(*value);
}

}  // namespace

http::Reception LocalApi::receive(const http::Request& request) {
  http::Reception reception;
  if (!view::is_local_host(request.header("host")))
    reception.reject = error_response(
        {core::ErrorCode::kPermissionDenied, "open the page by the address that tessera has printed"});
  else if (request.method != "GET")
    reception.reject = no_such_path();
  if (reception.reject) view::add_security_headers(*reception.reject);
  return reception;
}

http::Response LocalApi::handle(const http::Request& request) {
  if (auto page = view::page_response(request)) return std::move(*page);
  auto answered = answer(request);
  http::Response response = !answered   ? no_such_path()
                            : *answered ? std::move(**answered)
                                        : error_response(answered->error());
  view::add_security_headers(response);
  return response;
}

std::optional<LocalApi::Answer> LocalApi::answer(const http::Request& request) {
  using Route = Answer (*)(LocalApi&, const http::Request&);
  static const std::map<std::string, Route> routes = {
      {"/healthz", [](LocalApi&, const http::Request&) { return Answer(http::Response{.body = "ok\n"}); }},
      {"/readyz", [](LocalApi&, const http::Request&) { return Answer(http::Response{.body = "ok\n"}); }},
      {"/api/v1/session", [](LocalApi& api, const http::Request&) { return api.session(); }},
      {"/api/v1/server", [](LocalApi& api, const http::Request&) { return api.server(); }},
      {"/api/v1/events", [](LocalApi& api, const http::Request&) { return api.events(); }},
      {"/api/v1/jobs", [](LocalApi& api, const http::Request&) { return api.jobs(); }},
      {"/api/v1/jobs/local", [](LocalApi& api, const http::Request&) { return api.job(); }},
      {"/api/v1/jobs/local/tiles", [](LocalApi& api, const http::Request& r) { return api.tiles(r); }},
      {"/api/v1/jobs/local/pixel", [](LocalApi& api, const http::Request& r) { return api.pixel(r); }},
      {"/api/v1/jobs/local/map", [](LocalApi& api, const http::Request&) { return api.map(); }},
      {"/api/v1/jobs/local/image", [](LocalApi& api, const http::Request& r) { return api.image(r); }},
      {"/api/v1/jobs/local/thumbnail",
       [](LocalApi& api, const http::Request& r) { return api.thumbnail(r); }},
  };
  const auto route = routes.find(request.path);
  if (route == routes.end()) return std::nullopt;
  return route->second(*this, request);
}

LocalApi::Answer LocalApi::session() const {
  return json_response(R"({"open":true,"principal":null,"role":"view"})");
}

LocalApi::Answer LocalApi::server() const {
  const Json json = {{"version", core::version()},
                     {"started_at", job_.started_at()},
                     {"features", Json::array({"local"})},
                     {"limits", Json::object()},
                     {"principal", nullptr},
                     {"role", "view"},
                     {"open", true}};
  return json_response(json.dump());
}

LocalApi::Answer LocalApi::jobs() const {
  return json_response(fmt::format(R"({{"jobs":[{}],"next_page_token":""}})", job_.header().json));
}

LocalApi::Answer LocalApi::job() const {
  return json_response(job_.header().json);
}

LocalApi::Answer LocalApi::events() const {
  http::Response response{.headers = {{"Content-Type", "text/event-stream"}, {"Cache-Control", "no-store"}}};
  response.source = std::make_unique<LocalEvents>(job_);
  return response;
}

LocalApi::Answer LocalApi::tiles(const http::Request& request) {
  const auto query = view::parse_stream_query(request);
  if (!query) return core::fail(query.error());
  if (auto there = view::check_layer(source_->layers(), query->layer); !there)
    return core::fail(there.error());
  http::Response response{
      .headers = {{"Content-Type", "application/octet-stream"}, {"Cache-Control", "no-store"}}};
  response.source = std::make_unique<view::TileStream>(source_, *query, streams_);
  return response;
}

LocalApi::Answer LocalApi::pixel(const http::Request& request) {
  const auto x = number(request, "x", core::kMaxImageSidePx), y = number(request, "y", core::kMaxImageSidePx);
  if (!x) return core::fail(x.error());
  if (!y) return core::fail(y.error());
  const auto layer = view::parse_layer(request.parameter("layer").value_or(""));
  if (!layer) return core::fail(layer.error());
  const auto pixel = view::read_pixel(*source_, *x, *y, *layer);
  if (!pixel) return core::fail(pixel.error());
  return json_response(view::to_json(*pixel));
}

LocalApi::Answer LocalApi::map() {
  const auto states = view::read_tile_states(*source_, tiles_, deadline());
  if (!states) return core::fail(states.error());
  const core::TileGrid grid = *source_->grid();
  std::string tiles;
  for (const auto& state : *states) {
    const auto noise = state ? state->noise : std::nullopt;
    tiles += fmt::format("{}[{},0,-1,{}]", tiles.empty() ? "" : ",", state ? state->samples : 0,
                         noise ? fmt::format("{}", *noise) : "null");
  }
  return json_response(fmt::format(
      R"({{"tile_width":{0},"tile_height":{0},"columns":{1},"rows":{2},"workers":[],"tiles":[{3}]}})",
      grid.tile_px(), grid.columns(), grid.rows(), tiles));
}

LocalApi::Answer LocalApi::image(const http::Request& request) {
  return local_image(job_, *source_, header_, request);
}

LocalApi::Answer LocalApi::thumbnail(const http::Request& request) {
  int size = view::kMaxThumbnailPx;
  if (request.parameter("size")) {
    const auto asked = number(request, "size", core::kMaxImageSidePx);
    if (!asked) return core::fail(asked.error());
    size = *asked;
  }
  const auto thumbnail = thumbnails_.get(*source_, size, job_.display(), deadline());
  if (!thumbnail) return core::fail(thumbnail.error());
  http::Response response{.headers = {{"Content-Type", "image/png"}, {"Cache-Control", "no-cache"}}};
  if ((*thumbnail)->is_current) {
    response.headers.emplace_back("ETag", (*thumbnail)->etag);
    if (request.header("if-none-match") == (*thumbnail)->etag) {
      response.status = 304;
      return response;
    }
  }
  response.body = (*thumbnail)->png;
  return response;
}

}  // namespace tessera::client
