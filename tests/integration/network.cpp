// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/network.hpp"

#include <fcntl.h>
#include <linux/ethtool.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <sched.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <functional>
#include <vector>

#include "tests/integration/processes.hpp"
#include "tests/integration/switch.hpp"

namespace tessera::test {

namespace {

// Runs it in a child process, in the network namespace of `host` unless that is 0.
bool in_network_of(pid_t host, const std::function<bool()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    const std::string path = "/proc/" + std::to_string(host) + "/ns/net";
    if (host != 0 && setns(open(path.c_str(), O_RDONLY | O_CLOEXEC), CLONE_NEWNET) != 0) _exit(1);
    _exit(work() ? 0 : 1);
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

bool run_ip(pid_t host, const std::vector<std::string>& arguments) {
  return in_network_of(host, [&] {
    std::vector<char*> words{const_cast<char*>("ip")};
    for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    execvp("ip", words.data());
    return false;
  });
}

// Makes the interface send frames as on a cable: segmented, and each with its checksum.
bool send_plain_frames(const char* interface) {
  const int any = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  bool done = any >= 0;
  for (const __u32 feature : {ETHTOOL_STXCSUM, ETHTOOL_STSO, ETHTOOL_SGSO}) {
    ethtool_value off{static_cast<__u32>(feature), 0};
    ifreq request{};
    std::strncpy(request.ifr_name, interface, IFNAMSIZ - 1);
    request.ifr_data = reinterpret_cast<char*>(&off);
    done &= ioctl(any, SIOCETHTOOL, &request) == 0;
  }
  close(any);
  return done;
}

void expect(bool done, const std::string& what) {
  if (!done) throw NoNetwork("the network of this test cannot be made: " + what);
}

// A process that only keeps its namespace alive. It ends with this one.
pid_t start_keeper() {
  int ready[2];
  if (pipe2(ready, O_CLOEXEC) != 0) return -1;
  const pid_t keeper = fork();
  if (keeper == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const char done = unshare(CLONE_NEWNET) == 0 ? 'y' : 'n';
    [[maybe_unused]] const ssize_t told = write(ready[1], &done, 1);
    while (true) pause();
  }
  char done = 'n';
  const bool heard = read(ready[0], &done, 1) == 1;
  close(ready[0]);
  close(ready[1]);
  return heard && done == 'y' ? keeper : -1;
}

std::string port_of(int host) {
  return "port" + std::to_string(host);
}

void configure(pid_t keeper, int host, const std::string& interface) {
  expect(in_network_of(keeper, [&] { return send_plain_frames(interface.c_str()); }), "ethtool");
  expect(run_ip(keeper, {"addr", "add", Network::address_of(host) + "/24", "dev", interface}), "ip addr add");
  // Without the detection of duplicates, the address can be used at once.
  expect(run_ip(keeper,
                {"-6", "addr", "add", Network::ipv6_address_of(host) + "/64", "dev", interface, "nodad"}),
         "ip -6 addr add");
  expect(run_ip(keeper, {"link", "set", interface, "up"}), "ip link set up");
  expect(run_ip(keeper, {"link", "set", "lo", "up"}), "ip link set lo up");
}

}  // namespace

std::optional<std::string> Network::enter() {
  const uid_t user = geteuid();
  const gid_t group = getegid();
  if (user == 0) {
    if (unshare(CLONE_NEWNET) == 0) return std::nullopt;
    return std::string("root cannot make network namespaces here: ") + std::strerror(errno);
  }
  if (unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0)
    return std::string("neither root nor allowed to make user namespaces: ") + std::strerror(errno);
  write_file("/proc/self/setgroups", "deny");
  write_file("/proc/self/uid_map", "0 " + std::to_string(user) + " 1");
  write_file("/proc/self/gid_map", "0 " + std::to_string(group) + " 1");
  return std::nullopt;
}

Network::Network() : switch_(std::make_unique<Switch>()) {
  expect(run_ip(0, {"link", "add", port_of(1), "type", "veth", "peer", "name", "eth0"}),
         "ip link add (is `ip` installed, and does the kernel have veth?)");
  configure(0, 1, "eth0");
  plug_in(1);
  switch_->add_port(1, port_of(1));
}

Network::~Network() {
  for (const auto& [host, keeper] : hosts_) {
    kill(keeper, SIGKILL);
    waitpid(keeper, nullptr, 0);
  }
}

std::string Network::address_of(int host) {
  return "10.77.0." + std::to_string(host);
}

std::string Network::ipv6_address_of(int host) {
  return "fd77::" + std::to_string(host);
}

pid_t Network::add_host(int host) {
  const pid_t keeper = start_keeper();
  expect(keeper > 0, "a namespace");
  hosts_[host] = keeper;
  expect(run_ip(0, {"link", "add", port_of(host), "type", "veth", "peer", "name", "eth0", "netns",
                    std::to_string(keeper)}),
         "ip link add");
  configure(keeper, host, "eth0");
  plug_in(host);
  switch_->add_port(host, port_of(host));
  return keeper;
}

void Network::pull(int host) {
  expect(run_ip(0, {"link", "set", port_of(host), "down"}), "ip link set down");
}

void Network::plug_in(int host) {
  expect(run_ip(0, {"link", "set", port_of(host), "up"}), "ip link set up");
}

void Network::hold_up(std::chrono::milliseconds delay) {
  switch_->hold_up(delay);
}

void Network::lose(double share) {
  switch_->lose(share);
}

void Network::limit_rate(double bytes_per_second) {
  switch_->limit_rate(bytes_per_second);
}

void Network::set_line(int host, std::chrono::milliseconds delay, double bytes_per_second) {
  switch_->set_line(host, delay, bytes_per_second);
}

std::uint64_t Network::sent_bytes(int host) const {
  return switch_->sent_bytes(host);
}

void Network::remove_ipv4(int host) {
  const auto keeper = hosts_.find(host);
  expect(run_ip(keeper == hosts_.end() ? 0 : keeper->second,
                {"addr", "del", address_of(host) + "/24", "dev", "eth0"}),
         "ip addr del");
}

}  // namespace tessera::test
