// SPDX-License-Identifier: Apache-2.0
// Materials as scene files write them. Not thread-safe.
#pragma once

#include <string>

#include "core/materials/material.hpp"
#include "core/scene/parameter_tracks.hpp"
#include "core/scene/writer/table_text.hpp"

namespace tessera::core {

// Parameters that have their default are left out.
std::string material_text(const Material& material, const SceneNames& names, const ParameterTracks& tracks);

}  // namespace tessera::core
