// SPDX-License-Identifier: Apache-2.0
// Simulates farms, each from a seed, and says which of them went wrong.
//   simulate_farms FARMS [FIRST_SEED]   so many farms, of seeds from 1 or FIRST_SEED on
//   simulate_farms --seed SEED          one farm, with a transcript
//   simulate_farms --digests FARMS [FIRST_SEED]   the digest of each farm's decisions, to compare two builds
// Exit status: 0 if nothing went wrong, 1 if something did, 2 if it was called in another way.
#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <optional>
#include <string_view>

#include "tests/simulation/farm.hpp"

namespace {

using tessera::simulation::FarmReport;
using tessera::simulation::simulate_farm;

constexpr int kMaxFailures = 5;

std::optional<std::uint64_t> number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

int replay(std::uint64_t seed) {
  const FarmReport report = simulate_farm(seed, true);
  fmt::print("{}\n", report.failure.value_or("nothing went wrong"));
  return report.failure ? 1 : 0;
}

int print_digests(std::uint64_t first, std::uint64_t farms) {
  for (std::uint64_t seed = first; seed < first + farms; ++seed)
    fmt::print("{} {:016x}\n", seed, simulate_farm(seed, false).digest);
  return 0;
}

int simulate(std::uint64_t first, std::uint64_t farms, const char* program) {
  double virtual_seconds = 0;
  std::uint64_t events = 0;
  int failures = 0;
  for (std::uint64_t seed = first; seed < first + farms && failures < kMaxFailures; ++seed) {
    const FarmReport report = simulate_farm(seed, false);
    virtual_seconds += report.virtual_seconds;
    events += report.events;
    if (!report.failure) continue;
    ++failures;
    fmt::print("seed {}: {}\n  replay: {} --seed {}\n", seed, *report.failure, program, seed);
  }
  if (failures > 0) return 1;
  fmt::print("{} farms from seed {} on: nothing went wrong in {:.0f} hours and {} events\n", farms, first,
             virtual_seconds / 3600, events);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int i) { return i < argc ? number(argv[i]) : std::nullopt; };
  if (argc == 3 && std::string_view(argv[1]) == "--seed" && argument(2)) return replay(*argument(2));
  if ((argc == 3 || argc == 4) && std::string_view(argv[1]) == "--digests" && argument(2))
    return print_digests(argument(3).value_or(1), *argument(2));
  const std::uint64_t first = argc > 2 ? argument(2).value_or(0) : 1;
  if ((argc == 2 || argc == 3) && argument(1) && first > 0) return simulate(first, *argument(1), argv[0]);
  fmt::print(stderr, "usage: {} FARMS [FIRST_SEED] | --seed SEED | --digests FARMS [FIRST_SEED]\n", argv[0]);
  return 2;
}
