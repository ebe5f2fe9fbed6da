// SPDX-License-Identifier: Apache-2.0
#include "server/scaling/scaler_service.hpp"

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>

namespace tessera::scaling {
namespace {

// How long a caller that has left may hold its thread.
constexpr std::chrono::milliseconds kLookForCaller{500};
constexpr double kMaxTarget = 1e9;

// Empty if it is no positive number.
std::optional<double> read_target(const externalscaler::ScaledObjectRef& object) {
  const auto found = object.scalermetadata().find(ScalerService::kTargetKey);
  if (found == object.scalermetadata().end()) return ScalerService::kDefaultTarget;
  const std::string& text = found->second;
  double target = 0;
  const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), target);
  const bool is_number = wrong == std::errc() && end == text.data() + text.size();
  if (!is_number || !(target > 0 && target <= kMaxTarget)) return std::nullopt;
  return target;
}

std::int64_t rounded_up(double value) {
  return static_cast<std::int64_t>(std::ceil(value));
}

}  // namespace

grpc::Status ScalerService::IsActive(grpc::ServerContext*, const externalscaler::ScaledObjectRef*,
                                     externalscaler::IsActiveResponse* response) {
  response->set_result(board_.latest().has_work);
  return grpc::Status::OK;
}

grpc::Status ScalerService::StreamIsActive(grpc::ServerContext* context,
                                           const externalscaler::ScaledObjectRef*,
                                           grpc::ServerWriter<externalscaler::IsActiveResponse>* writer) {
  const bool admitted = ++streams_ <= kMaxStreams;
  if (admitted) send_changes(*context, *writer);
  --streams_;
  if (admitted) return grpc::Status::OK;
  return {grpc::StatusCode::RESOURCE_EXHAUSTED,
          fmt::format("{} callers follow this scaler already: let one of them end", kMaxStreams)};
}

void ScalerService::send_changes(grpc::ServerContext& context,
                                 grpc::ServerWriter<externalscaler::IsActiveResponse>& writer) {
  std::optional<bool> told;
  while (!context.IsCancelled() && !board_.is_closed()) {
    const bool has_work = board_.latest().has_work;
    externalscaler::IsActiveResponse response;
    response.set_result(has_work);
    if (told != has_work && !writer.Write(response)) return;
    told = has_work;
    board_.wait_for_change(has_work, kLookForCaller);
  }
}

grpc::Status ScalerService::GetMetricSpec(grpc::ServerContext*,
                                          const externalscaler::ScaledObjectRef* request,
                                          externalscaler::GetMetricSpecResponse* response) {
  const auto target = read_target(*request);
  if (!target)
    return {grpc::StatusCode::INVALID_ARGUMENT,
            fmt::format("{}: must be a positive number of seconds", kTargetKey)};
  externalscaler::MetricSpec& spec = *response->add_metricspecs();
  spec.set_metricname(kMetric);
  spec.set_targetsize(rounded_up(*target));
  spec.set_targetsizefloat(*target);
  return grpc::Status::OK;
}

grpc::Status ScalerService::GetMetrics(grpc::ServerContext*, const externalscaler::GetMetricsRequest*,
                                       externalscaler::GetMetricsResponse* response) {
  const double seconds = board_.latest().worker_seconds;
  externalscaler::MetricValue& value = *response->add_metricvalues();
  value.set_metricname(kMetric);
  value.set_metricvalue(rounded_up(seconds));
  value.set_metricvaluefloat(seconds);
  return grpc::Status::OK;
}

}  // namespace tessera::scaling
