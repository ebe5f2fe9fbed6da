// SPDX-License-Identifier: Apache-2.0
// Measures the memory of loading a large OBJ file: tessera_obj_memory [TRIANGLES], 10,000,000 by default.
// Linux only: peaks are the kernel's for this process.
#include <fmt/format.h>
#include <malloc.h>

#include <cstdio>
#include <fstream>
#include <optional>
#include <string>

#include "bench/grid_obj.hpp"
#include "core/scene/loader/mesh_builder.hpp"
#include "core/scene/loader/obj_reader.hpp"

namespace tessera::core {
namespace {

// "VmRSS" or "VmHWM" of this process, in bytes.
double memory(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(key)) return 1024 * std::stod(line.substr(key.size() + 1));
  return 0;
}

// Runs one step and prints its peak above what was there before everything.
template <typename Step>
auto measured(const char* name, double base, double triangles, Step step) {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << 5;  // resets the peak
  auto result = step();
  fmt::print("  {:<22} peak {:6.0f} MB, {:4.0f} bytes a triangle\n", name, (memory("VmHWM") - base) / 1e6,
             (memory("VmHWM") - base) / triangles);
  return result;
}

void measure(const char* title, int triangles, bench::GridData data) {
  malloc_trim(0);
  const double base = memory("VmRSS");
  std::optional<std::string> text = bench::grid_obj(triangles, data);
  std::optional<ObjFile> file;
  fmt::print("{}: {:.0f} MB of text\n", title, static_cast<double>(text->size()) / 1e6);
  file = measured("reading, with the text", base, triangles,
                  [&] { return read_obj(*text, "grid.obj").value(); });
  text.reset();
  const auto count = static_cast<double>(file->triangle_count());
  const auto mesh = measured("building the mesh", base, count,
                             [&] { return build_mesh(*file, NormalsMode::kFile, Transform{}, {0}).value(); });
  file.reset();
  malloc_trim(0);
  fmt::print("  {:<22}      {:6.0f} MB, {:4.0f} bytes a triangle\n", "the mesh",
             (memory("VmRSS") - base) / 1e6, (memory("VmRSS") - base) / count);
}

}  // namespace
}  // namespace tessera::core

int main(int argc, char** argv) {
  const int triangles = argc > 1 ? std::atoi(argv[1]) : 10000000;
  if (triangles < 1 || triangles > 100000000) {
    fmt::print(stderr, "usage: tessera_obj_memory [TRIANGLES], 1 to 100000000\n");
    return 2;
  }
  tessera::core::measure("positions only", triangles, tessera::bench::GridData::kPositions);
  tessera::core::measure("with texture coordinates and normals", triangles,
                         tessera::bench::GridData::kUvsAndNormals);
  return 0;
}
