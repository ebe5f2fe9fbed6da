// SPDX-License-Identifier: Apache-2.0
// Jobs in the order in which they are served: that of choose_job() (policy.hpp), in time logarithmic in their
// number. Knows nothing of jobs but their place in the order. Not thread-safe.
//
// The order changes with the virtual time: jobs whose virtual finish it has reached are equal in their start,
// and the one that has waited longest comes first. So the jobs of a priority are a search tree by virtual
// finish, balanced at random (a treap, Seidel and Aragon 1996), in which each node knows who has waited
// longest in its subtree (as in a priority search tree, McCreight 1985).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "server/scheduler/producer.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

class JobIndex {
 public:
  // What determines a job's place in the order (JobSnapshot), and who need not look at it.
  struct Place {
    int priority = 0;
    double virtual_finish = 0;
    std::uint64_t last_served = 0;
    // Workers of this identity can take nothing of it; kNoIdentity: no such identity is known.
    IdentityNumber excluded = kNoIdentity;
    bool operator==(const Place&) const = default;
  };

  JobIndex() = default;
  JobIndex(const JobIndex&) = delete;
  JobIndex& operator=(const JobIndex&) = delete;

  bool empty() const { return nodes_.empty(); }
  std::optional<Place> place_of(JobNumber job) const;
  // Inserts or moves a job; or removes it.
  void set(JobNumber job, const std::optional<Place>& place);

  // The first job that `accept` takes. Asks it about the jobs before that one, in their order, but for those
  // that exclude the identity.
  using Accept = std::function<bool(JobNumber)>;
  std::optional<JobNumber> first(double virtual_time, IdentityNumber identity, const Accept& accept) const;

 private:
  struct Node {
    JobNumber job = 0;
    Place place;
    // A node's weight is not less than those of its subtree.
    std::uint64_t weight = 0;
    Node* left = nullptr;
    Node* right = nullptr;
    // Who has waited longest in the subtree, and who of those that do not exclude the same identity as that
    // one. The latter is null if there is none, or if the first excludes no identity.
    const Node* longest = nullptr;
    const Node* longest_other = nullptr;
  };

  static bool finishes_before(const Node& a, const Node& b);
  static bool waits_longer(const Node* a, const Node* b);
  static const Node* longest_for(const Node* tree, IdentityNumber identity);
  static void summarise(Node& node);
  static std::pair<Node*, Node*> split(Node* tree, const Node& at);
  static Node* join(Node* left, Node* right);
  static Node* insert(Node* tree, Node& node);
  static Node* remove(Node* tree, const Node& node);
  static const Node* first_started(const Node* root, double virtual_time, IdentityNumber identity,
                                   const Accept& accept);
  static const Node* first_to_start(const Node* tree, double virtual_time, IdentityNumber identity,
                                    const Accept& accept);

  std::map<JobNumber, Node> nodes_;
  // By priority, the highest first; without empty trees.
  std::map<int, Node*, std::greater<>> roots_;
};

}  // namespace tessera::scheduler
