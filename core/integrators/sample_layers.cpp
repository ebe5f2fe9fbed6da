// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/sample_layers.hpp"

namespace tessera::core::integrators {
namespace {

const LayerSet kLightLayers = LayerSet{}
                                  .with(Layer::kAlpha)
                                  .with(Layer::kDirect)
                                  .with(Layer::kIndirect)
                                  .with(Layer::kEmission)
                                  .with(Layer::kEnvironment);

}  // namespace

SampleLayers::SampleLayers(const Scene& scene, FilmTile* tile, std::size_t slots)
    : scene_(scene),
      tile_(tile),
      layers_(tile == nullptr ? LayerSet{} : tile->layers),
      sees_surfaces_(layers_.intersects(kSurfaceLayers)),
      parts_(layers_.intersects(kLightLayers) || !layers_.groups.empty() ? slots : 0) {
  divide_by_groups();
  for (std::size_t i = 0; i < kLayerCount; ++i)
    first_planes_[i] = first_plane(layers_, static_cast<Layer>(i));
  for (std::size_t i = 0; i < ids_.size(); ++i)
    if (layers_.has(kCryptoLayers[i])) ids_[i].emplace(tile->rect);
}

void SampleLayers::divide_by_groups() {
  for (std::size_t i = 0; i < layers_.groups.size(); ++i)
    groups_.push_back(
        {index_of_group(scene_.light_groups(), layers_.groups[i]), first_group_plane(layers_, i)});
  if (groups_.empty()) return;
  const std::size_t count = scene_.light_groups().size();
  light_of_groups_.resize(parts_.size() * count);
  for (std::size_t slot = 0; slot < parts_.size(); ++slot)
    parts_[slot].groups = std::span(light_of_groups_).subspan(slot * count, count);
}

void SampleLayers::begin(const Ray& ray, SampleId id, const sampling::Sampler& sampler) {
  rays_.push_back(ray);
  samplers_.push_back(&sampler);
  pixels_.push_back(pixel_of(id));
}

std::uint64_t SampleLayers::add_surfaces() {
  if (rays_.empty()) return 0;
  hits_.resize(rays_.size());
  const std::uint64_t traced = find_first_hits(scene_, rays_, samplers_, hits_);
  for (std::size_t i = 0; i < hits_.size(); ++i)
    if (hits_[i].found) add_surface(pixels_[i], hits_[i], samplers_[i]->film_dither());
  rays_.clear();
  samplers_.clear();
  pixels_.clear();
  return traced;
}

std::uint32_t SampleLayers::pixel_of(SampleId id) const {
  const PixelRect& rect = tile_->rect;
  return static_cast<std::uint32_t>((id.y - rect.y0) * rect.width() + (id.x - rect.x0));
}

void SampleLayers::add_word(Layer layer, std::size_t component, ChannelEncoding encoding, std::size_t pixel,
                            std::uint64_t word) {
  std::uint64_t& sum = tile_->planes[first_planes_[static_cast<std::size_t>(layer)] + component][pixel];
  sum = combine(encoding, sum, word);
}

void SampleLayers::add_color(Layer layer, std::size_t pixel, Rgb value, const std::array<double, 3>& dither) {
  if (layers_.has(layer)) add_to_planes(first_planes_[static_cast<std::size_t>(layer)], pixel, value, dither);
}

void SampleLayers::add_to_planes(std::size_t plane, std::size_t pixel, Rgb value,
                                 const std::array<double, 3>& dither) {
  for (int c = 0; c < 3; ++c) {
    const auto component = static_cast<std::size_t>(c);
    if (!(value[c] > 0)) continue;
    std::uint64_t& sum = tile_->planes[plane + component][pixel];
    sum =
        combine(ChannelEncoding::kSum, sum, to_fixed_point(static_cast<double>(value[c]), dither[component]));
  }
}

void SampleLayers::add_vector(Layer layer, std::size_t pixel, std::span<const float> values) {
  if (!layers_.has(layer)) return;
  for (std::size_t i = 0; i < values.size(); ++i)
    add_word(layer, i, ChannelEncoding::kSigned, pixel, to_signed_word(static_cast<double>(values[i])));
}

void SampleLayers::add_surface(std::uint32_t pixel, const FirstHit& hit,
                               const std::array<double, 3>& dither) {
  add_color(Layer::kAlbedo, pixel, hit.albedo, dither);
  add_vector(Layer::kNormal, pixel, std::array{hit.normal.x, hit.normal.y, hit.normal.z});
  add_vector(Layer::kPosition, pixel, std::array{hit.position.x, hit.position.y, hit.position.z});
  add_vector(Layer::kUv, pixel, std::array{hit.uv.x, hit.uv.y});
  const std::array<std::pair<Layer, std::uint32_t>, 4> nearest{{{Layer::kDepth, 0},
                                                                {Layer::kObjectIndex, hit.object},
                                                                {Layer::kMaterialIndex, hit.material},
                                                                {Layer::kInstanceIndex, hit.instance}}};
  for (const auto& [layer, number] : nearest)
    if (layers_.has(layer))
      add_word(layer, 0, ChannelEncoding::kNearest, pixel, to_nearest_word(hit.depth, number));
  const std::array<std::uint32_t, kCryptoLayers.size()> ids{hit.crypto_object, hit.crypto_material,
                                                            hit.crypto_asset};
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (ids_[i]) ids_[i]->add(pixel, ids[i]);
}

void SampleLayers::add_light(std::uint32_t slot, SampleId id, const sampling::Sampler& sampler) {
  if (parts_.empty()) return;
  const LightParts& parts = parts_[slot];
  const std::size_t pixel = pixel_of(id);
  const auto dither = sampler.film_dither();
  add_color(Layer::kDirect, pixel, parts.direct, dither);
  add_color(Layer::kIndirect, pixel, parts.indirect, dither);
  add_color(Layer::kEmission, pixel, parts.emission, dither);
  add_color(Layer::kEnvironment, pixel, parts.environment, dither);
  for (const auto& [number, plane] : groups_)
    if (number < parts.groups.size()) add_to_planes(plane, pixel, parts.groups[number], dither);
  if (layers_.has(Layer::kAlpha) && !parts.escaped)
    add_word(Layer::kAlpha, 0, ChannelEncoding::kCount, pixel, 1);
}

void SampleLayers::finish() {
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    if (!ids_[i]) continue;
    Planes counted(tile_->planes.size());
    counted[first_planes_[static_cast<std::size_t>(kCryptoLayers[i])]] = ids_[i]->take();
    add_planes(film_layout(layers_), tile_->planes, tile_->rect, counted, tile_->rect);
  }
}

}  // namespace tessera::core::integrators
