// SPDX-License-Identifier: Apache-2.0
#include "server/http/routes.hpp"

#include "server/http/handlers.hpp"

namespace tessera::http_api {

namespace {

// Of a few fields, and of the names and digests of a scene's files.
constexpr std::size_t kSmall = 64 << 10, kLarge = 16 << 20;

constexpr Route kRoutes[] = {
    {"GET", "/api/v1/server", "RenderService/GetServerInfo", 0, Where::kHere, get_server},
    {"GET", "/api/v1/jobs", "RenderService/ListJobs", 0, Where::kUsers, list_jobs},
    {"POST", "/api/v1/jobs", "RenderService/SubmitJob", kLarge, Where::kUsers, submit_job},
    {"GET", "/api/v1/jobs/{id}", "RenderService/GetJob", 0, Where::kUsers, get_job},
    {"DELETE", "/api/v1/jobs/{id}", "RenderService/DeleteJob", 0, Where::kUsers, delete_job},
    {"PATCH", "/api/v1/jobs/{id}", "RenderService/UpdateJob", kSmall, Where::kUsers, update_job},
    {"POST", "/api/v1/jobs/{id}/pause", "RenderService/PauseJob", kSmall, Where::kUsers, pause_job},
    {"POST", "/api/v1/jobs/{id}/resume", "RenderService/ResumeJob", kSmall, Where::kUsers, resume_job},
    {"POST", "/api/v1/jobs/{id}/cancel", "RenderService/CancelJob", kSmall, Where::kUsers, cancel_job},
    {"POST", "/api/v1/jobs/{id}/extend", "RenderService/ExtendJob", kSmall, Where::kSlow, extend_job},
    {"GET", "/api/v1/jobs/{id}/events", "RenderService/GetJob", 0, Where::kUsers, get_events},
    {"GET", "/api/v1/jobs/{id}/image", "RenderService/GetImage", 0, Where::kUsers, get_image},
    {"GET", "/api/v1/jobs/{id}/thumbnail", "RenderService/GetImage", 0, Where::kSlow, get_thumbnail},
    {"GET", "/api/v1/jobs/{id}/pixel", "RenderService/GetImage", 0, Where::kUsers, get_pixel},
    {"GET", "/api/v1/jobs/{id}/map", "RenderService/WatchTiles", 0, Where::kUsers, get_map},
    {"GET", "/api/v1/jobs/{id}/tiles", "RenderService/WatchTiles", 0, Where::kUsers, watch_tiles},
    {"GET", "/api/v1/workers", "RenderService/ListWorkers", 0, Where::kUsers, list_workers},
    {"POST", "/api/v1/workers/{id}/drain", "AdminService/DrainWorker", kSmall, Where::kUsers, drain_worker},
    {"GET", "/api/v1/quarantine", "AdminService/ListQuarantine", 0, Where::kUsers, list_quarantine},
    {"DELETE", "/api/v1/quarantine/{id}", "AdminService/LiftQuarantine", 0, Where::kUsers, lift_quarantine},
    {"GET", "/api/v1/activity", "RenderService/WatchFarm", 0, Where::kHere, get_activity},
    {"GET", "/api/v1/events", "RenderService/WatchFarm", 0, Where::kHere, watch_farm},
    {"POST", "/api/v1/blobs", "RenderService/UploadBlob", 0, Where::kSlow, nullptr, receive_blob},
    {"POST", "/api/v1/blobs/missing", "RenderService/FindMissingBlobs", kLarge, Where::kUsers, find_missing},
};

// The part before the first slash, which it removes.
std::string_view next_part(std::string_view& path) {
  const std::size_t slash = path.find('/');
  const std::string_view part = path.substr(0, slash);
  path = slash == std::string_view::npos ? std::string_view() : path.substr(slash + 1);
  return part;
}

bool matches(std::string_view pattern, std::string_view path, std::map<std::string, std::string>& names) {
  while (!pattern.empty() && !path.empty()) {
    const std::string_view expected = next_part(pattern), found = next_part(path);
    if (expected.starts_with('{')) {
      if (found.empty()) return false;
      names[std::string(expected.substr(1, expected.size() - 2))] = found;
    } else if (expected != found) {
      return false;
    }
  }
  return pattern.empty() && path.empty();
}

}  // namespace

std::span<const Route> routes() {
  return kRoutes;
}

std::vector<std::string> route_names() {
  std::vector<std::string> names;
  for (const Route& route : kRoutes) names.push_back(route.name());
  return names;
}

FoundRoute find_route(const std::string& verb, const std::string& path) {
  FoundRoute found;
  for (const Route& route : kRoutes) {
    std::map<std::string, std::string> names;
    if (!matches(route.pattern, path, names)) continue;
    found.allowed += (found.allowed.empty() ? "" : ", ") + std::string(route.verb);
    if (route.verb != verb) continue;
    found.route = &route;
    found.names = std::move(names);
  }
  return found;
}

}  // namespace tessera::http_api
