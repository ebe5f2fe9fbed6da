// SPDX-License-Identifier: Apache-2.0
#include "client/page/local_view.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <thread>
#include <utility>

#include "core/base/host_port.hpp"
#include "core/film/region.hpp"

namespace tessera::client {
namespace {

// One may be busy with a file, and the others still serve the page.
constexpr int kServerThreads = 3;

}  // namespace

LocalView::LocalView(const std::string& name, ImageHeader header, const core::DisplaySettings& display)
    : job_(name, header.record.settings, display),
      source_(std::make_shared<view::FilmSource>(kLocalJobId,
                                                 core::TileGrid(job_.settings().window(), core::kTilePx),
                                                 [this] { return job_.header(); })),
      api_(job_, source_, std::move(header)) {}

core::Result<std::unique_ptr<LocalView>> LocalView::start(const std::string& address, const std::string& name,
                                                          ImageHeader header,
                                                          const core::DisplaySettings& display) {
  std::unique_ptr<LocalView> view(new LocalView(name, std::move(header), display));
  auto server = http::Server::start({.address = address, .threads = kServerThreads}, view->api_);
  if (!server) return core::fail(server.error().within("--view"));
  view->server_ = std::move(*server);
  return view;
}

std::string LocalView::url() const {
  return fmt::format("http://{}/", server_->address());
}

bool LocalView::is_public() const {
  const auto address = core::parse_host_port(server_->address());
  return !address || !core::is_loopback(*address);
}

void LocalView::begin(const core::Film& film, const core::RenderSettings&) {
  job_.begin(film);
  source_->attach(film);
}

void LocalView::samples_added(const core::PixelRect& rect, const core::SampleRange& range) {
  job_.add(std::uint64_t{rect.pixel_count()} * range.count());
  source_->note_change(rect);
}

void LocalView::end() {
  source_->detach();
  job_.end();
  source_->end();
}

void LocalView::show(const core::Film& film) {
  source_->attach(film);
}

void LocalView::stay(const std::function<bool()>& should_stop) {
  constexpr std::chrono::milliseconds kStep{100};
  while (!should_stop()) std::this_thread::sleep_for(kStep);
  source_->detach();
}

}  // namespace tessera::client
