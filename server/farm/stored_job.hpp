// SPDX-License-Identifier: Apache-2.0
// Converts what the store keeps of a job to and from its bytes (store/stored.proto), and reads those of
// earlier releases, which were messages of the protocol. Pure functions.
#pragma once

#include <optional>
#include <string>

#include "server/scheduler/failure.hpp"
#include "tessera/v1/render_service.pb.h"
#include "tessera/v1/types.pb.h"

namespace tessera::farm {

// Without what encode_bundle() has, in a column of its own.
std::string encode_spec(const v1::Job& job);
// Whether the bytes could be read. Sets everything that encode_spec() has written; those of earlier releases
// also have the bundle.
bool decode_spec(const std::string& bytes, v1::Job& job);

// Only the overrides and the display of a submission; the spec has the rest.
std::string encode_submission(const v1::SubmitJobRequest& submission);
bool decode_submission(const std::string& bytes, v1::SubmitJobRequest& submission);

std::string encode_failure(const scheduler::FailureDetails& details);
// Bytes that cannot be read are of an unknown reason.
scheduler::FailureDetails decode_failure(const std::string& bytes);

// Empty if there are none.
std::string encode_targets(const scheduler::TileTargets& targets);
// Empty if the bytes cannot be read.
std::optional<scheduler::TileTargets> decode_targets(const std::string& bytes);

// The bundle, scene_digests and attributes of a job, which lists do not read.
std::string encode_bundle(const v1::Job& job);
bool decode_bundle(const std::string& bytes, v1::Job& job);

}  // namespace tessera::farm
