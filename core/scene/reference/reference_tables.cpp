// SPDX-License-Identifier: Apache-2.0
#include "core/scene/reference/reference_tables.hpp"

#include <map>
#include <sstream>
#include <vector>

#include "core/scene/reference/all_tables.hpp"
#include "core/scene/reference/json_layout.hpp"
#include "core/scene/reference/key_json.hpp"

namespace tessera::core {
namespace {

std::string in_code(std::string_view text) {
  return fmt::format("`{}`", text);
}

// A limit with a typographic minus.
std::string limit(double value) {
  const std::string text = limit_text(value);
  return text.front() == '-' ? "−" + text.substr(1) : text;
}

// "0 to 1", "above 0, at most 180".
std::string numbers(const Range& range) {
  if (!range.has_min() && !range.has_max()) return "a number";
  const std::string min = limit(range.min), max = limit(range.max);
  if (!range.has_max()) return range.excludes_min ? "above " + min : min + " or more";
  if (range.excludes_min)
    return range.excludes_max ? fmt::format("between {} and {}", min, max)
                              : fmt::format("above {}, at most {}", min, max);
  return fmt::format("{} to {}", min, max);
}

std::string colors(const Range& range) {
  if (range.has_max() && range.max == 1) return "colour";
  return range.has_max() ? fmt::format("colour from {} to {}", limit(range.min), limit(range.max))
                         : fmt::format("colour of {} or more", limit(range.min));
}

std::string words(const Domain& domain) {
  std::string text;
  for (const std::string_view word : domain.words)
    text += (text.empty() ? "" : ", ") + in_code(fmt::format("\"{}\"", word));
  return text;
}

std::string_view names(NamesOf kind) {
  if (kind == NamesOf::kTextures) return "a name in `textures`";
  return kind == NamesOf::kMedia ? "a name in `media`" : "a name in `grids`";
}

template <typename Value>
std::string values_of(const Domain& domain) {
  constexpr bool kIsColor = std::same_as<Value, Rgb> || std::same_as<Value, ColorParameter>;
  constexpr bool kHasTexture = std::same_as<Value, ColorParameter> || std::same_as<Value, ScalarParameter>;
  std::string text(domain.values);
  if (text.empty() && !domain.words.empty()) text = words(domain);
  if (text.empty() && domain.names != NamesOf::kNothing) text = names(domain.names);
  if (text.empty() && std::same_as<Value, bool>) text = "`true`, `false`";
  if (text.empty()) text = kIsColor ? colors(domain.range) : numbers(domain.range);
  if (kHasTexture) text += text == "colour" ? " or texture" : ", or texture";
  return text;
}

template <typename Owner, typename Entry>
std::string default_of(const Entry& entry) {
  if (entry.traits.required) return "—";
  if (!entry.traits.otherwise.empty()) return std::string(entry.traits.otherwise);
  const OrderedJson value = default_json<Owner>(entry);
  if (value.is_null()) return "none";
  return value.is_number() ? value.dump() : in_code(json_layout(value));
}

template <typename Owner, typename Entry>
std::string row(const Entry& entry) {
  std::string values;
  if constexpr (MemberOf<Entry, Owner>) {
    values = values_of<std::remove_cvref_t<decltype(entry.of(std::declval<Owner&>()))>>(entry.domain);
  } else {
    values = values_of<void>(entry.domain);
  }
  return fmt::format("| `{}` | {} | {} | {} |\n", entry.name, default_of<Owner>(entry), values,
                     entry.documentation);
}

// Each table, by the line that asks for it.
std::map<std::string, std::string> all_tables() {
  std::map<std::string, std::string> tables;
  for_each_table([&]<typename Owner>(std::type_identity<Owner>, std::string_view name, const auto& table) {
    std::string rows = "| key | default | values | meaning |\n|---|---|---|---|\n";
    for_each(table, [&]<typename Entry>(const Entry& entry) {
      if constexpr (Named<Entry>) rows += row<Owner>(entry);
    });
    tables[fmt::format("<!-- keys of {} -->", name)] = rows;
  });
  return tables;
}

std::string keyframed_keys() {
  std::map<std::string_view, std::string> keys;
  for_each_table([&]<typename Owner>(std::type_identity<Owner>, std::string_view name, const auto& table) {
    const bool is_light = requires(LightDescription & light, Owner owner) {
      light = owner;
    };
    for_each(table, [&]<typename Entry>(const Entry& entry) {
      if constexpr (Named<Entry>) {
        std::string& list = keys[is_light ? "lights" : name];
        const std::string key = in_code(entry.name);
        if (entry.traits.has_keyframes && list.find(key) == std::string::npos)
          list += (list.empty() ? "" : ", ") + key;
      }
    });
  });
  return fmt::format(
      "| part | keys |\n|---|---|\n| `camera` | {} |\n| `lights` | {} |\n"
      "| `materials` | all numbers and colours that may have a texture, also the `tint` and `scale` of a "
      "texture, "
      "the `strength` of a normal map, the `height` of a bump map, and the scale and Abbe number of "
      "dispersion |\n| `media` | {} |\n| `environment` | "
      "{} |\n"
      "| `transform` of a shape | `scale`, `translate`, `rotate`, and `degrees` in `rotate` |\n"
      "| `mesh`, also in objects | {}: the mesh [deforms](#meshes-that-deform) |\n",
      keys["camera"], keys["lights"], keys["medium"], keys["environment"], keys["mesh"]);
}

}  // namespace

std::string update_reference(std::string_view page) {
  auto tables = all_tables();
  tables["<!-- keys that may have keyframes -->"] = keyframed_keys();
  std::istringstream lines{std::string(page)};
  std::string updated;
  bool in_old_table = false;
  for (std::string line; std::getline(lines, line);) {
    in_old_table = in_old_table && line.starts_with('|');
    if (in_old_table) continue;
    updated += line + "\n";
    const auto table = tables.find(line);
    if (table == tables.end()) continue;
    updated += table->second;
    in_old_table = true;
  }
  return updated;
}

}  // namespace tessera::core
