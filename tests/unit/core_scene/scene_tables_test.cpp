// SPDX-License-Identifier: Apache-2.0
// The tables of keys, and what follows from them.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/scene/reference/all_tables.hpp"
#include "core/scene/reference/reference_tables.hpp"
#include "core/scene/reference/schema.hpp"
#include "core/scene/tables/check.hpp"
#include "core/scene/validate_materials.hpp"

namespace tessera::core {
namespace {

std::string contents(const std::string& path) {
  std::ifstream file(TESSERA_SOURCE_DIR "/" + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The first line that differs, for messages shorter than the files.
std::string first_difference(const std::string& a, const std::string& b) {
  const auto [in_a, in_b] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  const auto line_at = [](const std::string& text, std::size_t place) {
    const std::size_t begin = text.rfind('\n', place) + 1;
    return text.substr(begin, text.find('\n', place) - begin);
  };
  if (in_a == a.end() && in_b == b.end()) return {};
  const auto place = static_cast<std::size_t>(in_a - a.begin());
  return line_at(a, place) + "\ninstead of\n" + line_at(b, place) + "\nrun write_scene_reference";
}

TEST(SceneTables, MakeTheSchema) {
  const std::string schema = contents("scenes/scene.schema.json");
  EXPECT_EQ(first_difference(schema, update_schema(schema).text), "");
}

TEST(SceneTables, MakeTheReference) {
  const std::string page = contents("docs/scene-format.md");
  EXPECT_EQ(first_difference(page, update_reference(page)), "");
  for_each_table([&]<typename... Entries>(auto, std::string_view name, const Table<Entries...>&) {
    if (sizeof...(Entries) == 0) return;
    EXPECT_NE(page.find("<!-- keys of " + std::string(name) + " -->"), std::string::npos) << name;
  });
}

TEST(SceneTables, NameNoKeyTwice) {
  for_each_table([](auto, std::string_view name, const auto& table) {
    std::set<std::string_view> keys;
    for_each(table, [&]<typename Entry>(const Entry& entry) {
      if constexpr (Named<Entry>) {
        EXPECT_TRUE(keys.insert(entry.name).second) << name << "." << entry.name;
      }
    });
  });
}

// What the scene cache stores: bytes that no entry covers are padding, which is shorter than the alignment
// of the member after it, or of the whole.
TEST(SceneTables, HaveEveryMember) {
  for_each_table([]<typename Owner>(std::type_identity<Owner>, std::string_view name, const auto& table) {
    Owner owner{};
    std::vector<bool> covered(sizeof(Owner));
    std::map<std::size_t, std::size_t> alignments{{sizeof(Owner), alignof(Owner)}};  // of what begins there
    const auto* begin = reinterpret_cast<const unsigned char*>(&owner);
    for_each(table, [&]<typename Entry>(const Entry& entry) {
      if constexpr (MemberOf<Entry, Owner>) {
        auto& member = entry.of(owner);
        const auto place = static_cast<std::size_t>(reinterpret_cast<const unsigned char*>(&member) - begin);
        for (std::size_t i = 0; i < sizeof(member); ++i) covered[place + i] = true;
        alignments[place] = alignof(std::remove_reference_t<decltype(member)>);
      }
    });
    if (std::is_empty_v<Owner>) return;
    std::size_t uncovered = 0;
    for (std::size_t place = 0; place <= covered.size(); ++place) {
      if (const auto begins = alignments.find(place); begins != alignments.end()) {
        EXPECT_LT(uncovered, begins->second) << name;
      }
      uncovered = place < covered.size() && covered[place] ? 0 : uncovered + 1;
    }
  });
}

TEST(SceneTables, AcceptTheirDefaults) {
  for_each_table([]<typename Owner>(std::type_identity<Owner>, std::string_view name, const auto& table) {
    const auto mistake = find_mistake(table, Owner{}, NameCounts{});
    EXPECT_FALSE(mistake) << name << "." << mistake->key << " " << mistake->what;
  });
}

TEST(Range, IsToldInWords) {
  EXPECT_EQ(phrase_of({.min = 0, .max = 1e5}), "between 0 and 100000");
  EXPECT_EQ(phrase_of({.min = -1e15, .max = 1e15}), "between -1e15 and 1e15");
  EXPECT_EQ(phrase_of({.min = 0, .max = 180, .excludes_min = true}), "greater than 0 and at most 180");
  EXPECT_EQ(phrase_of({.min = 0, .max = 180, .excludes_min = true, .excludes_max = true}),
            "greater than 0 and less than 180");
  EXPECT_EQ(phrase_of({.min = 0, .excludes_min = true}), "greater than 0");
  EXPECT_EQ(phrase_of({.min = 0}), "0 or greater");
  EXPECT_EQ(phrase_of({.min = -64, .max = 64, .unit = "stops"}), "between -64 and 64 stops");
  EXPECT_EQ(phrase_of(ranges::kNotZero), "other than 0");
  EXPECT_EQ(phrase_of(ranges::kAny), "a number");
}

std::string refusal(const Material& material) {
  SceneDescription scene;
  const auto checked = check_materials({material}, scene);
  return checked ? std::string() : checked.error().message;
}

// Whoever describes the scene.
TEST(Validation, HasTheRangesOfSceneFiles) {
  EXPECT_EQ(refusal({"a", Plastic{.ior = 0.5f}}).substr(0, 47),
            "material 'a': ior must be between 1 and 10 (it ");
  EXPECT_EQ(refusal({"a", Plastic{.roughness = 1.5f}}),
            "material 'a': roughness must be between 0 and 1, got 1.5");
  EXPECT_EQ(refusal({"a", Lambert{{{0.5f, 2, 0}}}}),
            "material 'a': albedo must be between 0 and 1, got [0.5, 2, 0]");
  EXPECT_EQ(refusal({"a", Hair{.tilt_degrees = 21}}),
            "material 'a': tilt_degrees must be between -20 and 20, got 21");
  EXPECT_EQ(refusal({"a", Lambert{{{1, 1, 1}, 0}}}), "material 'a': albedo: there is no such texture");
  EXPECT_EQ(refusal({.name = "a", .model = Lambert{}, .light_group = "a.b"}),
            "material 'a': group must be 1 to 64 letters, digits, '_' and '-', got 'a.b'");
  EXPECT_EQ(refusal({"a", Disney{.sheen = 2}}), "material 'a': sheen must be between 0 and 1, got 2");
  EXPECT_EQ(refusal({.name = "a", .model = Lambert{}, .light_group = "lamps"}), "");
  EXPECT_EQ(refusal({"a", Lambert{}}), "");
}

TEST(Validation, ClampsToTheRanges) {
  Material material{"a", Glass{.ior = 0.5f, .reflectance = {{2, 0.5f, -1}}, .transmittance = {{2, 2, 2}, 0}}};
  EXPECT_EQ(clamp_to_ranges(material), (std::vector<std::string_view>{"ior", "reflectance"}));
  const auto& glass = std::get<Glass>(material.model);
  EXPECT_EQ(glass.ior.value, 1);
  EXPECT_EQ(glass.reflectance.value, (Rgb{1, 0.5f, 0}));
  EXPECT_EQ(glass.transmittance.value, (Rgb{2, 2, 2}));  // the factor of a texture
  EXPECT_TRUE(clamp_to_ranges(material).empty());
}

}  // namespace
}  // namespace tessera::core
