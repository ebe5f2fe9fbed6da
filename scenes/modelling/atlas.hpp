// SPDX-License-Identifier: Apache-2.0
// Texture coordinates for meshes that have no natural ones, and textures painted on them by place. Stateless;
// thread-safe; the same bytes on every machine.
#pragma once

#include <functional>

#include "core/image/image.hpp"
#include "core/scene/description.hpp"

namespace tessera::modelling {

// The mesh with uvs: cut where its normals turn from one axis to another, each piece laid flat along its
// axis, stretched by no more than sqrt(3), and all of them side by side in the unit square, far enough apart
// that bilinear filtering of a texture of `texture_px` x `texture_px` does not mix them. Vertices along the
// cuts are doubled, in the same place and with the same normal. The mesh has normals.
core::MeshDescription unwrap(const core::MeshDescription& mesh, int texture_px);

// A texture of `texture_px` x `texture_px` for what `unwrap` made, from the colour of each point of the
// surface.
core::Image paint_surface(const core::MeshDescription& unwrapped, int texture_px,
                          const std::function<core::Rgb(core::Vec3 position, core::Vec3 normal)>& color);

}  // namespace tessera::modelling
