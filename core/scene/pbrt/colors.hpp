// SPDX-License-Identifier: Apache-2.0
// Converts colours and spectra of parameters to linear Rec. 709. Spectra are integrated as the format defines
// it (pbrt-v4 file format, "Spectra"; light sources are scaled to luminance 1 unless their colour is RGB).
// Not thread-safe.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/materials/conductor.hpp"
#include "core/materials/dispersion.hpp"
#include "core/scene/pbrt/report.hpp"
#include "core/spectra/color_matching.hpp"

namespace tessera::core::pbrt {

enum class SpectrumRole {
  kIlluminant,  // of a light
  kAlbedo,      // of a surface, at most 1
  kUnbounded,   // a coefficient or an index
};

// An index of refraction, at Fraunhofer's line d.
struct RefractiveIndex {
  float line_d;
  Dispersion dispersion{};
};

class Colors {
 public:
  // The arguments must outlive this object.
  Colors(SceneBuilder& builder, const Report& report) : builder_(builder), report_(report) {}

  // The parameter as a colour. A value that cannot be converted is a gray of 0.5, or 1 for an illuminant,
  // with a warning.
  Rgb color(const Parameters& owner, const Parameter& parameter, SpectrumRole role);
  Rgb color(const Parameters& owner, std::string_view name, SpectrumRole role, Rgb otherwise);
  // An index of refraction. Of a spectrum, it is exact at lines C, d and F.
  RefractiveIndex index(const Parameters& owner, const Parameter& parameter);
  // The complex index of a metal, from its parameters for the real and the imaginary part; copper for those
  // that are not given.
  ComplexIndex metal(const Parameters& owner, std::string_view eta, std::string_view k);

 private:
  using Samples = std::vector<spectra::SpectralSample>;

  std::optional<Rgb> from_spectrum(const Parameters& owner, const Parameter& parameter, SpectrumRole role);
  std::optional<Rgb> from_name(const std::string& name, SpectrumRole role) const;
  // The samples in the parameter or in the file that it names; nullptr if there are none.
  const Samples* samples(const Parameters& owner, const Parameter& parameter);
  const Samples* samples_of_file(const Place& place, const std::string& name);

  SceneBuilder& builder_;
  const Report& report_;
  std::map<std::string, Samples> files_;  // by name; empty if the file cannot be used
  Samples inline_;                        // of the latest parameter
};

}  // namespace tessera::core::pbrt
