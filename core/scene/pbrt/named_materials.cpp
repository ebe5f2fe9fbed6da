// SPDX-License-Identifier: Apache-2.0
// Materials by name. Names may be used before they are defined, so that mixtures wait for their parts.
#include <fmt/format.h>

#include <utility>

#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/materials.hpp"

namespace tessera::core::pbrt {

bool Materials::set_name(const std::string& name, int index) {
  const auto [known, is_new] = names_.emplace(name, index);
  if (is_new) return true;
  Slot& before = slot(known->second);
  const bool is_awaited = before.state == State::kMissing;
  if (is_awaited) {
    before.state = State::kAlias;
    before.alias_of = index;
  }
  known->second = index;
  return is_awaited;
}

int Materials::find(const std::string& name, const Place& place) {
  const auto known = names_.find(name);
  if (known == names_.end()) {
    slots_.emplace_back();
    const int index = static_cast<int>(slots_.size()) - 1;
    slot(index).material.name = name;
    slot(index).uses.push_back(place);
    names_.emplace(name, index);
    return index;
  }
  if (slot(known->second).state == State::kMissing) slot(known->second).uses.push_back(place);
  return known->second;
}

int Materials::resolved(int index) const {
  while (slot(index).state == State::kAlias) index = slot(index).alias_of;
  return index;
}

int Materials::add_waiting(const Parameters& p, const Parts& parts, const std::string& name) {
  slots_.emplace_back();
  Slot& added = slots_.back();
  added.material.name = name;
  added.state = State::kWaiting;
  added.parameters = std::make_unique<Parameters>(p);
  added.parts = parts;
  return static_cast<int>(slots_.size()) - 1;
}

Status Materials::finish() {
  const int gray = default_material();
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Slot& missing = slots_[i];
    if (missing.state != State::kMissing) continue;
    for (const Place& place : missing.uses)
      report_.warn(place, "unknown material " + missing.material.name,
                   fmt::format("there is no material {}; gray is used", in_quotes(missing.material.name)));
    missing.state = State::kAlias;
    missing.alias_of = gray;
  }
  for (std::size_t i = 0; i < slots_.size(); ++i)
    if (auto done = finish(static_cast<int>(i)); !done) return done;
  return {};
}

// Mixes the parts of a mixture before it.
Status Materials::finish(int index, int depth) {
  if (slot(index).state != State::kWaiting) return {};
  const std::unique_ptr<const Parameters> p = std::move(slot(index).parameters);
  slot(index).state = State::kBeingMade;
  const Parts parts = slot(index).parts;
  for (const int named : parts) {
    const int part = resolved(named);
    if (slot(part).state == State::kWaiting && depth < kMaxBlendDepth)
      if (auto done = finish(part, depth + 1); !done) return done;
  }
  p->find("type");
  auto made = make("mix", mix(*p, parts), *p, slot(index).material.name);
  if (!made) return fail(made.error());
  set(index, std::move(*made));
  return {};
}

Materials::Parts Materials::parts_of(const Parameters& p) {
  auto names = p.texts("materials");
  if (names.empty()) names = {p.text("namedmaterial1"), p.text("namedmaterial2")};
  names.resize(2);
  const int first = find(names[0], p.place());
  return {first, find(names[1], p.place())};
}

// The scene's material that is a part of a mixture.
std::uint32_t Materials::part_of_mix(const Parameters& p, int part) {
  part = resolved(part);
  if (!is_made(part)) {
    report_.warn(p.place(),
                 "a mixture of materials is a part of itself, or is nested too deeply; gray is used");
    part = default_material();
  }
  if (is_reversed(part))
    report_.warn(p.place(), "the inside and outside of a dielectric are exchanged, because it is mixed");
  const auto known = parts_.find(part);
  if (known != parts_.end()) return known->second;
  const std::uint32_t index = builder_.add_material(at(part));
  parts_.emplace(part, index);
  return index;
}

Materials::Model Materials::mix(const Parameters& p, const Parts& parts) {
  if (p.texts("materials").size() > 2)
    p.remark("materials", "has more than two names; the first two are mixed");
  if (const Parameter* amount = p.find("amount"); amount != nullptr && amount->type == "float")
    p.number_in("amount", 0.5f, 0, 1);  // remarks on what is clamped
  const std::uint32_t first = part_of_mix(p, parts[0]), second = part_of_mix(p, parts[1]);
  auto weight = baker_.scalar(textures_.number(p, "amount", 0.5f), 1, p.place());
  if (!weight) return fail(weight.error());
  return Blend{first, second, *weight};
}

}  // namespace tessera::core::pbrt
