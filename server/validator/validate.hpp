// SPDX-License-Identifier: Apache-2.0
// Loads a bundle's scene and reports whether it can be rendered, with the error messages of a local render.
#pragma once

#include "core/scene/loader/asset_source.hpp"
#include "server/validator/options.hpp"
#include "server/validator/validate.pb.h"

namespace tessera::validator {

// `assets` are those of the request's bundle. Throws nothing; lack of memory gives a refusal.
ValidateResponse validate(const ValidateRequest& request, core::AssetSource& assets, const Options& options);

}  // namespace tessera::validator
