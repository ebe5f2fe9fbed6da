// SPDX-License-Identifier: Apache-2.0
// The file of an unfinished render: its exact film, and what the render is, so that a later run continues it
// to the same bytes. Stateless. Errors name the file.
//
// It is a block file (core/scene/cache/block_file.hpp), which detects damage. Its values are those of
// CheckpointHeader, then of each grid tile its numbers of samples and its sums, without the high bytes that
// are 0 in all of them. Integers are little-endian.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/shared_film.hpp"
#include "core/scene/cache/scene_digest.hpp"
#include "core/scene/settings.hpp"

namespace tessera::client {

// All that a sample depends on.
struct RenderIdentity {
  std::string version;                  // of Tessera, for messages
  std::string determinism_fingerprint;  // of the release
  core::RenderSettings settings;        // the number of samples may change
  core::SceneDigest scene;
};

// That of a render by this release.
RenderIdentity identity_of(const core::RenderSettings& settings, const core::SceneDigest& scene);

// What of two renders differs so that samples of one are not samples of the other: "the seed is 1, and not
// 0". Empty if nothing does.
std::string difference(const RenderIdentity& of_file, const RenderIdentity& of_render);

struct CheckpointHeader {
  RenderIdentity render;
  RenderTotals totals;
};

struct Checkpoint {
  CheckpointHeader header;
  core::Film film;
};

// The version of the block file: of the format, not of the release.
core::Checksum checkpoint_format();

// Writes the film of this moment and replaces `path` when it is complete and on disk. The film may change
// meanwhile. Takes little memory.
core::Status write_checkpoint(const std::string& path, const RenderIdentity& render, SharedFilm& film);

// Only the header; kNotFound if there is no file.
core::Result<CheckpointHeader> read_checkpoint_header(const std::string& path);

// For a render that goes on. FAILED_PRECONDITION: the checkpoint belongs to another render, or has more
// samples than this one shall have; the message says what differs. DATA_LOSS: it is damaged, or no
// checkpoint. Whatever the file holds, this takes no more memory than the file and a film of this render.
core::Result<Checkpoint> read_checkpoint(const std::string& path, const RenderIdentity& render);
// The same for an open file, which errors call `name`.
core::Result<Checkpoint> read_checkpoint(core::OpenFile file, const std::string& name,
                                         const RenderIdentity& render);

}  // namespace tessera::client
