// SPDX-License-Identifier: Apache-2.0
// Develops the images of jobs, finished or not. Thread-safe; blocks for the disk where films are stored.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/base/error.hpp"
#include "core/image/encode.hpp"
#include "core/image/image.hpp"
#include "server/base/scratch_file.hpp"
#include "server/farm/farm.hpp"
#include "server/jobs/film_reader.hpp"
#include "server/jobs/image_rows.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::jobs {

struct JobImage {
  v1::Job job;  // when copying of the image began, without its bundle
  core::Image image;
};

struct ImageFile {
  v1::Job job;  // as in JobImage
  base::ScratchFile file;
  std::uint64_t size_bytes = 0;
};

class Images {
 public:
  // `folder`: for temporary files.
  Images(farm::Farm& farm, store::JobStore& store, const FilmReader& films, std::filesystem::path folder)
      : farm_(farm), store_(store), films_(films), folder_(std::move(folder)) {}

  // The whole image in memory. Copies it tile by tile, without the state lock. Tiles of a running job may
  // show different moments; those of a done job are all complete.
  core::Result<JobImage> get(const std::string& id, int image = 0);
  // The file that is asked for, written some rows at a time: the image need not fit into memory. The file is
  // on disk. INVALID_ARGUMENT: an unknown format, image, channel or layer, impossible output settings, or a
  // region that is not within the image.
  core::Result<ImageFile> write(const v1::GetImageRequest& request);
  // The memory that write() takes at most. Errors are those of write().
  core::Result<std::uint64_t> bytes_to_write(const v1::GetImageRequest& request);

 private:
  core::Result<ImageSource> find(const std::string& id, std::uint32_t image);
  core::Result<JobImage> develop(const std::string& id, std::uint32_t image);
  core::Result<ImageFile> write_once(const v1::GetImageRequest& request);
  // Repeats `make` if the job has changed so that its image can be of two moments.
  template <typename Made>
  core::Result<Made> make_of_one_moment(const std::string& id,
                                        const std::function<core::Result<Made>()>& make);

  farm::Farm& farm_;
  store::JobStore& store_;
  const FilmReader& films_;
  const std::filesystem::path folder_;
};

}  // namespace tessera::jobs
