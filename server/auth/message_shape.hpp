// SPDX-License-Identifier: Apache-2.0
// Bounds on an encoded message, checked before it is parsed: two encoded bytes can take a hundred when
// parsed. Pure functions.
#pragma once

#include <google/protobuf/descriptor.h>
#include <grpcpp/support/byte_buffer.h>

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::auth {

// How many elements a repeated field may have in one message that holds it.
struct FieldLimit {
  std::string_view field;  // "tessera.v1.Bundle.assets"
  std::uint64_t max_elements;
  // The option of the coordinator that sets it; empty if none does.
  std::string_view option{};
};

struct ShapeLimits {
  // Fields of the whole message, elements of packed fields included.
  std::uint64_t max_fields;
  std::vector<FieldLimit> fields{};
};

// Walks over the encoded message of type `type` without allocating memory for its contents. INVALID_ARGUMENT
// if it is malformed, nests too deeply or has too many fields; RESOURCE_EXHAUSTED if an option limits the
// field that has too many elements.
core::Status check_shape(grpc::ByteBuffer& message, const google::protobuf::Descriptor& type,
                         const ShapeLimits& limits);

}  // namespace tessera::auth
