// SPDX-License-Identifier: Apache-2.0
#include "server/http/read_json.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/suggestion.hpp"
#include "core/image/display.hpp"
#include "core/scene/settings.hpp"
#include "proto/blob.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "proto/state_text.hpp"
#include "server/base/wall_clock.hpp"
#include "server/farm/wire.hpp"
#include "server/http/fields.hpp"

namespace tessera::http_api {

namespace {

core::Status invalid(const std::string& field, const std::string& problem) {
  return core::fail(proto::invalid_field(field, problem));
}

constexpr std::uint64_t kMaxAgoSeconds = 1'000'000'000;

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
    end = text.find(',', begin);
    parts.push_back(text.substr(begin, end - begin));
  }
  return parts;
}

template <typename Integer>
std::optional<Integer> parse(std::string_view text) {
  Integer value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// One of {path, sha256, bytes}.
core::Status read_file(const std::string& field, const Json& file, std::string* path, v1::Digest& digest) {
  std::string hex;
  std::uint64_t bytes = 0;
  const TakeField take_path = path == nullptr ? text([](const std::string&) {})  // blobs have no names
                                              : text([path](const std::string& value) { *path = value; });
  const core::Status read =
      read_fields(file, field,
                  {{"path", take_path},
                   {"sha256", text([&](const std::string& value) { hex = value; })},
                   {"bytes", integer<std::uint64_t>([&](std::uint64_t value) { bytes = value; })}});
  if (!read) return read;
  const auto parsed = proto::digest_from_hex(hex, bytes);
  if (!parsed) return invalid(field + ".sha256", "must be 64 lower-case hexadecimal digits");
  digest = proto::to_proto(*parsed);
  return {};
}

// `take` is called with each element and its name.
TakeField list(std::function<core::Status(const std::string&, const Json&)> take) {
  return [take = std::move(take)](const std::string& field, const Json& value) -> core::Status {
    if (!value.is_array()) return invalid(field, "must be a list");
    for (std::size_t i = 0; i < value.size(); ++i)
      if (auto taken = take(field + "[" + std::to_string(i) + "]", value[i]); !taken) return taken;
    return {};
  };
}

core::Status read_crop(const std::string& field, const Json& value, v1::PixelRect& rect) {
  const bool is_rect =
      value.is_array() && value.size() == 4 && std::all_of(value.begin(), value.end(), [](const Json& side) {
        return side.is_number_unsigned() && side.get<std::uint64_t>() <= core::kMaxImageSidePx;
      });
  if (!is_rect) return invalid(field, "must be [x0, y0, x1, y1]");
  rect.set_x0(value[0].get<std::uint32_t>());
  rect.set_y0(value[1].get<std::uint32_t>());
  rect.set_x1(value[2].get<std::uint32_t>());
  rect.set_y1(value[3].get<std::uint32_t>());
  return {};
}

// Fields whose text names something.
template <typename FromName, typename Set>
TakeField name_of(FromName from_name, const char* choices, Set set) {
  return [=](const std::string& field, const Json& value) -> core::Status {
    const auto known = value.is_string() ? from_name(value.get<std::string>()) : decltype(from_name("")){};
    if (!known) return invalid(field, std::string("must be one of ") + choices);
    set(*known);
    return {};
  };
}

core::Status read_layers(const std::string& field, const Json& value, v1::LayerSelection& layers) {
  return list(text([&](const std::string& name) { layers.add_names(name); }))(field, value);
}

core::Status read_overrides(const std::string& field, const Json& value, v1::SubmitJobRequest& request) {
  v1::RenderOverrides& overrides = *request.mutable_overrides();
  v1::DisplayOverrides& display = *request.mutable_display();
  return read_fields(
      value, field,
      {{"width", integer<std::uint32_t>([&](std::uint32_t px) { overrides.set_width_px(px); })},
       {"height", integer<std::uint32_t>([&](std::uint32_t px) { overrides.set_height_px(px); })},
       {"spp", integer<std::uint32_t>([&](std::uint32_t spp) { overrides.set_spp(spp); })},
       {"seed", integer<std::uint64_t>([&](std::uint64_t seed) { overrides.set_seed(seed); })},
       {"integrator", name_of(core::integrator_from_name, "naive, nee, mis, whitted",
                              [&](core::Integrator one) { overrides.set_integrator(proto::to_proto(one)); })},
       {"heuristic", name_of(core::heuristic_from_name, "balance, power",
                             [&](core::Heuristic one) { overrides.set_heuristic(proto::to_proto(one)); })},
       {"crop", [&](const std::string& name,
                    const Json& rect) { return read_crop(name, rect, *overrides.mutable_crop()); }},
       {"layers", [&](const std::string& name,
                      const Json& names) { return read_layers(name, names, *overrides.mutable_layers()); }},
       {"clamp_indirect", number([&](float most) { overrides.set_clamp_indirect(most); })},
       {"exposure", number([&](float stops) { display.set_exposure_stops(stops); })},
       {"tone_curve", name_of(core::tone_curve_from_name, "none, aces, agx",
                              [&](core::ToneCurve one) { display.set_tone_curve(proto::to_proto(one)); })}});
}

core::Status read_labels(const std::string& field, const Json& value, v1::SubmitJobRequest& request) {
  if (!value.is_object()) return invalid(field, "must be an object");
  for (const auto& [key, label] : value.items()) {
    if (!label.is_string()) return invalid(field + "." + key, "must be a string");
    (*request.mutable_labels())[key] = label.get<std::string>();
  }
  return {};
}

// Names of states, separated by commas. Passes each to `take`.
template <typename State, typename Take>
core::Status read_states(const http::Request& request, const std::map<std::string, State>& states,
                         const Take& take) {
  const std::string names = request.parameter("state").value_or("");
  if (names.empty()) return {};
  for (const std::string& name : split(names)) {
    const auto known = states.find(name);
    if (known == states.end()) {
      std::vector<std::string_view> all;
      for (const auto& [each, state] : states) all.push_back(each);
      return invalid("state", "there is no state " + core::in_quotes(name) + core::suggestion(name, all));
    }
    take(known->second);
  }
  return {};
}

// The name of no JobState: running jobs that wait for workers.
constexpr auto kQueued = v1::JOB_STATE_UNSPECIFIED;

core::Status read_job_states(const http::Request& request, v1::ListJobsRequest& list) {
  std::map<std::string, v1::JobState> states = proto::job_states_by_name();
  states["queued"] = kQueued;
  return read_states(request, states, [&](v1::JobState state) {
    state == kQueued ? list.set_queued(true) : list.add_states(state);
  });
}

// A time in whole seconds before now, as a time of the coordinator.
core::Status read_ago(const http::Request& request, const std::string& name,
                      const std::function<google::protobuf::Timestamp*()>& time) {
  const auto seconds = read_number(request, name, kMaxAgoSeconds);
  if (!seconds) return core::fail(seconds.error());
  if (*seconds)
    *time() = farm::timestamp_from_ms(base::wall_clock_ms() - static_cast<std::int64_t>(**seconds) * 1000);
  return {};
}

template <typename List>
core::Status read_page(const http::Request& request, List& list) {
  const auto size = read_number(request, "page_size", 1000);
  if (!size) return core::fail(size.error());
  list.set_page_size(static_cast<std::uint32_t>(size->value_or(0)));
  list.set_page_token(request.parameter("page_token").value_or(""));
  return {};
}

core::Status read_display(const http::Request& request, v1::DisplayOverrides& display) {
  if (const auto text = request.parameter("exposure"); text && !text->empty()) {
    const auto stops = parse<float>(*text);
    if (!stops) return invalid("exposure", "must be a number");
    display.set_exposure_stops(*stops);
  }
  if (const auto text = request.parameter("tone_curve"); text && !text->empty()) {
    const auto curve = core::tone_curve_from_name(*text);
    if (!curve) return invalid("tone_curve", "must be one of none, aces, agx");
    display.set_tone_curve(proto::to_proto(*curve));
  }
  return {};
}

}  // namespace

core::Result<Json> read_body(const std::string& body) {
  if (body.empty()) return Json::object();
  Json json = Json::parse(body, nullptr, false);
  if (json.is_object()) return json;
  return core::fail(core::ErrorCode::kInvalidArgument, "the body must be a JSON object");
}

// The protocol wants the files in the order of their paths.
core::Result<v1::SubmitJobRequest> read_submission(const Json& body) {
  v1::SubmitJobRequest request;
  std::vector<std::pair<std::string, v1::Digest>> files;
  const auto take_file = [&](const std::string& field, const Json& value) {
    auto& [path, digest] = files.emplace_back();
    return read_file(field, value, &path, digest);
  };
  const core::Status read = read_fields(
      body, "",
      {{"request_id", text([&](const std::string& id) { request.set_request_id(id); })},
       {"name", text([&](const std::string& name) { request.set_name(name); })},
       {"scene_path", text([&](const std::string& path) { request.mutable_bundle()->set_scene_path(path); })},
       {"files", list(take_file)},
       {"overrides",
        [&](const std::string& field, const Json& value) { return read_overrides(field, value, request); }},
       {"frames", list(integer<std::int32_t>([&](std::int32_t frame) { request.add_frames(frame); }))},
       {"priority", integer<std::int32_t>([&](std::int32_t priority) { request.set_priority(priority); })},
       {"max_workers", integer<std::uint32_t>([&](std::uint32_t most) { request.set_max_workers(most); })},
       {"labels",
        [&](const std::string& field, const Json& value) { return read_labels(field, value, request); }}});
  if (!read) return core::fail(read.error());
  std::stable_sort(files.begin(), files.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (auto& [path, digest] : files) {
    v1::Bundle::Asset& asset = *request.mutable_bundle()->add_assets();
    asset.set_path(std::move(path));
    *asset.mutable_digest() = std::move(digest);
  }
  return request;
}

core::Result<v1::UpdateJobRequest> read_update(const Json& body) {
  v1::UpdateJobRequest request;
  const core::Status read = read_fields(
      body, "",
      {{"priority", integer<std::int32_t>([&](std::int32_t priority) { request.set_priority(priority); })},
       {"max_workers", integer<std::uint32_t>([&](std::uint32_t most) { request.set_max_workers(most); })}});
  if (!read) return core::fail(read.error());
  return request;
}

core::Result<v1::FindMissingBlobsRequest> read_files(const Json& body) {
  v1::FindMissingBlobsRequest request;
  const auto take_file = [&](const std::string& field, const Json& value) {
    return read_file(field, value, nullptr, *request.add_digests());
  };
  const core::Status read = read_fields(body, "", {{"files", list(take_file)}});
  if (!read) return core::fail(read.error());
  return request;
}

core::Result<std::uint32_t> read_spp(const Json& body) {
  std::uint32_t spp = 0;
  const core::Status read =
      read_fields(body, "", {{"spp", integer<std::uint32_t>([&](std::uint32_t value) { spp = value; })}});
  if (!read) return core::fail(read.error());
  return spp;
}

core::Result<std::string> read_token(const Json& body) {
  std::string token;
  const core::Status read =
      read_fields(body, "", {{"token", text([&](const std::string& value) { token = value; })}});
  if (!read) return core::fail(read.error());
  if (token.empty()) return core::fail(proto::invalid_field("token", "must not be empty"));
  return token;
}

core::Result<v1::DrainWorkerRequest> read_drain(const Json& body) {
  v1::DrainWorkerRequest request;
  const core::Status read = read_fields(body, "",
                                        {{"undo", boolean([&](bool undo) { request.set_undo(undo); })},
                                         {"stop", boolean([&](bool stop) { request.set_stop(stop); })}});
  if (!read) return core::fail(read.error());
  return request;
}

core::Result<v1::ListJobsRequest> read_job_list(const http::Request& request) {
  v1::ListJobsRequest list;
  if (auto read = read_page(request, list); !read) return core::fail(read.error());
  list.set_id_prefix(request.parameter("prefix").value_or(""));
  if (auto read = read_job_states(request, list); !read) return core::fail(read.error());
  if (const auto owner = request.parameter("owner"); owner && !owner->empty()) list.set_owner(*owner);
  if (const auto label = request.parameter("label"); label && !label->empty()) {
    const std::size_t equals = label->find('=');
    if (equals == std::string::npos) return core::fail(proto::invalid_field("label", "must be KEY=VALUE"));
    (*list.mutable_labels())[label->substr(0, equals)] = label->substr(equals + 1);
  }
  return list;
}

core::Result<v1::ListWorkersRequest> read_worker_list(const http::Request& request) {
  v1::ListWorkersRequest list;
  if (auto read = read_page(request, list); !read) return core::fail(read.error());
  list.set_prefix(request.parameter("prefix").value_or(""));
  const core::Status states = read_states(request, proto::worker_states_by_name(),
                                          [&](v1::WorkerState state) { list.add_states(state); });
  if (!states) return core::fail(states.error());
  if (const auto principal = request.parameter("principal"); principal && !principal->empty())
    list.set_principal(*principal);
  if (auto read = read_ago(request, "seen_within", [&] { return list.mutable_seen_from(); }); !read)
    return core::fail(read.error());
  if (auto read = read_ago(request, "unseen_for", [&] { return list.mutable_seen_before(); }); !read)
    return core::fail(read.error());
  return list;
}

core::Result<v1::ListQuarantineRequest> read_quarantine_list(const http::Request& request) {
  v1::ListQuarantineRequest list;
  if (auto read = read_page(request, list); !read) return core::fail(read.error());
  return list;
}

core::Result<v1::GetImageRequest> read_image(const http::Request& request) {
  constexpr std::pair<std::string_view, v1::ImageFormat> kFormats[] = {{"png", v1::IMAGE_FORMAT_PNG},
                                                                       {"exr", v1::IMAGE_FORMAT_EXR},
                                                                       {"hdr", v1::IMAGE_FORMAT_HDR},
                                                                       {"pfm", v1::IMAGE_FORMAT_PFM}};
  v1::GetImageRequest image;
  const std::string name = request.parameter("format").value_or("png");
  for (const auto& [known, format] : kFormats)
    if (name == known) image.set_format(format);
  if (image.format() == v1::IMAGE_FORMAT_UNSPECIFIED)
    return core::fail(proto::invalid_field("format", "must be one of png, exr, hdr, pfm"));
  if (auto read = read_display(request, *image.mutable_display()); !read) return core::fail(read.error());
  const auto region = read_region(request);
  if (!region) return core::fail(region.error());
  if (*region) *image.mutable_region() = **region;
  const auto index = read_image_index(request);
  if (!index) return core::fail(index.error());
  image.set_image(*index);
  image.set_layer(request.parameter("layer").value_or(""));
  return image;
}

core::Result<std::uint32_t> read_image_index(const http::Request& request) {
  const auto index = read_number(request, "image", std::numeric_limits<std::uint32_t>::max());
  if (!index) return core::fail(index.error());
  return static_cast<std::uint32_t>(index->value_or(0));
}

core::Result<std::optional<std::uint64_t>> read_number(const http::Request& request, const std::string& name,
                                                       std::uint64_t max) {
  const auto given = request.parameter(name);
  if (!given || given->empty()) return std::optional<std::uint64_t>();
  const auto value = parse<std::uint64_t>(*given);
  if (value && *value <= max) return std::optional(*value);
  return core::fail(proto::invalid_field(name, "must be an integer from 0 to " + std::to_string(max)));
}

core::Result<std::optional<v1::PixelRect>> read_region(const http::Request& request) {
  const auto given = request.parameter("region");
  if (!given || given->empty()) return std::optional<v1::PixelRect>();
  std::vector<std::uint32_t> sides;
  for (const std::string& part : split(*given))
    if (const auto side = parse<std::uint32_t>(part)) sides.push_back(*side);
  if (sides.size() != 4 || split(*given).size() != 4)
    return core::fail(proto::invalid_field("region", "must be X0,Y0,X1,Y1"));
  v1::PixelRect rect;
  rect.set_x0(sides[0]);
  rect.set_y0(sides[1]);
  rect.set_x1(sides[2]);
  rect.set_y1(sides[3]);
  return std::optional(rect);
}

}  // namespace tessera::http_api
