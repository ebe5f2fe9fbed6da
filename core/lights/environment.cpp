#include "core/lights/environment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/math/elementary.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core {
namespace {

// Of the samples, over all that shines alike: a faint sky is found beside a sun brighter by any factor.
constexpr double kUniformDirections = 0.1;

// 1 - cos(theta) where each row of an equirectangular picture begins, and 2 where the last one ends. By the
// sine of half the angle, which does not cancel near the pole.
std::vector<double> rows_below_north_pole(int rows) {
  const auto depth = [rows](int row) {
    const double half_sine =
        static_cast<double>(sin(kPi / 2 * static_cast<float>(row) / static_cast<float>(rows)));
    return 2 * half_sine * half_sine;
  };
  std::vector<double> begin;
  for (int row = 0; row <= rows; ++row) begin.push_back(2 * row <= rows ? depth(row) : 2 - depth(rows - row));
  return begin;
}

// The mean over a texel of what is interpolated linearly between it and its two neighbours.
double mean_over_texel(double before, double here, double after) {
  return (before + 6 * here + after) / 8;
}

// The channels' mean of `image` times `factor` in the mean over each texel, as bilinear interpolation has it:
// 0 only where all of the texel is black. Row-major.
std::vector<double> texel_means(const TextureImage& image, Rgb factor) {
  const auto width = static_cast<std::size_t>(image.width()),
             height = static_cast<std::size_t>(image.height());
  std::vector<double> across(width * height), means(width * height), row(width);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x)
      row[x] = static_cast<double>(mean(factor * image.texel(static_cast<int>(x), static_cast<int>(y))));
    for (std::size_t x = 0; x < width; ++x)
      across[y * width + x] = mean_over_texel(row[(x + width - 1) % width], row[x], row[(x + 1) % width]);
  }
  for (std::size_t y = 0; y < height; ++y) {
    const std::size_t above = y > 0 ? y - 1 : 0, below = std::min(y + 1, height - 1);
    for (std::size_t x = 0; x < width; ++x)
      means[y * width + x] =
          mean_over_texel(across[above * width + x], across[y * width + x], across[below * width + x]);
  }
  return means;
}

template <typename T>
T fraction(T x) {
  using std::floor;
  return x - floor(x);
}

template <typename T>
WordOf<T> cell_of(T coordinate, int cells) {
  const auto count = static_cast<float>(cells);
  return to_word(larger(T(0.0f), smaller(coordinate * count, T(count - 1))));
}

RgbOf<Float8> in_all_lanes(Rgb c) {
  return {c.r, c.g, c.b};
}

}  // namespace

Environment::Environment(Rgb radiance, std::shared_ptr<const TextureImage> image, float rotation_degrees)
    : radiance_(radiance),
      image_(std::move(image)),
      width_(image_ ? image_->width() : 1),
      height_(image_ ? image_->height() : 1),
      turned_(fraction(rotation_degrees / 360)),
      row_begin_(rows_below_north_pole(height_)) {
  auto weights =
      image_ ? texel_means(*image_, radiance_) : std::vector<double>{static_cast<double>(mean(radiance_))};
  double lit = 0;  // the solid angle of all texels that shine
  const auto angle_of = [&](std::size_t i) {
    return solid_angle(static_cast<int>(i / static_cast<std::size_t>(width_)));
  };
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] > 0) lit += angle_of(i);
    radiance_over_sphere_ += weights[i] * angle_of(i);
  }
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (weights[i] > 0)
      weights[i] = angle_of(i) *
                   ((1 - kUniformDirections) * weights[i] / radiance_over_sphere_ + kUniformDirections / lit);
  texels_ = GridDistribution(width_, height_, weights);
  for (int row = 0; row < height_; ++row) per_solid_angle_.push_back(1 / solid_angle(row));
}

double Environment::solid_angle(int row) const {
  const auto r = static_cast<std::size_t>(row);
  return 2 * std::numbers::pi / width_ * (row_begin_[r + 1] - row_begin_[r]);
}

template <typename T>
Vec2Of<T> Environment::uv_of(Vec3Of<T> d) const {
  using std::sqrt;
  constexpr float kInvPi = 1 / kPi;
  const T longitude = atan2(d.x, -d.z), latitude = atan2(d.y, sqrt(d.x * d.x + d.z * d.z));
  return {fraction(0.5f + (longitude * (kInvPi / 2) + turned_)), 0.5f + latitude * kInvPi};
}

Rgb Environment::radiance(Vec3 direction) const {
  return image_ ? radiance_ * image_->bilinear(uv_of(direction), Wrap::kRepeat, Wrap::kClamp) : radiance_;
}

float Environment::pdf(Vec3 direction) const {
  if (!image_) return 1 / (4 * kPi);
  const auto [x, y] = texel_of(uv_of(direction));
  return pdf_of_texel(x, y);
}

template <typename T>
Vec2Of<WordOf<T>> Environment::texel_of(Vec2Of<T> uv) const {
  return {cell_of(uv.x, width_), cell_of(1 - uv.y, height_)};
}

float Environment::pdf_of_texel(std::uint32_t x, std::uint32_t y) const {
  return static_cast<float>(texels_.pmf(static_cast<int>(x), static_cast<int>(y)) * per_solid_angle_[y]);
}

RgbOf<Float8> Environment::radiance_at(Vec2Of<Float8> uv) const {
  std::array<const TextureImage*, kLaneCount> images;
  images.fill(image_.get());
  return in_all_lanes(radiance_) * TextureImage::bilinear(images, uv, true, false);
}

Environment::Seen Environment::see(Vec3Of<Float8> directions) const {
  if (!image_) return {in_all_lanes(radiance_), 1 / (4 * kPi)};
  const Vec2Of<Float8> uv = uv_of(directions);
  const auto [x, y] = texel_of(uv);
  const WordLanes columns(x), rows(y);
  FloatLanes pdf;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    pdf.set(lane, pdf_of_texel(columns[lane], rows[lane]));
  return {radiance_at(uv), pdf.all()};
}

Environment::Place Environment::place(const GridDistribution::Choice& texel) const {
  const auto row = static_cast<std::size_t>(texel.y);
  const double depth =
      row_begin_[row] + (row_begin_[row + 1] - row_begin_[row]) * static_cast<double>(texel.within.y);
  return {(static_cast<float>(texel.x) + texel.within.x) / static_cast<float>(width_),
          static_cast<float>(std::sqrt(depth * (2 - depth))), static_cast<float>(1 - depth),
          static_cast<float>(texel.pmf * per_solid_angle_[row])};
}

template <typename T>
Vec3Of<T> Environment::direction(T along_row, T horizontal, T height) const {
  const auto [sine, cosine] = sin_cos_turns(along_row - 0.5f - turned_);
  return normalize(Vec3Of<T>{horizontal * sine, height, -horizontal * cosine});
}

std::optional<LightSample> Environment::sample(Vec2 u) const {
  const Place found = place(texels_.sample(u));
  const Vec3 wi = direction(found.along_row, found.horizontal, found.height);
  const Rgb arriving = radiance(wi);
  if (is_black(arriving)) return std::nullopt;
  return LightSample{wi, arriving, found.pdf, false, std::nullopt};
}

LightSamples Environment::sample(Vec2Of<Float8> u) const {
  const auto texels = texels_.sample(u);
  FloatLanes along_row, horizontal, height, pdf;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const Place found = place(texels[lane]);
    along_row.set(lane, found.along_row), horizontal.set(lane, found.horizontal);
    height.set(lane, found.height), pdf.set(lane, found.pdf);
  }
  LightSamples samples;
  samples.wi = direction(along_row.all(), horizontal.all(), height.all());
  samples.radiance = image_ ? radiance_at(uv_of(samples.wi)) : in_all_lanes(radiance_);
  samples.found = !is_black(samples.radiance);
  samples.pdf = pdf.all();
  samples.distant = true;
  return samples;
}

double Environment::power(double scene_radius) const {
  return radiance_over_sphere_ * std::numbers::pi * scene_radius * scene_radius;
}

double Environment::irradiance() const {
  return radiance_over_sphere_ / 4;
}

}  // namespace tessera::core
