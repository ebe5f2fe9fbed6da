// SPDX-License-Identifier: Apache-2.0
// Jobs, workers and errors as JSON, for the HTTP API and the command line's --json: docs/http-api.md lists
// the fields. States and names are those of scene files, integers are numbers, digests 64 hexadecimal digits,
// times RFC 3339 in UTC, durations seconds. Pure functions.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/base/error.hpp"
#include "tessera/v1/admin_service.pb.h"
#include "tessera/v1/render_service.pb.h"
#include "tessera/v1/types.pb.h"

namespace tessera::proto {

// "scene" and "files" only if the job has its bundle, "images" only if it has their list.
nlohmann::ordered_json to_json(const v1::Job& job);
nlohmann::ordered_json to_json(const v1::Worker& worker);
nlohmann::ordered_json to_json(const v1::QuarantineEntry& entry);
nlohmann::ordered_json to_json(const v1::GetServerInfoResponse& info);

// {"code": "NOT_FOUND", "message": ...}, with "reason", "field" and "missing" where known: the value of
// "error" in answers of the HTTP API. Names of blobs among the missing things become their SHA-256.
nlohmann::ordered_json error_to_json(const core::Error& error);

// One line without its end, in ASCII so that no text can control a terminal. Never throws.
std::string to_line(const nlohmann::ordered_json& json);

}  // namespace tessera::proto
