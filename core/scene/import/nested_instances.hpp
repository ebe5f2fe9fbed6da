// SPDX-License-Identifier: Apache-2.0
// Objects that hold instances of other objects. A SceneDescription has none (ObjectDescription::shapes):
// front ends build them first and then replace them here. Stateless; thread-safe.
#pragma once

#include <cstdint>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// The largest number of instances that a scene has after its nested ones are replaced.
inline constexpr std::uint64_t kMaxFlatInstances = 10'000'000;

// Replaces each instance of an object that holds instances by one for every object on the way down, whose
// transform is the product of all. The order is depth first, an object's own shapes before its instances. The
// outermost material that is given counts, and animated instances keep their motion. Objects that held
// nothing but instances are removed. INVALID_ARGUMENT if an object holds itself or there is no such object;
// RESOURCE_EXHAUSTED if there were more instances than `limit`. Unspecified after an error.
Status flatten_instances(SceneDescription& scene, std::uint64_t limit = kMaxFlatInstances);

}  // namespace tessera::core
