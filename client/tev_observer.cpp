// SPDX-License-Identifier: Apache-2.0
#include "client/tev_observer.hpp"

#include <fmt/format.h>

#include <chrono>
#include <exception>
#include <utility>

#include "core/film/develop.hpp"

namespace tessera::client {
namespace {

// Tiles that change again within this time are sent once.
constexpr double kSecondsBetweenRounds = 0.1;

}  // namespace

TevObserver::TevObserver(std::string address, std::string image, Notices& notices)
    : address_(std::move(address)), image_{.name = std::move(image)}, notices_(notices) {}

void TevObserver::begin(const core::Film& film, const core::RenderSettings&) {
  film_ = &film;
  image_ = {std::move(image_.name), film.grid().width(), film.grid().height(),
            core::image_channels(film.layers())};
  changed_.assign(static_cast<std::size_t>(film.grid().tile_count()), false);
  has_ended_ = false;
  thread_ = std::thread([this] {
    try {
      run();
    } catch (const std::exception& error) {
      notices_.add(fmt::format("tev gets no more tiles: {}", error.what()));
    }
  });
}

void TevObserver::samples_added(const core::PixelRect& rect, const core::SampleRange&) {
  const core::TileGrid& grid = film_->grid();
  const std::lock_guard lock(mutex_);
  for (int y = rect.y0; y < rect.y1; y += grid.tile_px())
    for (int x = rect.x0; x < rect.x1; x += grid.tile_px())
      changed_[static_cast<std::size_t>(grid.tile_at(x, y))] = true;
  has_changes_ = true;
  news_.notify_one();
}

void TevObserver::end() {
  {
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
    news_.notify_one();
  }
  thread_.join();
  tev_.reset();
}

void TevObserver::run() {
  bool continues = true;
  while (continues) {
    if (!tev_ && !connect()) {
      continues = rest(kTevRetrySeconds);
      continue;
    }
    continues = wait_for_work();
    for (const int tile : take_changed()) {
      const core::Status sent = send_tile(tile);
      if (!sent) disconnect(sent.error());
      if (!sent) break;
    }
    if (continues) continues = rest(kSecondsBetweenRounds) || tev_.has_value();
  }
}

bool TevObserver::connect() {
  auto tev = TevConnection::open(address_);
  if (!tev) {
    disconnect(tev.error());
    return false;
  }
  tev_.emplace(std::move(*tev));
  const core::Status created = tev_->send(tev_create_image(image_));
  if (!created) disconnect(created.error());
  mark_all();
  return tev_.has_value();
}

void TevObserver::disconnect(const core::Error& why) {
  tev_.reset();
  notices_.add(why.message);
}

// False at the end, when what has changed is to be sent for the last time.
bool TevObserver::wait_for_work() {
  std::unique_lock lock(mutex_);
  news_.wait(lock, [this] { return has_changes_ || has_ended_; });
  return !has_ended_;
}

// Whether the render goes on after that time.
bool TevObserver::rest(double seconds) {
  std::unique_lock lock(mutex_);
  return !news_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return has_ended_; });
}

std::vector<int> TevObserver::take_changed() {
  const std::lock_guard lock(mutex_);
  std::vector<int> tiles;
  for (std::size_t tile = 0; tile < changed_.size(); ++tile)
    if (changed_[tile]) tiles.push_back(static_cast<int>(tile));
  changed_.assign(changed_.size(), false);
  has_changes_ = false;
  return tiles;
}

void TevObserver::mark_all() {
  const std::lock_guard lock(mutex_);
  changed_.assign(changed_.size(), true);
  has_changes_ = true;
}

core::Status TevObserver::send_tile(int tile) {
  const core::PixelRect rect = film_->grid().rect(tile), window = film_->grid().window();
  core::Film::TileSums sums;
  {
    const std::lock_guard lock(film_mutex_);
    sums = film_->tile(tile);
  }
  if (sums.samples == 0) return {};
  std::vector<float> values(rect.pixel_count() * image_.channels.size());
  core::develop_layers(film_->layers(), rect, sums, values);
  const core::PixelRect in_image{rect.x0 - window.x0, rect.y0 - window.y0, rect.x1 - window.x0,
                                 rect.y1 - window.y0};
  return tev_->send(tev_update_image(image_, in_image, values));
}

}  // namespace tessera::client
