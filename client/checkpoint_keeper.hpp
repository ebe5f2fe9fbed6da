// SPDX-License-Identifier: Apache-2.0
// Decides when the checkpoint of a local render is written, kept and removed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/background_task.hpp"
#include "client/notices.hpp"
#include "client/render_checkpoint.hpp"
#include "client/shared_film.hpp"

namespace tessera::client {

struct CheckpointPlan {
  std::string path;
  double interval_seconds = 0;
  bool is_kept = false;    // when the render is complete
  bool continues = false;  // what is in the file has become part of the film
};

class CheckpointKeeper {
 public:
  // Writes the file every so often while the keeper lives, in a thread of its own. A file of the same render
  // with more samples is left alone until this one has as many. Failures become notices. `film` and
  // `notices` must outlive the keeper.
  CheckpointKeeper(CheckpointPlan plan, RenderIdentity render, SharedFilm& film, Notices& notices);

  // After the last sample: writes the final checkpoint, or removes the file if it has served.
  core::Status finish(bool complete);

 private:
  core::Status write();
  void look_at_file();

  const CheckpointPlan plan_;
  const RenderIdentity render_;
  SharedFilm& film_;
  Notices& notices_;
  std::uint64_t samples_in_file_ = 0;
  bool is_foreign_ = false;             // the file is of another render
  std::optional<BackgroundTask> task_;  // the only one that writes while it exists
};

}  // namespace tessera::client
