#include "client/farm/farm.hpp"

#include <fmt/format.h>

#include "proto/status.hpp"

namespace tessera::client {

void add_coordinator_option(CLI::App& command, std::string& address) {
  address = proto::kDefaultCoordinator;
  command.add_option("--coordinator", address, "Where the farm's coordinator listens")
      ->envname(proto::kCoordinatorVariable)
      ->option_text(fmt::format("HOST:PORT [{}]", address));
}

Farm::Farm(std::string address)
    : address_(std::move(address)),
      channel_(proto::open_channel(address_)),
      stub_(v1::RenderService::NewStub(channel_)) {}

core::Error Farm::explain(const grpc::Status& status) const {
  const bool answered = channel_->GetState(false) == GRPC_CHANNEL_READY;
  if (status.error_code() == grpc::StatusCode::UNAVAILABLE && !answered)
    return {core::ErrorCode::kUnavailable,
            fmt::format(
                "no coordinator answers at {}: start one with 'tessera-coordinator', or say where it is with "
                "--coordinator HOST:PORT or {}",
                address_, proto::kCoordinatorVariable)};
  if (status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED)
    return {
        core::ErrorCode::kDeadlineExceeded,
        fmt::format("the coordinator at {} did not answer in time: try again, or look at its log", address_)};
  return proto::error_from_grpc(status);
}

}  // namespace tessera::client
