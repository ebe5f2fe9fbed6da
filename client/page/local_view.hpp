// SPDX-License-Identifier: Apache-2.0
// The page of a local render (--view): serves it while the render goes on, and as long as it is wanted after.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "client/page/local_api.hpp"
#include "client/page/local_job.hpp"
#include "client/render_observer.hpp"
#include "core/http/server.hpp"
#include "core/view/film_source.hpp"

namespace tessera::client {

// Where --view listens without HOST:PORT: on a free port.
inline constexpr const char* kDefaultViewAddress = "127.0.0.1:0";

class LocalView final : public RenderObserver {
 public:
  // Starts the server. `address`: HOST:PORT; `name`: of the scene; `header`: of the images that are
  // downloaded.
  static core::Result<std::unique_ptr<LocalView>> start(const std::string& address, const std::string& name,
                                                        ImageHeader header,
                                                        const core::DisplaySettings& display);

  // Of the page.
  std::string url() const;
  // Whether others than this machine may reach it.
  bool is_public() const;

  void begin(const core::Film& film, const core::RenderSettings& settings) override;
  std::mutex& film_mutex() override { return source_->film_mutex(); }
  void samples_added(const core::PixelRect& rect, const core::SampleRange& range) override;
  void end() override;

  // Shows the film again, after the end. It must outlive stay().
  void show(const core::Film& film);
  // Blocks until `should_stop`, which is asked a few times a second; then lets go of the film.
  void stay(const std::function<bool()>& should_stop);

 private:
  LocalView(const std::string& name, ImageHeader header, const core::DisplaySettings& display);

  LocalJob job_;
  const std::shared_ptr<view::FilmSource> source_;
  LocalApi api_;
  std::unique_ptr<http::Server> server_;
};

// Shows the page in the user's browser, if there is a desktop and somebody at the terminal. Does not wait.
void open_in_browser(const std::string& url);

}  // namespace tessera::client
