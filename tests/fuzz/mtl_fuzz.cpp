// SPDX-License-Identifier: Apache-2.0
// A material library: whatever it says becomes a material that can be rendered.
#include "core/scene/loader/mtl_material.hpp"
#include "core/scene/loader/mtl_reader.hpp"
#include "core/scene/validation.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace tessera::fuzz {

TESSERA_FUZZER(mtl, std::string_view input) {
  const core::MtlFile file = core::read_mtl(input);
  core::SceneDescription scene;
  for (const auto& material : file.materials) scene.materials.push_back(core::make_material(material, {}));
  scene.materials.push_back({"plain", core::Lambert{}});
  scene.shapes.emplace_back(core::SphereDescription{});
  expect(core::validate_scene(scene).has_value(), "the materials are valid");
}

}  // namespace tessera::fuzz
