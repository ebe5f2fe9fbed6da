// SPDX-License-Identifier: Apache-2.0
// A scene file and the files it names, through everything a worker does with them, up to a few samples.
// The input's first part is the scene file; the others are files by name (parts.hpp).
#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>

#include "core/scene/loader/loader.hpp"
#include "core/scene/pose.hpp"
#include "core/scene/scene.hpp"
#include "core/scene/validation.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/parts.hpp"
#include "tests/fuzz/render_corner.hpp"

namespace tessera::fuzz {

class InputAssets : public core::AssetSource {
 public:
  InputAssets(std::string_view input, std::string scene) : scene_(std::move(scene)) {
    for (const Part& part : parts_of(input)) files_.emplace(part.name, part.bytes);
  }

  core::Result<std::string> read(const std::string& path) override {
    const auto file = files_.find(path == scene_ ? "" : std::string_view(path));
    if (file != files_.end()) return std::string(file->second);
    return core::fail(core::ErrorCode::kNotFound, core::in_quotes(path) + " is not there");
  }

 private:
  std::string scene_;
  std::map<std::string_view, std::string_view> files_;
};

// `name` is the scene file's, whose ending decides its format.
inline void load_and_render(std::string_view input, const std::string& name) {
  InputAssets assets(input, name);
  auto description = core::load_scene(assets, name, name);
  if (!expect_answer(description)) return;
  const bool valid = expect_answer(core::validate_scene(*description));
  constexpr std::array kFrames{7};
  const bool has_frame = valid && expect_answer(core::validate_frames(*description, kFrames));
  auto scene = core::Scene::build(std::move(*description), 1);
  expect(expect_answer(scene) == valid, "what is validated can be built, and nothing else");
  if (!scene) return;
  render_corner(*scene, scene->settings());
  expect(expect_answer(scene->set_frame(kFrames[0], 1)) == has_frame,
         "frames that are validated can be shown, and no others");
  render_corner(*scene, scene->settings());
}

}  // namespace tessera::fuzz
