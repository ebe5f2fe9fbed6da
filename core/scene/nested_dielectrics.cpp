// SPDX-License-Identifier: Apache-2.0
#include "core/scene/nested_dielectrics.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <variant>

#include "core/scene/priorities.hpp"

namespace tessera::core {

void Enclosing::add(std::uint8_t rank) {
  const auto end = materials_.begin() + count_;
  const auto at = std::ranges::lower_bound(materials_.begin(), end, rank, {}, &Counted::rank);
  if (at != end && at->rank == rank) {
    if (at->times < std::numeric_limits<std::uint16_t>::max()) ++at->times;
    return;
  }
  if (at == materials_.end()) return;
  const auto last = count_ < kMaxCount ? end : end - 1;
  std::copy_backward(at, last, last + 1);
  *at = {rank, 1};
  count_ = static_cast<std::uint8_t>(std::min<std::size_t>(count_ + 1u, kMaxCount));
}

void Enclosing::remove(std::uint8_t rank) {
  const auto end = materials_.begin() + count_;
  const auto at = std::ranges::find(materials_.begin(), end, rank, &Counted::rank);
  if (at == end || --at->times > 0) return;
  std::copy(at + 1, end, at);
  materials_[--count_] = {};
}

namespace {

void drop_priority(MaterialModel& model) {
  if (auto* glass = std::get_if<Glass>(&model)) glass->priority = 0;
  if (auto* solid = std::get_if<Principled>(&model)) solid->priority = 0;
}

template <typename Model>
auto* dispersion_in(Model& model) {
  if (auto* glass = std::get_if<Glass>(&model)) return &glass->dispersion;
  return &std::get_if<Principled>(&model)->transmission_dispersion;
}

float index_at(const MaterialModel& model, double line_nm) {
  const float index_d = index_in(model)->value;
  const float inverse_abbe_number = dispersion_in(model)->inverse_abbe_number();
  if (inverse_abbe_number == 0) return index_d;
  return dispersed_index(index_d, inverse_abbe_number, cauchy_abscissa(static_cast<float>(line_nm)));
}

// Of the index `ratio` of a model relative to another one, with the exact difference of lines F and C.
Dispersion relative_dispersion(const MaterialModel& model, const MaterialModel& around, float ratio) {
  const auto ratio_at = [&](double line_nm) { return index_at(model, line_nm) / index_at(around, line_nm); };
  const float spread = ratio_at(kLineF) - ratio_at(kLineC);
  return {.scale = spread, .abbe_number = ratio - 1};
}

// The surface of `material` where `around` is outside.
Material boundary_in(Material material, const Material& around) {
  const float ratio =
      std::clamp(index_in(material.model)->value / index_in(around.model)->value, kMinRelativeIor, kMaxIor);
  *dispersion_in(material.model) = relative_dispersion(material.model, around.model, ratio);
  index_in(material.model)->value = ratio;
  material.media.exterior = around.media.interior;
  return material;
}

}  // namespace

NestedDielectrics::NestedDielectrics(std::vector<Material>& materials) {
  std::vector<std::uint32_t> nested;
  for (std::uint32_t i = 0; i < materials.size(); ++i)
    if (priority_of(materials[i].model) > 0) nested.push_back(i);
  if (nested.empty()) return;
  assert(nested.size() <= kMaxNestedDielectrics);
  std::ranges::stable_sort(nested, std::ranges::greater(),
                           [&](std::uint32_t i) { return priority_of(materials[i].model); });
  ranks_.assign(materials.size(), kNone);
  for (std::size_t rank = 0; rank < nested.size(); ++rank) {
    ranks_[nested[rank]] = static_cast<std::uint8_t>(rank);
    boundaries_.push_back(static_cast<std::uint32_t>(materials.size()));
    Material alone = materials[nested[rank]];
    drop_priority(alone.model);
    materials.push_back(alone);
    for (std::size_t around = rank + 1; around < nested.size(); ++around)
      materials.push_back(boundary_in(alone, materials[nested[around]]));
  }
}

Enclosing NestedDielectrics::outside_of(std::uint32_t material, Enclosing inside) const {
  inside.remove(rank_of(material));
  return inside;
}

Enclosing NestedDielectrics::inside_of(std::uint32_t material, Enclosing outside) const {
  outside.add(rank_of(material));
  return outside;
}

std::optional<std::uint32_t> NestedDielectrics::boundary(std::uint32_t material,
                                                         const Enclosing& outside) const {
  const std::uint8_t rank = rank_of(material);
  if (outside.empty()) return boundaries_[rank];
  if (outside.first() <= rank) return std::nullopt;
  return boundaries_[rank] + (outside.first() - rank);
}

}  // namespace tessera::core
