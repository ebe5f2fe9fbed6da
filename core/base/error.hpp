// SPDX-License-Identifier: Apache-2.0
// The result of a fallible function: a value, or an Error with a code and a message that says how to fix
// the problem. Callers that pass an Error on prepend context: "scene.json:12: textures.wood.file: not an
// image". Errors are for conditions that occur in use; violated invariants are assertions.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

namespace tessera::core {

// The names and meanings of gRPC's status codes, so that errors map one to one to RPC statuses.
enum class ErrorCode {
  kCancelled,
  kInvalidArgument,
  kNotFound,
  kAlreadyExists,
  kPermissionDenied,
  kResourceExhausted,
  kFailedPrecondition,
  kUnavailable,
  kDeadlineExceeded,
  kDataLoss,
  kInternal,
};

struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;

  // The same error with `context` and ": " prepended to its message.
  Error within(std::string_view context) const { return Error{code, std::string(context) + ": " + message}; }
};

template <typename T>
class [[nodiscard]] Result : public tl::expected<T, Error> {
 public:
  using tl::expected<T, Error>::expected;
};

using Status = Result<void>;

inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}
inline tl::unexpected<Error> fail(Error error) {
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace tessera::core
