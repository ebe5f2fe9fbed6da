// SPDX-License-Identifier: Apache-2.0
// A submission: the message, the blobs that it names, and what the validator makes of them, in this process.
// The first part is a SubmitJobRequest; the others are blobs, whose digests assets get that say none.
#include "server/validator/validate.hpp"
#include "tests/fuzz/farm.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/fuzz/parts.hpp"
#include "tests/support/bundle_files.hpp"

namespace tessera::fuzz::bundle_fuzz {
namespace {

// As validator_process.cpp asks tessera-validator, but for the process.
core::Result<jobs::CheckedScene> ask(const blobs::BlobStore& blobs, const v1::Bundle& bundle,
                                     const v1::RenderOverrides& overrides,
                                     const std::vector<std::int32_t>& frames) {
  validator::ValidateRequest request;
  *request.mutable_bundle() = bundle;
  *request.mutable_overrides() = overrides;
  request.mutable_frames()->Add(frames.begin(), frames.end());
  std::map<std::string, std::string> paths;
  for (const v1::Bundle::Asset& asset : bundle.assets()) {
    const auto digest = proto::from_proto(asset.digest());
    if (digest) paths[asset.path()] = blobs.path(*digest).string();
  }
  core::BundleAssets assets = bundle_at(paths);
  const validator::ValidateResponse response = validator::validate(request, assets, {});
  expect_sendable(response);
  if (response.has_approval())
    return jobs::CheckedScene{response.approval().settings(), response.approval().display()};
  return core::fail(static_cast<core::ErrorCode>(response.refusal().code()), response.refusal().message());
}

void store(const blobs::BlobStore& blobs, std::string_view bytes) {
  auto writer = blobs.write(proto::digest_of(bytes));
  expect(writer && writer->append(bytes) && writer->commit(), "a blob can be stored");
}

void name_blobs(v1::Bundle& bundle, const std::vector<Part>& parts) {
  std::size_t next = 1;
  for (v1::Bundle::Asset& asset : *bundle.mutable_assets()) {
    if (!asset.digest().sha256().empty() || next == parts.size()) continue;
    *asset.mutable_digest() = proto::to_proto(proto::digest_of(parts[next++].bytes));
  }
}

void submit(std::string_view input) {
  const std::vector<Part> parts = parts_of(input);
  v1::SubmitJobRequest request;
  if (!request.ParseFromString(std::string(parts.front().bytes))) return;
  name_blobs(*request.mutable_bundle(), parts);

  const blobs::BlobStore* blobs = nullptr;
  Farm farm([&](const auto& bundle, const auto& overrides, const auto& frames, const auto&) {
    return ask(*blobs, bundle, overrides, frames);
  });
  blobs = &farm.coordinator().blobs();
  for (std::size_t i = 1; i < parts.size(); ++i) store(*blobs, parts[i].bytes);
  const auto job = farm.coordinator().jobs().submit(request, "somebody");
  expect_sendable(job);
  if (job) farm.coordinator().jobs().validate(job->id());
  farm.greet('1');
  farm.reopen();
  expect(farm.is_open(), "what a coordinator has written it can read");
  if (job) expect_sendable(farm.coordinator().jobs().get(job->id()));
}

}  // namespace

TESSERA_FUZZER(bundle, std::string_view input) {
  submit(input);
}

}  // namespace tessera::fuzz::bundle_fuzz
