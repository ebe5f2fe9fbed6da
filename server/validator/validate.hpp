// SPDX-License-Identifier: Apache-2.0
// Loads a bundle's scene and says whether it can be rendered, in the words in which a local render would
// refuse it.
#pragma once

#include "server/validator/options.hpp"
#include "server/validator/validate.pb.h"

namespace tessera::validator {

// Opens only `request.files()`. Throws nothing; want of memory is a refusal.
ValidateResponse validate(const ValidateRequest& request, const Options& options);

}  // namespace tessera::validator
