// SPDX-License-Identifier: Apache-2.0
// The page, and what of the HTTP API there is for one local render; docs/http-api.md lists it. Nobody needs
// credentials, and nothing can be changed. Thread-safe.
#pragma once

#include <memory>

#include "client/page/local_image.hpp"
#include "client/page/local_job.hpp"
#include "core/http/server.hpp"
#include "core/view/encoded_tiles.hpp"
#include "core/view/stream_budget.hpp"
#include "core/view/thumbnails.hpp"
#include "core/view/tile_source.hpp"
#include "core/view/tile_stream.hpp"

namespace tessera::client {

class LocalApi final : public http::Handler {
 public:
  // `job` must outlive the server.
  LocalApi(const LocalJob& job, std::shared_ptr<view::TileSource> source, ImageHeader header)
      : job_(job), source_(std::move(source)), header_(std::move(header)) {}

  http::Reception receive(const http::Request& request) override;
  http::Response handle(const http::Request& request) override;

 private:
  using Answer = core::Result<http::Response>;

  // Nothing if there is no such path.
  std::optional<Answer> answer(const http::Request& request);
  Answer session() const;
  Answer server() const;
  Answer jobs() const;
  Answer job() const;
  Answer events() const;
  Answer tiles(const http::Request& request);
  Answer pixel(const http::Request& request);
  Answer map();
  Answer image(const http::Request& request);
  Answer thumbnail(const http::Request& request);

  static constexpr std::size_t kCacheBytes = 128 << 20;

  const LocalJob& job_;
  const std::shared_ptr<view::TileSource> source_;
  const ImageHeader header_;
  view::EncodedTiles tiles_{kCacheBytes};
  view::StreamBudget budget_{};
  view::StreamSettings streams_{tiles_, budget_};
  view::Thumbnails thumbnails_{};
};

}  // namespace tessera::client
