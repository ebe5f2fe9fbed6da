// SPDX-License-Identifier: Apache-2.0
// The table of routes of the HTTP API. Each names the method of gRPC whose role and limits it has, so that
// there is one table of these (auth/methods.hpp).
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/call.hpp"

namespace tessera::http_api {

enum class Where {
  kHere,   // on the thread that serves connections: it must take no time
  kUsers,  // milliseconds
  kSlow,   // seconds
};

struct Route {
  std::string_view verb, pattern;  // "GET", "/api/v1/jobs/{id}"
  std::string_view method;         // "RenderService/GetJob"
  std::size_t max_body_bytes;
  Where where;
  Answer (*answer)(const CallPtr& call);
  // Instead: takes the body piece by piece.
  core::Result<std::unique_ptr<http::BodySink>> (*receive)(const CallPtr& call) = nullptr;

  // Whether it changes something, or is not to be called by other sites for another reason.
  bool is_change() const { return verb != "GET"; }
  // "/tessera.v1.RenderService/GetJob"
  std::string method_path() const { return "/tessera.v1." + std::string(method); }
  // "GET /api/v1/jobs/{id}", in metrics.
  std::string name() const { return std::string(verb) + " " + std::string(pattern); }
};

std::span<const Route> routes();
std::vector<std::string> route_names();

struct FoundRoute {
  const Route* route = nullptr;              // null if there is none for this verb
  std::map<std::string, std::string> names;  // those in the path
  std::string allowed;                       // the verbs that the path has: "GET, DELETE"
};
FoundRoute find_route(const std::string& verb, const std::string& path);

}  // namespace tessera::http_api
