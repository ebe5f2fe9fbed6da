// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/colors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/files.hpp"
#include "core/spectra/color_space.hpp"
#include "core/spectra/spectrum_color.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr std::size_t kMaxSamples = 1'000'000;

Rgb clamped(Rgb color) {
  const auto share = [](float c) { return std::clamp(c, 0.0f, 1.0f); };
  return {share(color.r), share(color.g), share(color.b)};
}

Rgb not_negative(Rgb color) {
  return {std::max(color.r, 0.0f), std::max(color.g, 0.0f), std::max(color.b, 0.0f)};
}

// Indices and Abbe numbers at line d (Schott's data sheets), by both of the names that glasses have.
struct NamedGlass {
  std::string_view name;
  float index, abbe_number;
};
constexpr NamedGlass kGlasses[] = {{"glass-BK7", 1.5168f, 64.17f},    {"glass-BAF10", 1.67003f, 47.11f},
                                   {"glass-FK51A", 1.48656f, 84.47f}, {"glass-LASF9", 1.85025f, 32.17f},
                                   {"glass-F5", 1.67271f, 32.25f},    {"glass-SF5", 1.67271f, 32.25f},
                                   {"glass-F10", 1.72825f, 28.41f},   {"glass-SF10", 1.72825f, 28.41f},
                                   {"glass-F11", 1.78472f, 25.76f},   {"glass-SF11", 1.78472f, 25.76f}};

const NamedGlass* glass_of(std::string_view name) {
  const auto* glass = std::ranges::find(kGlasses, name, &NamedGlass::name);
  return glass != std::end(kGlasses) ? glass : nullptr;
}

// Without dispersion, if the spectrum has none that is normal, or lacks one of the lines.
RefractiveIndex index_of(std::span<const spectra::SpectralSample> spectrum) {
  if (spectrum.front().wavelength_nm > kLineF || spectrum.back().wavelength_nm < kLineC)
    return {static_cast<float>(photopic_mean(spectrum))};
  const double line_d = value_at(spectrum, kLineD);
  const double abbe_number = (line_d - 1) / (value_at(spectrum, kLineF) - value_at(spectrum, kLineC));
  RefractiveIndex index{static_cast<float>(line_d)};
  if (abbe_number >= kMinAbbeNumber && abbe_number <= kMaxAbbeNumber)
    index.dispersion = {1, static_cast<float>(abbe_number)};
  return index;
}

std::optional<ComplexIndex> named_metal(std::string_view name) {
  if (name == "Cu") return complex_index(Conductor::kCopper);
  if (name == "Au") return complex_index(Conductor::kGold);
  if (name == "Ag") return complex_index(Conductor::kSilver);
  if (name == "Al") return complex_index(Conductor::kAluminium);
  if (name == "CuZn") return complex_index(Conductor::kBrass);
  if (name == "MgO") return complex_index(Conductor::kMagnesiumOxide);
  if (name == "TiO2") return complex_index(Conductor::kTitaniumDioxide);
  return std::nullopt;
}

// "metal-Cu-eta" or "metal-Cu-k".
std::optional<Rgb> metal_part(std::string_view name) {
  constexpr std::string_view kPrefix = "metal-";
  if (!name.starts_with(kPrefix)) return std::nullopt;
  name.remove_prefix(kPrefix.size());
  const std::size_t dash = name.rfind('-');
  if (dash == name.npos) return std::nullopt;
  const auto metal = named_metal(name.substr(0, dash));
  const std::string_view part = name.substr(dash + 1);
  if (!metal || (part != "eta" && part != "k")) return std::nullopt;
  return part == "eta" ? metal->eta : metal->k;
}

std::optional<spectra::Chromaticity> named_light(std::string_view name) {
  if (name == "illum-acesD60") return spectra::illuminant("D60");
  constexpr std::string_view kPrefix = "stdillum-";
  return name.starts_with(kPrefix) ? spectra::illuminant(name.substr(kPrefix.size())) : std::nullopt;
}

bool is_sound(const std::vector<spectra::SpectralSample>& samples) {
  for (std::size_t i = 1; i < samples.size(); ++i)
    if (!(samples[i].wavelength_nm > samples[i - 1].wavelength_nm)) return false;
  return !samples.empty();
}

Rgb color_of_samples(const std::vector<spectra::SpectralSample>& samples, SpectrumRole role) {
  if (role == SpectrumRole::kIlluminant) return light_color(samples);
  const Rgb factor = factor_color(samples);
  return role == SpectrumRole::kAlbedo ? clamped(factor) : factor;
}

std::optional<Rgb> from_rgb(const Parameter& parameter, SpectrumRole role) {
  const std::vector<float>& v = parameter.floats;
  if (v.size() == 1) return Rgb::gray(v[0]);
  if (v.size() < 3) return std::nullopt;
  if (parameter.type == "xyz")
    return spectra::to_linear_rec709(
        {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])});
  const Rgb rgb{v[0], v[1], v[2]};
  // Indices and coefficients are no colours: their channels stay as they are.
  const bool is_rec709 = parameter.color_space == "srgb" || role == SpectrumRole::kUnbounded;
  const auto to_rec709 = is_rec709 ? std::nullopt : spectra::to_rec709(parameter.color_space);
  return to_rec709 ? (*to_rec709)(rgb) : rgb;
}

// Wavelengths and values in turn; '#' begins a comment.
std::vector<spectra::SpectralSample> parse_samples(std::string_view text) {
  std::vector<spectra::SpectralSample> samples;
  Tokenizer tokens(text);
  std::optional<float> wavelength;
  while (samples.size() < kMaxSamples) {
    const auto token = tokens.next();
    if (!token || !token->is(Token::Kind::kWord)) break;
    const auto number = parse_number(token->text);
    if (!number) return {};
    if (wavelength) samples.push_back({static_cast<double>(*wavelength), static_cast<double>(*number)});
    wavelength = wavelength ? std::nullopt : number;
  }
  return samples;
}

}  // namespace

Rgb Colors::color(const Parameters& owner, std::string_view name, SpectrumRole role, Rgb otherwise) {
  const Parameter* parameter = owner.find(name);
  return parameter == nullptr ? otherwise : color(owner, *parameter, role);
}

Rgb Colors::color(const Parameters& owner, const Parameter& parameter, SpectrumRole role) {
  std::optional<Rgb> result;
  if (parameter.type == "rgb" || parameter.type == "color" || parameter.type == "xyz") {
    result = from_rgb(parameter, role);
  } else if (parameter.type == "blackbody" && !parameter.floats.empty() && parameter.floats.front() > 0) {
    result = spectra::blackbody_color(static_cast<double>(parameter.floats.front()));
    if (parameter.floats.size() > 1)
      owner.remark(parameter.name,
                   "has several values; the first one is the temperature, the others are ignored");
  } else if (parameter.type == "spectrum") {
    result = from_spectrum(owner, parameter, role);
  } else if (!parameter.floats.empty() || !parameter.integers.empty()) {
    owner.remark(parameter.name, "is a number, and a colour is expected; the gray of this value is used");
    result = Rgb::gray(*owner.number(parameter.name));
  }
  if (result && is_finite(*result)) {
    const Rgb usable = role == SpectrumRole::kAlbedo ? clamped(*result) : not_negative(*result);
    // Rounding is not told.
    const float tolerance = 1e-3f * std::max(1.0f, max_component(usable));
    for (int channel = 0; channel < 3; ++channel)
      if (std::fabs(usable[channel] - (*result)[channel]) > tolerance)
        owner.remark(parameter.name, role == SpectrumRole::kAlbedo
                                         ? "is outside of the colours from 0 to 1; it is clamped"
                                         : "has negative red, green or blue, which become 0");
    return usable;
  }
  const float gray = role == SpectrumRole::kIlluminant ? 1 : 0.5f;
  report_.warn(owner.place_of(&parameter), "color " + parameter.name,
               fmt::format("the colour {} is not understood; {} is used", in_quotes(parameter.name), gray));
  return Rgb::gray(gray);
}

std::optional<Rgb> Colors::from_spectrum(const Parameters& owner, const Parameter& parameter,
                                         SpectrumRole role) {
  if (!parameter.strings.empty())
    if (const auto known = from_name(parameter.strings.front(), role)) return known;
  const Samples* given = samples(owner, parameter);
  return given == nullptr ? std::nullopt : std::optional(color_of_samples(*given, role));
}

// Of an illuminant without a light, such as the reflectance of a surface, the values are those of its colour.
std::optional<Rgb> Colors::from_name(const std::string& name, SpectrumRole role) const {
  if (const auto light = named_light(name)) {
    const Rgb color = color_of(*light);
    return role == SpectrumRole::kAlbedo ? color / max_component(color) : color;
  }
  if (const auto metal = metal_part(name)) return metal;
  if (const auto* glass = glass_of(name)) return Rgb::gray(glass->index);
  return std::nullopt;
}

const Colors::Samples* Colors::samples(const Parameters& owner, const Parameter& parameter) {
  if (!parameter.strings.empty())
    return samples_of_file(owner.place_of(&parameter), parameter.written.front());
  const std::vector<float>& v = parameter.floats;
  if (v.size() % 2 != 0)
    owner.remark(parameter.name, "has a wavelength without a value at its end, which is ignored");
  inline_.clear();
  for (std::size_t i = 0; i + 2 <= v.size(); i += 2)
    inline_.push_back({static_cast<double>(v[i]), static_cast<double>(v[i + 1])});
  return is_sound(inline_) ? &inline_ : nullptr;
}

const Colors::Samples* Colors::samples_of_file(const Place& place, const std::string& name) {
  auto known = files_.find(name);
  if (known == files_.end()) {
    Samples read;
    const auto path = find_file(builder_, place, name);
    if (!path) {
      report_.warn(place, "spectrum " + name,
                   fmt::format("there is no spectrum {}, nor a file of that name", in_quotes(name)));
    } else if (const auto text = builder_.read(*path)) {
      read = parse_samples(*text);
    }
    if (!is_sound(read)) read.clear();
    known = files_.emplace(name, std::move(read)).first;
  }
  return known->second.empty() ? nullptr : &known->second;
}

RefractiveIndex Colors::index(const Parameters& owner, const Parameter& parameter) {
  constexpr float kDefault = 1.5f;
  if (parameter.type != "spectrum") return {owner.number(parameter.name).value_or(kDefault)};
  if (!parameter.strings.empty())
    if (const auto* glass = glass_of(parameter.strings.front()))
      return {glass->index, {1, glass->abbe_number}};
  if (!parameter.strings.empty())
    if (const auto metal = metal_part(parameter.strings.front())) return {metal->g};
  const Samples* given = samples(owner, parameter);
  if (given != nullptr) return index_of(*given);
  owner.remark(parameter.name, fmt::format("is no spectrum that can be read; {} is used", kDefault));
  return {kDefault};
}

ComplexIndex Colors::metal(const Parameters& owner, std::string_view eta, std::string_view k) {
  const ComplexIndex copper = complex_index(Conductor::kCopper);
  return {color(owner, eta, SpectrumRole::kUnbounded, copper.eta),
          color(owner, k, SpectrumRole::kUnbounded, copper.k)};
}

}  // namespace tessera::core::pbrt
