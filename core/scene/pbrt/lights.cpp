// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/lights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "core/math/elementary.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/files.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr float kMaxRadiance = 1e30f;

float cosine_of_degrees(float degrees) {
  return sin_cos_turns(degrees / 360).cos;
}

// The solid angle of a cone, by the angles at which its falloff ends and starts, weighted by the falloff.
float spot_solid_angle(float outer_degrees, float inner_degrees) {
  const float end = cosine_of_degrees(outer_degrees), start = cosine_of_degrees(inner_degrees);
  return 2 * kPi * ((1 - start) + (start - end) / 2);
}

// Each texel is the mean of its channels.
TextureImage gray_of(const TextureImage& image) {
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(image.width()) * static_cast<std::size_t>(image.height()) * 3);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) values.insert(values.end(), 3, mean(image.texel(x, y)));
  return TextureImage(image.width(), image.height(), std::move(values));
}

// The full angle, in degrees, of a cone around an image with these half sides at a distance of 1.
float full_cone(float across, float upward) {
  constexpr float kMargin = 1.0001f;
  const float half = atan2(std::sqrt(across * across + upward * upward), 1.0f) * (180 / kPi);
  return std::min(180.0f, 2 * half * kMargin);
}

// The luminous power of a light that projects the image with an intensity of 1 times its texels.
double projected_luminance(const TextureImage& image, float across, float upward) {
  double sum = 0;
  const auto place = [](int texel, int texels) {
    return 2 * (static_cast<double>(texel) + 0.5) / texels - 1;
  };
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const double a = place(x, image.width()) * static_cast<double>(across),
                   b = place(y, image.height()) * static_cast<double>(upward);
      const double distance2 = 1 + a * a + b * b;
      sum += static_cast<double>(luminance(image.texel(x, y))) / (distance2 * std::sqrt(distance2));
    }
  const double area = 4 * static_cast<double>(across) * static_cast<double>(upward);
  return sum * area / (static_cast<double>(image.width()) * image.height());
}

Rgb finite_light(Rgb color) {
  const auto channel = [](float c) { return std::isfinite(c) ? std::clamp(c, 0.0f, kMaxRadiance) : 0.0f; };
  return {channel(color.r), channel(color.g), channel(color.b)};
}

}  // namespace

ColorParameter AreaLight::radiance_of(double area) const {
  if (!power || !(area > 0)) return radiance;
  const double sides = two_sided ? 2 : 1;
  ColorParameter scaled = radiance;
  scaled.value = finite_light(
      scaled.value * static_cast<float>(static_cast<double>(*power) / (std::numbers::pi * area * sides)));
  return scaled;
}

Status Lights::add(const std::string& kind, const Parameters& p, const Matrix& to_world) {
  if (kind == "point") {
    add_point(p, to_world);
  } else if (kind == "spot") {
    add_spot(p, to_world);
  } else if (kind == "distant") {
    add_distant(p, to_world);
  } else if (kind == "goniometric") {
    if (auto added = add_goniometric(p, to_world); !added) return added;
  } else if (kind == "projection") {
    if (auto added = add_projection(p, to_world); !added) return added;
  } else if (kind == "infinite") {
    if (auto added = add_infinite(p, to_world); !added) return added;
  } else {
    report_.warn(p.place(), "light " + kind,
                 fmt::format("the light source {} is not known; it is left out", in_quotes(kind)));
    return {};
  }
  // How many samples an old file wants.
  p.find("nsamples"), p.find("samples");
  report_.tell(p, fmt::format("the light source '{}'", kind));
  return {};
}

void Lights::tell_dark(const Parameters& p, std::string_view what) const {
  const std::string text = fmt::format("{} without power does not emit", what);
  report_.warn(p.place(), text, text);
}

// The colour in the image of light of luminance 1, or of the given RGB, times "scale" and "power" (which the
// caller divides by the solid angle).
Rgb Lights::emitted(const Parameters& p, std::string_view name) {
  const Rgb color = colors_.color(p, name, SpectrumRole::kIlluminant, Rgb::gray(1));
  Rgb scale = Rgb::gray(1);
  // Version 3 had a colour here.
  if (const Parameter* given = p.find("scale"))
    scale = given->floats.size() >= 3 ? colors_.color(p, *given, SpectrumRole::kIlluminant)
                                      : Rgb::gray(p.number_in("scale", 1, 0, kMaxRadiance));
  return finite_light(exposure_(color) * scale);
}

void Lights::add_point(const Parameters& p, const Matrix& to_world) {
  PointLightDescription light;
  light.position = to_world.point(p.vector("from", {}));
  light.intensity = emitted(p, "I");
  if (const auto power = p.positive("power"))
    light.intensity = finite_light(light.intensity * (*power / (4 * kPi)));
  builder_.add_light(light, file_place(p.place()));
}

void Lights::add_spot(const Parameters& p, const Matrix& to_world) {
  SpotLightDescription light;
  light.position = to_world.point(p.vector("from", {}));
  light.look_at = to_world.point(p.vector("to", {0, 0, 1}));
  const float outer = p.number_in("coneangle", 30, 0.01f, 90);
  const float width = p.number_in("conedeltaangle", std::min(5.0f, outer), 0, outer);
  light.angle_degrees = 2 * outer;
  light.softness = width / outer;
  light.intensity = emitted(p, "I");
  if (const auto power = p.positive("power"))
    light.intensity = finite_light(light.intensity * (*power / spot_solid_angle(outer, outer - width)));
  if (light.position == light.look_at) {
    report_.warn(p.place(), "a spot light without a direction is left out");
    return;
  }
  builder_.add_light(light, file_place(p.place()));
}

void Lights::add_distant(const Parameters& p, const Matrix& to_world) {
  DirectionalLightDescription light;
  light.direction = to_world.direction(p.vector("to", {0, 0, 1}) - p.vector("from", {}));
  light.irradiance = emitted(p, "L");
  if (const auto illuminance = p.positive("illuminance"))
    light.irradiance = finite_light(light.irradiance * *illuminance);
  if (!(length_squared(light.direction) > 0)) {
    report_.warn(p.place(), "a distant light without a direction is left out");
    return;
  }
  light.direction = normalize(light.direction);
  builder_.add_light(light, file_place(p.place()));
}

Result<std::optional<SceneBuilder::Image>> Lights::image(const Parameters& p, const std::string& file) {
  const Place place = p.place_of(p.find("filename"));
  const auto path = find_file(builder_, place, file);
  if (!path) {
    report_.warn(place, "missing image " + file,
                 fmt::format("the image {} does not exist; even light is used", in_quotes(file)));
    return std::nullopt;
  }
  auto image = builder_.image_file(*path, {ColorSpace::kSrgb, TextureChannel::kColor});
  if (image) return *image;
  if (image.error().code == ErrorCode::kResourceExhausted) return fail(image.error());
  report_.warn(place, "image " + file, image.error().message + "; even light is used");
  return std::nullopt;
}

// The image maps to the sphere by equal areas; the light's y and z axes are exchanged.
Status Lights::add_goniometric(const Parameters& p, const Matrix& to_world) {
  const std::string file = p.file_name("filename");
  PointLightDescription light;
  light.position = to_world.point(p.vector("from", {}));
  light.intensity = emitted(p, "I");
  const auto power = p.positive("power");
  float mean_value = 1;
  if (!file.empty()) {
    auto given = image(p, file);
    if (!given) return fail(given.error());
    Matrix swapped;
    swapped.rows = {{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, 1, 0, 0}}};
    const auto from_world = inverse(to_world * swapped);
    if (!from_world)
      report_.warn(p.place(), "the transformation of a light has no inverse; its image is left out");
    if (*given && from_world) {
      const auto gray = std::make_shared<const TextureImage>(gray_of(***given));
      mean_value = gray->mean().r;
      EnvironmentMap map;
      map.add_image(gray, *from_world, Rgb::gray(1));
      auto pixels =
          builder_.image_pixels("the light of " + file, map.size(), [&] { return map.equirectangular(); });
      if (!pixels) return fail(pixels.error());
      Texture texture;
      texture.image = std::move(*pixels);
      light.texture = builder_.add_texture(texture);
    }
  }
  if (power && mean_value > 0)
    light.intensity = finite_light(light.intensity * (*power / (4 * kPi * mean_value)));
  builder_.add_light(light, file_place(p.place()));
  return {};
}

// The angle of view is that of the shorter side.
Status Lights::add_projection(const Parameters& p, const Matrix& to_world) {
  const std::string file = p.file_name("filename");
  SceneBuilder::Image slide;
  if (file.empty()) {
    report_.warn(p.place(), "a projection light without an image projects white");
  } else {
    auto given = image(p, file);
    if (!given) return fail(given.error());
    slide = given->value_or(nullptr);
  }
  if (!slide) {
    auto white = builder_.image_pixels("white", TextureImage(1, 1, std::vector<float>{1, 1, 1}));
    if (!white) return fail(white.error());
    slide = std::move(*white);
  }
  const Vec3 ahead = to_world.direction({0, 0, 1}), right = to_world.direction({1, 0, 0}),
             up = to_world.direction({0, 1, 0});
  SpotLightDescription light;
  light.position = to_world.point({});
  light.look_at = light.position + normalize(ahead);
  light.intensity = emitted(p, "I");
  const float aspect = static_cast<float>(slide->width()) / static_cast<float>(slide->height());
  const SinCos half = sin_cos_turns(p.number_in("fov", 90, 0.1f, 179) / 720);
  const float shorter = half.sin / half.cos;
  const float across = shorter * std::max(1.0f, aspect), upward = shorter * std::max(1.0f, 1 / aspect);
  light.angle_degrees = full_cone(across, upward);
  light.softness = 0;
  light.image.right = normalize(right) * across;
  light.image.up = normalize(up) * upward;
  if (const auto power = p.positive("power"))
    if (const double own = projected_luminance(*slide, across, upward); own > 0)
      light.intensity = finite_light(light.intensity * static_cast<float>(static_cast<double>(*power) / own));
  Texture texture;
  texture.image = std::move(slide);
  texture.wrap = Wrap::kClamp;
  light.image.texture = builder_.add_texture(texture);
  builder_.add_light(light, file_place(p.place()));
  return {};
}

Status Lights::add_infinite(const Parameters& p, const Matrix& to_world) {
  if (p.has("portal"))
    report_.warn(p.place(),
                 "the portal of an infinite light is not supported; the light comes from all directions");
  std::string file = p.file_name("filename");
  if (file.empty()) file = p.file_name("mapname");  // of version 3
  if (!file.empty()) return add_infinite_image(p, file, to_world);
  Rgb radiance = emitted(p, "L");
  if (const auto illuminance = p.positive("illuminance"))
    radiance = finite_light(radiance * (*illuminance / kPi));
  if (is_black(radiance)) tell_dark(p, "an infinite light");
  environment_.add_constant(radiance);
  return {};
}

Status Lights::add_infinite_image(const Parameters& p, const std::string& file, const Matrix& to_world) {
  Rgb scale = emitted(p, "L");
  auto given = image(p, file);
  if (!given) return fail(given.error());
  const auto from_world = inverse(to_world);
  if (!from_world)
    report_.warn(p.place(), "the transformation of an infinite light has no inverse; even light is used");
  if (!*given || !from_world) {
    environment_.add_constant(scale);
    return {};
  }
  const TextureImage& pixels = ***given;
  if (pixels.width() != pixels.height())
    report_.warn(p.place(),
                 "the image of an infinite light is not square; it is taken for an equirectangular one, as "
                 "of pbrt-v3");
  if (const auto illuminance = p.positive("illuminance"))
    if (const double own = upper_illuminance(pixels); own > 0)
      scale = finite_light(scale * static_cast<float>(static_cast<double>(*illuminance) / own));
  environment_.add_image(**given, *from_world, scale);
  return {};
}

Result<std::shared_ptr<const AreaLight>> Lights::area_light(const std::string& kind, const Parameters& p) {
  AreaLight light;
  if (kind != "diffuse" && kind != "area") {
    report_.warn(p.place(), "area light " + kind,
                 fmt::format("the area light {} is not known; a diffuse one is used", in_quotes(kind)));
  }
  const std::string file = p.file_name("filename");
  const Rgb radiance = emitted(p, "L");
  light.radiance = {radiance, -1};
  if (!file.empty()) {
    auto texture = textures_.image(p, file, false, "clamp");
    if (!texture) return fail(texture.error());
    auto parameter = baker_.color(*texture, kMaxRadiance, p.place());
    if (!parameter) return fail(parameter.error());
    light.radiance = {finite_light(parameter->value * radiance), parameter->texture};
  }
  light.two_sided = p.boolean("twosided", false);
  light.power = p.positive("power");
  if (is_black(light.radiance.value)) tell_dark(p, "an area light");
  if (light.power && light.is_textured()) {
    const auto index = static_cast<std::size_t>(light.radiance.texture);
    const float mean_luminance = luminance(builder_.scene().textures[index].image->mean());
    if (mean_luminance > 0) *light.power /= mean_luminance;
  }
  p.find("nsamples"), p.find("samples");
  report_.tell(p, fmt::format("the area light '{}'", kind));
  return std::make_shared<const AreaLight>(light);
}

}  // namespace tessera::core::pbrt
