// SPDX-License-Identifier: Apache-2.0
#include "core/sandbox/file_channel.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "core/sandbox/missing.hpp"

namespace tessera::sandbox {

namespace {

using core::ErrorCode;

constexpr std::int32_t kIsOpen = -1;

// A message of one number, with room for one descriptor.
class Message {
 public:
  explicit Message(std::int32_t number = 0) : number_(number) {
    header_.msg_iov = &content_;
    header_.msg_iovlen = 1;
  }
  Message(const Message&) = delete;
  Message& operator=(const Message&) = delete;

  std::int32_t number() const { return number_; }

  void attach(int descriptor) {
    take_room();
    cmsghdr* const part = CMSG_FIRSTHDR(&header_);
    part->cmsg_level = SOL_SOCKET;
    part->cmsg_type = SCM_RIGHTS;
    part->cmsg_len = CMSG_LEN(sizeof descriptor);
    std::memcpy(CMSG_DATA(part), &descriptor, sizeof descriptor);
  }

  bool send(int socket) {
    return sendmsg(socket, &header_, MSG_NOSIGNAL | MSG_DONTWAIT) == ssize_t{sizeof number_};
  }

  bool receive(int socket) {
    take_room();
    ssize_t count = 0;
    do count = recvmsg(socket, &header_, MSG_CMSG_CLOEXEC);
    while (count < 0 && errno == EINTR);
    return count == ssize_t{sizeof number_};
  }

  // The descriptor that came along.
  core::OpenFile received() {
    const cmsghdr* const part = CMSG_FIRSTHDR(&header_);
    int descriptor = -1;
    if (part != nullptr && part->cmsg_type == SCM_RIGHTS)
      std::memcpy(&descriptor, CMSG_DATA(part), sizeof descriptor);
    return core::OpenFile(descriptor);
  }

 private:
  void take_room() {
    header_.msg_control = room_.data();
    header_.msg_controllen = room_.size();
  }

  std::int32_t number_;
  iovec content_{&number_, sizeof number_};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> room_{};
  msghdr header_{};
};

core::Error describe(std::int32_t code, const std::string& shown) {
  switch (static_cast<ErrorCode>(code)) {
    case ErrorCode::kNotFound:
      return {ErrorCode::kNotFound, shown + " does not exist"};
    case ErrorCode::kDataLoss:
      return {ErrorCode::kDataLoss, shown + " is damaged"};
    default:
      return {static_cast<ErrorCode>(code), shown + " cannot be opened"};
  }
}

}  // namespace

core::Result<FileChannel> FileChannel::create() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return core::fail(system_error("socketpair"));
  return FileChannel{core::OpenFile(ends[0]), core::OpenFile(ends[1])};
}

core::Result<core::OpenFile> open_to_send(const std::string& path) {
  core::OpenFile file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.valid() && errno == ENOENT) return core::fail(ErrorCode::kNotFound, "there is no such file");
  if (!file.valid()) return core::fail(ErrorCode::kPermissionDenied, std::strerror(errno));
  struct stat status {};
  if (::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode))
    return core::fail(ErrorCode::kInvalidArgument, "it is not an ordinary file");
  return file;
}

bool answer_request(const core::OpenFile& channel, const OpenNumbered& open) {
  std::uint32_t number = 0;
  if (recv(channel.get(), &number, sizeof number, MSG_DONTWAIT | MSG_TRUNC) != ssize_t{sizeof number})
    return false;
  const auto file = open(number);
  Message reply(file ? kIsOpen : static_cast<std::int32_t>(file.error().code));
  if (file) reply.attach(file->get());
  return reply.send(channel.get());
}

core::Result<core::OpenFile> request_file(int channel, std::uint32_t number, const std::string& shown) {
  Message reply;
  if (write(channel, &number, sizeof number) != ssize_t{sizeof number} || !reply.receive(channel))
    return core::fail(ErrorCode::kUnavailable, shown + " cannot be opened: nobody sends files");
  core::OpenFile file = reply.received();
  if (reply.number() != kIsOpen) return core::fail(describe(reply.number(), shown));
  if (!file.valid()) return core::fail(ErrorCode::kUnavailable, shown + " cannot be opened: too many files");
  return file;
}

}  // namespace tessera::sandbox
