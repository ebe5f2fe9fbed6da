// SPDX-License-Identifier: Apache-2.0
// Somebody who sees the film of a local render while it grows, such as the page of --view.
#pragma once

#include <mutex>

#include "core/film/film.hpp"
#include "core/scene/settings.hpp"

namespace tessera::client {

class RenderObserver {
 public:
  virtual ~RenderObserver() = default;

  // The render begins. The film may have samples already (--resume). It stays at its address until end().
  virtual void begin(const core::Film& film, const core::RenderSettings& settings) = 0;
  // Whoever changes the film between begin() and end() holds this mutex meanwhile.
  virtual std::mutex& film_mutex() = 0;
  // These samples were added, for each grid tile in `rect`. Called without the mutex.
  virtual void samples_added(const core::PixelRect& rect, const core::SampleRange& range) = 0;
  // The film is not read after this call. It may be shown again with begin().
  virtual void end() = 0;
};

}  // namespace tessera::client
