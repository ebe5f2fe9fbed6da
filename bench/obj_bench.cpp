// SPDX-License-Identifier: Apache-2.0
// Bytes per second of OBJ text for the loader, which validates every statement, rounds every number
// correctly and has faces parsed by tinyobjloader, compared with tinyobjloader alone; and the steps after
// reading.
#include <benchmark/benchmark.h>
#include <tiny_obj_loader.h>

#include <sstream>

#include "bench/grid_obj.hpp"
#include "core/scene/loader/mesh_builder.hpp"
#include "core/scene/loader/obj_reader.hpp"

namespace tessera::core {
namespace {

using bench::GridData;

constexpr int kTriangles = 1000000;

void read_ours(benchmark::State& state, GridData data) {
  const std::string text = bench::grid_obj(kTriangles, data);
  for (auto _ : state) benchmark::DoNotOptimize(read_obj(text, "grid.obj").value());
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(text.size()));
}

void read_tinyobjloader(benchmark::State& state, GridData data) {
  const std::string text = bench::grid_obj(kTriangles, data);
  for (auto _ : state) {
    tinyobj::attrib_t attributes;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warnings, errors;
    std::istringstream stream(text);
    benchmark::DoNotOptimize(tinyobj::LoadObj(&attributes, &shapes, &materials, &warnings, &errors, &stream));
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(text.size()));
}

void build_mesh_of(benchmark::State& state, GridData data) {
  const ObjFile file = read_obj(bench::grid_obj(kTriangles, data), "grid.obj").value();
  for (auto _ : state)
    benchmark::DoNotOptimize(build_mesh(file, NormalsMode::kFile, Transform{}, {0}).value());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(file.triangle_count()));
}

BENCHMARK_CAPTURE(read_ours, positions, GridData::kPositions)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_tinyobjloader, positions, GridData::kPositions)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_ours, uvs_and_normals, GridData::kUvsAndNormals)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_tinyobjloader, uvs_and_normals, GridData::kUvsAndNormals)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(build_mesh_of, computing_normals, GridData::kPositions)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(build_mesh_of, with_normals, GridData::kUvsAndNormals)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tessera::core
