// SPDX-License-Identifier: Apache-2.0
// A quota that callers share, such as places in a queue. A caller may hold as much as is left for the others
// (the dynamic threshold of Choudhury and Hahne 1998). A single caller can hold half of the total, so that
// the next finds as much. Where several want more than there is, their shares become equal as they give back
// and take again. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace tessera::base {

// The key of a caller with a name, stable across restarts. Callers without names are keyed by their machines.
inline std::string caller_key(const std::string& name) {
  return "user " + name;
}

class FairShare {
 public:
  // `given_back` is called, under no lock, each time that something is given back.
  explicit FairShare(std::uint64_t all, std::function<void()> given_back = nullptr);

  // An amount that a caller has taken. The destructor gives it back. May outlive the FairShare.
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

  // Empty if that exceeds the caller's share. A caller that is alone gets any amount once.
  std::optional<Held> take(const std::string& caller, std::uint64_t amount = 1);
  // Takes the amount whatever the caller's share is, for what exists already.
  Held note(const std::string& caller, std::uint64_t amount);

  // The amount that the caller holds, and all callers together.
  std::uint64_t held_by(const std::string& caller) const;
  std::uint64_t held() const;

 private:
  const std::shared_ptr<Held::State> state_;
};

}  // namespace tessera::base
