// SPDX-License-Identifier: Apache-2.0
// How fallible functions answer: a value, or an Error with a code and a sentence that says what to mend.
// Whoever passes an Error up adds context in front: "scene.json:12: textures.wood.file: not a picture".
// Errors are for what can happen in the field; what cannot happen is an assertion.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

namespace tessera::core {

// The names and meanings of gRPC's status codes, so that the translation to and from RPC is one to one.
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

  // The same error with `context` and ": " in front of its message.
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
