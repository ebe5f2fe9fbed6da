// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math/elementary.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/realistic_lens.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr int kDefaultWidthPx = 1280, kDefaultHeightPx = 720, kDefaultSpp = 16, kDefaultMaxDepth = 5;
constexpr float kMaxDistance = 1e15f, kMaxWhiteBalanceK = 1e6f;

// May be out of range.
float shutter_seconds(const ViewDirectives& directives) {
  const float close = directives.camera ? directives.camera->parameters.number("shutterclose", 1) : 1;
  return close - shutter_open_s(directives);
}

class ViewConverter {
 public:
  ViewConverter(const ViewDirectives& directives, SceneBuilder& builder, const Report& report)
      : directives_(directives),
        world_from_camera_(directives.world_from_camera),
        settings_(builder.scene().settings),
        builder_(builder),
        report_(report) {}

  Exposure convert();

 private:
  void convert_film();
  void convert_crop(const Parameters& p);
  void convert_filter();
  void convert_sampler();
  void convert_integrator();
  void convert_camera();
  void convert_motion(CameraDescription& camera);
  void focus_lens(const Parameters& p);
  float tangent_of_film() const;
  float tangent_of(const std::string& kind, const Parameters& p) const;
  void convert_lens(const Parameters& p, float world_scale, CameraDescription& camera);
  Exposure exposure() const;
  void tell_all() const;

  // The camera's window on the plane at distance 1 (perspective) or in its own units (orthographic).
  struct Screen {
    float left, right, bottom, top;
  };
  Screen screen(const Parameters& p) const;
  float aspect() const {
    return static_cast<float>(settings_.width_px) / static_cast<float>(settings_.height_px);
  }

  const ViewDirectives& directives_;
  AnimatedMatrix world_from_camera_;
  std::optional<FocusedLens> lens_;  // of the camera "realistic"
  RenderSettings& settings_;
  SceneBuilder& builder_;
  const Report& report_;
};

// Places without a directive name the scene file.
const Parameters& parameters_of(const std::optional<KindAndParameters>& directive,
                                const Parameters& otherwise) {
  return directive ? directive->parameters : otherwise;
}

Exposure ViewConverter::convert() {
  convert_film();
  convert_filter();
  convert_sampler();
  convert_integrator();
  convert_camera();
  const Exposure made = exposure();
  tell_all();
  return made;
}

// At the end: the exposure depends on the film and the camera.
void ViewConverter::tell_all() const {
  const auto tell = [&](const std::optional<KindAndParameters>& directive, std::string_view owner) {
    if (directive) report_.tell(directive->parameters, owner);
  };
  tell(directives_.film, "the film");
  tell(directives_.filter, "the pixel filter");
  tell(directives_.sampler, "the sampler");
  tell(directives_.integrator, "the integrator");
  tell(directives_.camera, "the camera");
}

void ViewConverter::convert_film() {
  settings_.width_px = kDefaultWidthPx;
  settings_.height_px = kDefaultHeightPx;
  if (!directives_.film) return;
  const auto& [kind, p] = *directives_.film;
  if (kind != "rgb" && kind != "image")
    report_.warn(p.place(), fmt::format("the film {} is not supported; an image of colours is rendered",
                                        in_quotes(kind)));
  settings_.width_px = p.integer_in("xresolution", kDefaultWidthPx, 1, kMaxImageSidePx);
  settings_.height_px = p.integer_in("yresolution", kDefaultHeightPx, 1, kMaxImageSidePx);
  convert_crop(p);
  // The name and the format of the output are those of the command line; the diagonal is that of lens files.
  for (const char* known :
       {"filename", "savefp16", "diagonal", "iso", "exposuretime", "whitebalance", "sensor"})
    p.find(known);
}

void ViewConverter::convert_crop(const Parameters& p) {
  const auto clamped = [](double value, int limit) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(limit)));
  };
  const auto pixel = [&](float value, int limit) { return clamped(static_cast<double>(value), limit); };
  const int width = settings_.width_px, height = settings_.height_px;
  PixelRect crop{0, 0, width, height};
  if (const auto bounds = p.four_numbers("pixelbounds"); !bounds.empty())
    crop = {pixel(bounds[0], width), pixel(bounds[2], height), pixel(bounds[1], width),
            pixel(bounds[3], height)};
  if (const auto window = p.four_numbers("cropwindow"); !window.empty()) {
    const auto at = [&](float a, int side) {
      return clamped(std::ceil(static_cast<double>(a) * side), side);
    };
    crop = {at(std::min(window[0], window[1]), width), at(std::min(window[2], window[3]), height),
            at(std::max(window[0], window[1]), width), at(std::max(window[2], window[3]), height)};
  }
  if (crop == PixelRect{0, 0, width, height}) return;
  if (check_crop(crop, width, height)) {
    settings_.crop = crop;
  } else {
    report_.warn(p.place(), "the crop window contains no pixel; the whole image is rendered");
  }
}

// iso, the exposure time and the white balance (pbrt-v4 file format, "Film").
Exposure ViewConverter::exposure() const {
  const Parameters none;
  const Parameters &film = parameters_of(directives_.film, none),
                   &camera = parameters_of(directives_.camera, none);
  const float shutter_s = camera.number("shutterclose", 1) - camera.number("shutteropen", 0);
  if (!(shutter_s > 0))
    camera.remark("shutterclose", "must be after \"shutteropen\"; the exposure is that of one second");
  const float time_s = film.positive("exposuretime").value_or(shutter_s > 0 ? shutter_s : 1);
  const float lens = lens_ ? static_cast<float>(lens_->irradiance) : 1;
  const float ratio = lens * time_s * film.positive("iso").value_or(100) / 100;
  Exposure exposure;
  if (std::isfinite(ratio) && ratio > 0) exposure.imaging_ratio = ratio;
  const std::string sensor = film.text("sensor", "cie1931");
  float kelvin = film.number_in("whitebalance", 0, 0, kMaxWhiteBalanceK);
  if (sensor != "cie1931") {
    report_.warn(film.place(), fmt::format("the sensor {} is not supported; the CIE 1931 observer is used",
                                           in_quotes(sensor)));
    if (kelvin == 0) kelvin = 6500;
  }
  if (kelvin > 0) exposure.white_balance = white_balance(spectra::daylight(static_cast<double>(kelvin)));
  return exposure;
}

void ViewConverter::convert_filter() {
  // The default of pbrt-v4: a Gaussian of standard deviation 0.5, cut off at 1.5.
  settings_.filter = {FilterKind::kGaussian, 1.5f};
  if (!directives_.filter) return;
  const auto& [kind, p] = *directives_.filter;
  float otherwise = 1.5f;
  if (kind == "box") {
    settings_.filter.kind = FilterKind::kBox;
    otherwise = 0.5f;
  } else if (kind == "triangle") {
    settings_.filter.kind = FilterKind::kTent;
    otherwise = 2;
  } else if (kind != "gaussian") {
    report_.warn(p.place(),
                 fmt::format("the pixel filter {} is not supported{}; a Gaussian of radius 1.5 is used",
                             in_quotes(kind),
                             kind == "mitchell" || kind == "sinc"
                                 ? ", because a sum of equal samples cannot have its negative lobes"
                                 : ""));
    for (const Parameter& parameter : p.list()) p.find(parameter.name);
    return;
  }
  const float x = p.positive("xradius").value_or(otherwise), y = p.positive("yradius").value_or(otherwise);
  float radius = (x + y) / 2;
  if (x != y) report_.warn(p.place(), "a pixel filter of two radii is not supported; their mean is used");
  if (kind == "gaussian") {
    // Ours ends at three standard deviations.
    const float sigma = p.positive("sigma").value_or(0.5f);
    if (p.has("alpha")) p.remark("alpha", "is that of pbrt-v3; \"sigma\" is used instead");
    if (std::fabs(3 * sigma - radius) > 0.01f)
      report_.warn(p.place(), "a Gaussian pixel filter is cut off at three standard deviations");
    radius = 3 * sigma;
  }
  if (radius > kMaxFilterRadiusPx)
    report_.warn(p.place(),
                 fmt::format("the radius of the pixel filter is limited to {}", kMaxFilterRadiusPx));
  settings_.filter.radius_px = std::min(radius, kMaxFilterRadiusPx);
}

// All samplers have the same mean; only the number of samples counts.
void ViewConverter::convert_sampler() {
  settings_.spp = kDefaultSpp;
  if (!directives_.sampler) return;
  const auto& [kind, p] = *directives_.sampler;
  constexpr std::string_view kKnown[] = {"halton",     "independent",    "paddedsobol", "sobol",
                                         "stratified", "zsobol",         "pmj02bn",     "random",
                                         "02sequence", "lowdiscrepancy", "maxmindist"};
  if (std::find(std::begin(kKnown), std::end(kKnown), kind) == std::end(kKnown))
    report_.warn(p.place(),
                 fmt::format("the sampler {} is not known; Sobol' points are used", in_quotes(kind)));
  constexpr int kMaxCount = static_cast<int>(kMaxSpp), kMaxStrata = 4096;
  int samples = p.integer_in("pixelsamples", kDefaultSpp, 1, kMaxCount);
  if (kind == "stratified" && (p.has("xsamples") || p.has("ysamples") || !p.has("pixelsamples")))
    samples = p.integer_in("xsamples", 4, 1, kMaxStrata) * p.integer_in("ysamples", 4, 1, kMaxStrata);
  if (samples > kMaxCount)
    report_.warn(p.place(), fmt::format("there are at most {} samples per pixel", kMaxCount));
  settings_.spp = static_cast<std::uint32_t>(std::min(samples, kMaxCount));
  for (const char* known : {"randomization", "jitter", "seed", "dimensions"}) p.find(known);
}

// pbrt's "maxdepth" is the number of segments after the camera ray, as ours.
void ViewConverter::convert_integrator() {
  settings_.max_depth = kDefaultMaxDepth;
  if (!directives_.integrator) return;
  const auto& [kind, p] = *directives_.integrator;
  constexpr std::string_view kSameMean[] = {"path", "volpath", "simplepath", "simplevolpath", "bdpt",
                                            "mlt",  "sppm",    "lightpath",  "randomwalk"};
  if (std::find(std::begin(kSameMean), std::end(kSameMean), kind) == std::end(kSameMean))
    report_.warn(p.place(),
                 fmt::format("the integrator {} is not supported; path tracing is used", in_quotes(kind)));
  const int depth = p.integer("maxdepth", kDefaultMaxDepth);
  if (depth > kMaxDepth) p.remark("maxdepth", fmt::format("is limited to {}", kMaxDepth));
  settings_.max_depth = std::clamp(depth, 1, kMaxDepth);
  if (p.boolean("regularize", false))
    report_.warn(p.place(), "the regularisation of paths is not supported; it is ignored");
  // What changes the noise only.
  for (const char* known :
       {"lightsampler", "lightsamplestrategy", "rrthreshold", "samplelights", "samplebsdf", "sampleallights",
        "mutationsperpixel", "chains", "bootstrapsamples", "sigma", "largestepprobability",
        "photonsperiteration", "radius", "seed", "visualizestrategies", "visualizeweights", "pixelbounds",
        "numiterations", "imagewritefrequency"})
    p.find(known);
}

// The default window has the sides -1 and 1 along the shorter axis of the frame.
ViewConverter::Screen ViewConverter::screen(const Parameters& p) const {
  const float frame = p.positive("frameaspectratio").value_or(aspect());
  Screen screen = frame > 1 ? Screen{-frame, frame, -1, 1} : Screen{-1, 1, -1 / frame, 1 / frame};
  if (const auto window = p.four_numbers("screenwindow"); !window.empty())
    screen = {window[0], window[1], window[2], window[3]};
  const bool is_sound = screen.right > screen.left && screen.top > screen.bottom &&
                        std::isfinite(screen.right - screen.left) &&
                        std::isfinite(screen.top - screen.bottom);
  if (!is_sound) {
    report_.warn(p.place(), "the screen window of the camera has no size; the default is used");
    return {-aspect(), aspect(), -1, 1};
  }
  const float shape = (screen.right - screen.left) / (screen.top - screen.bottom);
  if (std::fabs(shape / aspect() - 1) > 0.01f)
    report_.warn(p.place(), "pixels that are not square are not supported; the height of the image is kept");
  return screen;
}

// The offset of the window's centre, in its widths and heights.
Vec2 shift_of(const Parameters& p, float left, float right, float bottom, float top) {
  const auto limited = [&](float shift) {
    if (std::fabs(shift) > kMaxLensShift)
      p.remark("screenwindow",
               fmt::format("is too far from the axis; its centre is moved to {} widths or heights",
                           kMaxLensShift));
    return std::clamp(shift, -kMaxLensShift, kMaxLensShift);
  };
  return {limited((left + right) / 2 / (right - left)), limited((bottom + top) / 2 / (top - bottom))};
}

// Lengths of the camera are in its own space; lenses are in millimetres, in a space of metres.
void ViewConverter::convert_lens(const Parameters& p, float world_scale, CameraDescription& camera) {
  if (lens_) {
    const double scale = kMetresPerMm * double{world_scale}, furthest = double{kMaxDistance};
    camera.aperture_radius = static_cast<float>(std::clamp(lens_->pupil_radius * scale, 0.0, furthest));
    camera.focus_distance = static_cast<float>(std::clamp(lens_->focus_distance * scale, 1e-20, furthest));
    return;
  }
  const float radius = p.number_in("lensradius", 0, 0, kMaxDistance),
              focus = p.number_in("focaldistance", 1e6f, 1e-20f, kMaxDistance);
  camera.aperture_radius = std::clamp(radius * world_scale, 0.0f, kMaxDistance);
  camera.focus_distance = std::clamp(focus * world_scale, 1e-20f, kMaxDistance);
}

constexpr float kNarrowestFov = 0.01f, kWidestFov = 179.9f;

float tan_half(float degrees) {
  const SinCos half = sin_cos_turns(degrees / 720);
  return half.sin / half.cos;
}

// Half of the field of view came from pbrt-v2.
float fov_of(const Parameters& p) {
  if (p.has("halffov") && !p.has("fov"))
    return 2 * p.number_in("halffov", 45, kNarrowestFov / 2, kWidestFov / 2);
  return p.number_in("fov", 90, kNarrowestFov, kWidestFov);
}

// The tangent of half the field of view along the shorter axis.
float ViewConverter::tangent_of(const std::string& kind, const Parameters& p) const {
  if (lens_) return tangent_of_film();
  if (kind == "perspective") return tan_half(fov_of(p));
  report_.warn(p.place(),
               fmt::format("the camera {} is not known; a perspective one is used", in_quotes(kind)));
  return tan_half(fov_of(p));
}

// The camera stands in the film; rays start at the entrance pupil.
void ViewConverter::focus_lens(const Parameters& p) {
  lens_ = realistic_lens(p, builder_, report_);
  const Matrix forward = translate(0, 0, lens_->pupil_distance * kMetresPerMm);
  world_from_camera_ = world_from_camera_ * AnimatedMatrix{forward, forward};
}

// That of half the shorter side of the film.
float ViewConverter::tangent_of_film() const {
  constexpr float kDiagonalMm = 35;
  const Parameters none;
  const float diagonal_mm = parameters_of(directives_.film, none).positive("diagonal").value_or(kDiagonalMm);
  const float longer = std::max(aspect(), 1 / aspect());
  return diagonal_mm / std::sqrt(1 + longer * longer) / 2 * static_cast<float>(lens_->field);
}

void ViewConverter::convert_motion(CameraDescription& camera) {
  if (!world_from_camera_.moves()) return;
  const auto keys = keyed_transforms(world_from_camera_, directives_.times, shutter_open_s(directives_));
  if (!keys || !animate_camera(*keys, camera, builder_.scene().animation.camera))
    report_.warn(directives_.camera->parameters.place(),
                 "no motion leads from the camera at the start to that at the end; the former counts");
}

void ViewConverter::convert_camera() {
  CameraDescription camera;
  const Parameters none;
  const Parameters& p = parameters_of(directives_.camera, none);
  const std::string kind = directives_.camera ? directives_.camera->kind : "perspective";
  if (kind == "realistic") focus_lens(p);
  const Matrix& to_world = world_from_camera_.start;
  // The format's space of cameras is left-handed.
  camera.mirrored = to_world.determinant() > 0;
  camera.position = to_world.point({});
  const Vec3 forward = to_world.direction({0, 0, 1}), up = to_world.direction({0, 1, 0});
  const Vec3 right = to_world.direction({1, 0, 0});
  const float world_scale = length(forward);
  camera.look_at = look_at_along(camera.position, forward);
  camera.up = up;
  convert_motion(camera);
  const float skew = std::fabs(dot(forward, up)) + std::fabs(dot(forward, right)) + std::fabs(dot(up, right));
  if (skew > 0.01f * world_scale * world_scale || std::fabs(length(up) / world_scale - 1) > 0.01f ||
      std::fabs(length(right) / world_scale - 1) > 0.01f)
    report_.warn(p.place(), "the transformation of the camera scales its axes differently; that is ignored");
  if (kind == "orthographic") {
    const Screen window = screen(p);
    camera.type = CameraType::kOrthographic;
    camera.view_height = (window.top - window.bottom) * length(up);
    camera.lens_shift = shift_of(p, window.left, window.right, window.bottom, window.top);
    convert_lens(p, world_scale, camera);
  } else if (kind == "spherical" || kind == "environment") {
    camera.type = CameraType::kPanoramic;
    if (p.choice("mapping", kind == "spherical" ? "equalarea" : "equirectangular",
                 {"equalarea", "equirectangular"}) != "equirectangular")
      report_.warn(p.place(),
                   "the equal-area mapping of a spherical camera is not supported; it is equirectangular");
    p.find("lensradius"), p.find("focaldistance"), p.find("frameaspectratio"), p.find("screenwindow");
  } else {
    const float tangent = tangent_of(kind, p);
    const Screen window = screen(p);
    const float half_height = tangent * (window.top - window.bottom) / 2;
    camera.vertical_fov_degrees = std::clamp(2 * atan2(half_height, 1.0f) * (180 / kPi), 1e-3f, 179.9f);
    camera.lens_shift = shift_of(p, window.left, window.right, window.bottom, window.top);
    convert_lens(p, world_scale, camera);
  }
  p.find("shutteropen"), p.find("shutterclose");
  if (shutter_seconds(directives_) > kMaxShutterFrames)
    p.remark("shutterclose",
             fmt::format("is limited to {} seconds after \"shutteropen\"", kMaxShutterFrames));
  builder_.set_camera(camera);
  if (is_animated(builder_.scene().animation.camera)) open_shutter(directives_, builder_);
}

}  // namespace

bool shows_emission_only(const ViewDirectives& directives) {
  return directives.integrator &&
         directives.integrator->parameters.integer("maxdepth", kDefaultMaxDepth) <= 0;
}

float shutter_open_s(const ViewDirectives& directives) {
  return directives.camera ? directives.camera->parameters.number("shutteropen", 0) : 0;
}

void open_shutter(const ViewDirectives& directives, SceneBuilder& builder) {
  builder.scene().camera.shutter_close = std::clamp(shutter_seconds(directives), 0.0f, kMaxShutterFrames);
}

Exposure convert_view(const ViewDirectives& directives, SceneBuilder& builder, const Report& report) {
  return ViewConverter(directives, builder, report).convert();
}

}  // namespace tessera::core::pbrt
