// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/wording.hpp"

#include <utility>

namespace tessera::core {

tl::unexpected<Error> mistake(std::string message) {
  return fail(ErrorCode::kInvalidArgument, std::move(message));
}

}  // namespace tessera::core
