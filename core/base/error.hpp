// SPDX-License-Identifier: Apache-2.0
// The result of a fallible function: a value, or an Error with a code and a message that says how to fix
// the problem. Callers that pass an Error on prepend context: "scene.json:12: textures.wood.file: not an
// image". Errors are for conditions that occur in use; violated invariants are assertions.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

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
  kOutOfRange,
  kInternal,
};

// What programs, unlike people, learn of an error besides its code (proto/status.hpp). Empty: not known.
struct ErrorDetails {
  // Why, as a stable name in capitals: "MISSING_BLOBS".
  std::string reason{};
  // The invalid field of the request: "bundle.scene_path".
  std::string field{};
  // The option of the program that sets the exceeded limit.
  std::string option{};
  // What must be there before the call is repeated.
  std::vector<std::string> missing{};
  // The condition passes by itself: the delay before a retry.
  std::optional<std::uint32_t> retry_delay_ms{};
};

struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
  std::shared_ptr<const ErrorDetails> details{};  // null if there are none

  // The same error with `context` and ": " prepended to its message.
  Error within(std::string_view context) const {
    return Error{code, std::string(context) + ": " + message, details};
  }
  // The same error with these details.
  Error with(ErrorDetails more) const {
    return Error{code, message, std::make_shared<const ErrorDetails>(std::move(more))};
  }
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

// The details of an error, empty if it has none.
inline ErrorDetails details_of(const Error& error) {
  return error.details ? *error.details : ErrorDetails{};
}

}  // namespace tessera::core
