// SPDX-License-Identifier: Apache-2.0
// What workers and users say to a coordinator, in any order: each part of the input is one message or event,
// named by its part (parts.hpp). After every one the coordinator's invariants hold, and every answer can be
// sent.
#include "proto/convert.hpp"
#include "proto/tile_codec.hpp"
#include "tessera/v1/render_service.pb.h"
#include "tests/fuzz/farm.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/fuzz/parts.hpp"

namespace tessera::fuzz::farm_fuzz {
namespace {

void spell_out(v1::SynchronizeRequest& request) {
  request.set_worker_id(id_of(request.worker_id()));
  for (v1::Lease& lease : *request.mutable_held()) lease.set_job_id(id_of(lease.job_id()));
  if (!request.has_rendering()) return;
  request.mutable_rendering()->set_job_id(id_of(request.rendering().job_id()));
}

// Sums are made of nothing but their number, so that small inputs can deliver whole tiles, and of what stands
// as the compressed sums, so that workers can deliver different ones.
void spell_out(v1::SubmitResultRequest& request) {
  request.set_worker_id(id_of(request.worker_id()));
  request.set_job_id(id_of(request.job_id()));
  for (v1::RenderedItem& item : *request.mutable_items()) {
    const auto work = proto::from_proto(item.item());
    if (!work || work->rect.width() > core::kTilePx || work->rect.height() > core::kTilePx) continue;
    core::FilmTile tile = tile_of(work->rect, work->range);
    if (!item.sums_zstd().empty()) tile.sums.front() += static_cast<unsigned char>(item.sums_zstd().front());
    item = proto::encode_tile(tile);
  }
}

void do_to_job(Farm& farm, const Part& part) {
  server::Coordinator& coordinator = farm.coordinator();
  v1::CancelJobRequest request;
  request.set_job_id(std::string(part.bytes));
  if (!request.ParseFromString(request.SerializeAsString())) return;  // no text: gRPC refuses it
  const std::string id = id_of(request.job_id());
  if (part.name == "pause") expect_sendable(coordinator.jobs().pause(id));
  if (part.name == "resume") expect_sendable(coordinator.jobs().resume(id));
  if (part.name == "cancel") expect_sendable(coordinator.jobs().cancel(id));
  if (part.name == "delete") expect_told(coordinator.jobs().remove(id));
  if (part.name == "image") expect_told(coordinator.images().get(id));
  if (part.name == "blob lost") {
    coordinator.jobs().blob_is_lost(proto::digest_of(part.bytes),
                                    {core::ErrorCode::kNotFound, "it is not there"});
  }
}

void do_part(Farm& farm, const Part& part) {
  const std::string bytes(part.bytes);
  server::Coordinator& coordinator = farm.coordinator();
  v1::SynchronizeRequest synchronize;
  v1::SubmitResultRequest result;
  v1::SubmitJobRequest submission;
  v1::ExtendJobRequest extension;
  if (part.name == "sync" && synchronize.ParseFromString(bytes)) {
    spell_out(synchronize);
    farm.sign(synchronize);
    farm.synchronize(synchronize);
  } else if (part.name == "result" && result.ParseFromString(bytes)) {
    spell_out(result);
    farm.sign(result);
    expect_sendable(coordinator.dispatcher().submit_result(result));
  } else if (part.name == "submit" && submission.ParseFromString(bytes)) {
    const auto job = coordinator.jobs().submit(submission, "somebody");
    expect_sendable(job);
    if (job) coordinator.jobs().validate(job->id());
  } else if (part.name == "extend" && extension.ParseFromString(bytes)) {
    expect_sendable(coordinator.jobs().extend(id_of(extension.job_id()), extension.spp()));
  } else if (part.name == "wait") {
    farm.wait(std::chrono::milliseconds(250) * static_cast<int>(bytes.size()));
  } else if (part.name == "checkpoint") {
    expect_told(coordinator.checkpointer().checkpoint());
  } else if (part.name == "restart") {
    farm.reopen();
    expect(farm.is_open(), "what a coordinator has written it can read");
  } else {
    do_to_job(farm, part);
  }
}

void feed(std::string_view input) {
  Farm farm;
  expect(farm.is_open(), "an intact state folder is taken up");
  farm.greet('1');
  int parts = 0;
  for (const Part& part : parts_of(input)) {
    if (++parts > 32) break;
    do_part(farm, part);
    farm.wait(std::chrono::seconds(1));  // checks the invariants
  }
  for (const v1::Job& job : listed(farm)) expect_sendable(job);
  for (const auto& worker : farm.coordinator().dispatcher().workers()) expect_sendable(worker);
}

}  // namespace

TESSERA_FUZZER(farm, std::string_view input) {
  feed(input);
}

}  // namespace tessera::fuzz::farm_fuzz
