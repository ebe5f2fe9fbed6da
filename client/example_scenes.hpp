// SPDX-License-Identifier: Apache-2.0
// The example scenes that come with the program: beside it in share/tessera/scenes, in a build folder as
// installed.
#pragma once

#include <string>

namespace tessera::client {

// The scene file that `name` stands for: the file of this name, if there is one; else that of an example
// scene, such as "cornell" or "glass_and_water/fresnel"; else `name` as it is.
std::string find_scene(const std::string& name);

// "there is no scene 'corell'; did you mean 'cornell'?" if `name` is neither a file nor an example scene, but
// similar to the name of one, or that of a group of them. Otherwise empty. A check of CLI11.
std::string suggest_example(const std::string& name);

}  // namespace tessera::client
