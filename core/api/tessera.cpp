// SPDX-License-Identifier: Apache-2.0
#include "core/api/include/tessera/tessera.hpp"

#include <algorithm>
#include <new>
#include <utility>

#include "core/base/available_resources.hpp"
#include "core/base/version.hpp"
#include "core/film/film.hpp"
#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"
#include "core/integrators/render.hpp"
#include "core/scene/loader/loader.hpp"
#include "core/scene/scene.hpp"

namespace tessera {
namespace {

// Number of samples per pixel between two calls of RenderOptions::progress; doubles up to this limit.
constexpr std::uint32_t kMaxSppPerPiece = 16;

template <typename T>
T value_or_throw(core::Result<T> result) {
  if (!result) throw Error(result.error().message);
  return *std::move(result);
}

void check(const core::Status& status) {
  if (!status) throw Error(status.error().message);
}

template <typename Function>
auto with_errors(const Function& function) {
  try {
    return function();
  } catch (const std::bad_alloc&) {
    throw Error("not enough memory");
  }
}

int default_threads() {
  return static_cast<int>(core::available_threads());
}

}  // namespace

std::string version() {
  return std::string(core::version());
}

struct Scene::Impl {
  explicit Impl(core::Scene loaded) : scene(std::move(loaded)) {}

  const core::Scene scene;
  core::integrators::RenderPlans plans{scene};
};

Scene::Scene(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

Scene Scene::load(const std::string& path) {
  return with_errors([&] {
    auto description = value_or_throw(core::load_scene_file(path));
    auto scene = value_or_throw(core::Scene::build(std::move(description), default_threads()));
    return Scene(std::unique_ptr<Impl>(new Impl(std::move(scene))));
  });
}

Image Scene::render(const RenderOptions& options) const {
  return with_errors([&] {
    core::RenderOverrides overrides;
    overrides.width_px = options.width;
    overrides.height_px = options.height;
    overrides.spp = options.spp;
    overrides.seed = options.seed;
    const auto settings = value_or_throw(core::resolve_settings(impl_->scene.settings(), overrides));
    if (options.threads < 0) throw Error("threads must not be negative");
    const int threads = options.threads > 0 ? options.threads : default_threads();
    const core::integrators::RenderPlan plan = impl_->plans.get(settings, threads);
    const core::TileGrid grid(settings.window(), core::kTilePx);
    core::Film film(grid);
    const auto pixel_samples = static_cast<double>(grid.window().pixel_count()) * settings.spp;
    double done = 0;
    std::uint32_t spp = 1;
    for (std::uint32_t begin = 0; begin < settings.spp;
         begin += spp, spp = std::min(2 * spp, kMaxSppPerPiece)) {
      const core::SampleRange range{begin, std::min(begin + spp, settings.spp)};
      for (int tile = 0; tile < grid.tile_count(); ++tile) {
        film.add(core::integrators::render(plan, grid.rect(tile), range, threads));
        done += static_cast<double>(grid.rect(tile).pixel_count()) * range.count();
        if (options.progress && !options.progress(done / pixel_samples)) {
          begin = settings.spp;
          break;
        }
      }
      if (begin == settings.spp) break;
    }
    const core::Image developed = film.develop();
    Image image{developed.width, developed.height, {}};
    image.rgb.reserve(developed.pixels.size() * 3);
    for (const core::Rgb& pixel : developed.pixels)
      image.rgb.insert(image.rgb.end(), {pixel.r, pixel.g, pixel.b});
    return image;
  });
}

void write_image(const Image& image, const std::string& path) {
  with_errors([&] {
    const auto width = static_cast<std::size_t>(std::max(image.width, 0));
    const auto height = static_cast<std::size_t>(std::max(image.height, 0));
    if (width == 0 || height == 0 || image.rgb.size() != width * height * 3)
      throw Error("an image must have height * width * 3 values");
    core::Image linear;
    linear.width = image.width;
    linear.height = image.height;
    linear.pixels.resize(width * height);
    for (std::size_t i = 0; i < linear.pixels.size(); ++i)
      linear.pixels[i] = {image.rgb[3 * i], image.rgb[3 * i + 1], image.rgb[3 * i + 2]};
    const core::ImageFormat format = value_or_throw(core::image_format_from_path(path));
    check(core::check_encodable(format, image.width, image.height));
    check(core::write_file_atomically(path, value_or_throw(core::encode_image(linear, format))));
  });
}

}  // namespace tessera
