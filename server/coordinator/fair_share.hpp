// SPDX-License-Identifier: Apache-2.0
// What callers share, such as places in a queue: each may have as much of it as is left for the others (the
// dynamic threshold of Choudhury and Hahne 1998). One caller alone comes to half of all, so that the next
// finds as much; where several want more than there is, they come to equal shares as they give back and take
// again. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace tessera::coordinator {

// What a caller who has a name is known by, also after a restart. Who has none is known by their machine.
inline std::string caller_key(const std::string& name) {
  return "user " + name;
}

class FairShare {
 public:
  // `given_back` is called, under no lock, each time that something was given back.
  explicit FairShare(std::uint64_t all, std::function<void()> given_back = nullptr);

  // What a caller has taken; destroyed, it is given back. May outlive the share.
  class Held {
   public:
    Held(Held&&) noexcept = default;
    Held& operator=(Held&&) = delete;
    ~Held();

   private:
    friend class FairShare;
    struct State;
    Held(std::shared_ptr<State> state, std::string caller, std::uint64_t amount);

    std::shared_ptr<State> state_;  // null when moved from
    std::string caller_;
    std::uint64_t amount_;
  };

  // Nothing if that were more than the caller's share. Who is alone gets any amount once.
  std::optional<Held> take(const std::string& caller, std::uint64_t amount = 1);
  // Whatever the caller's share is: for what is there already.
  Held note(const std::string& caller, std::uint64_t amount);

  // How much the caller has, and all together.
  std::uint64_t held_by(const std::string& caller) const;
  std::uint64_t held() const;

 private:
  const std::shared_ptr<Held::State> state_;
};

}  // namespace tessera::coordinator
