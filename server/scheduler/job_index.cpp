// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/job_index.hpp"

#include <queue>
#include <tuple>
#include <vector>

namespace tessera::scheduler {
namespace {

// A step of splitmix64 (Steele et al. 2014).
std::uint64_t hash(std::uint64_t value) {
  value += 0x9e3779b97f4a7c15;
  value = (value ^ value >> 30) * 0xbf58476d1ce4e5b9;
  value = (value ^ value >> 27) * 0x94d049bb133111eb;
  return value ^ value >> 31;
}

bool excludes(const JobIndex::Place& place, IdentityNumber identity) {
  return place.excluded != kNoIdentity && place.excluded == identity;
}

}  // namespace

bool JobIndex::finishes_before(const Node& a, const Node& b) {
  const auto rank = [](const Node& node) {
    return std::tuple(node.place.virtual_finish, node.place.last_served, node.job);
  };
  return rank(a) < rank(b);
}

bool JobIndex::waits_longer(const Node* a, const Node* b) {
  return std::pair(a->place.last_served, a->job) < std::pair(b->place.last_served, b->job);
}

const JobIndex::Node* JobIndex::longest_for(const Node* tree, IdentityNumber identity) {
  if (tree == nullptr) return nullptr;
  return excludes(tree->longest->place, identity) ? tree->longest_other : tree->longest;
}

void JobIndex::summarise(Node& node) {
  const Node* candidates[] = {&node, nullptr, nullptr, nullptr, nullptr};
  std::size_t count = 1;
  for (const Node* child : {node.left, node.right}) {
    if (child == nullptr) continue;
    candidates[count++] = child->longest;
    if (child->longest_other != nullptr) candidates[count++] = child->longest_other;
  }
  node.longest = &node;
  for (std::size_t i = 1; i < count; ++i)
    if (waits_longer(candidates[i], node.longest)) node.longest = candidates[i];
  node.longest_other = nullptr;
  const IdentityNumber excluded = node.longest->place.excluded;
  if (excluded == kNoIdentity) return;
  for (std::size_t i = 0; i < count; ++i) {
    const Node* const other = candidates[i];
    if (other->place.excluded == excluded) continue;
    if (node.longest_other == nullptr || waits_longer(other, node.longest_other)) node.longest_other = other;
  }
}

// The nodes before a place, and the others.
std::pair<JobIndex::Node*, JobIndex::Node*> JobIndex::split(Node* tree, const Node& at) {
  if (tree == nullptr) return {nullptr, nullptr};
  if (finishes_before(*tree, at)) {
    const auto [before, after] = split(tree->right, at);
    tree->right = before;
    summarise(*tree);
    return {tree, after};
  }
  const auto [before, after] = split(tree->left, at);
  tree->left = after;
  summarise(*tree);
  return {before, tree};
}

JobIndex::Node* JobIndex::join(Node* left, Node* right) {
  if (left == nullptr) return right;
  if (right == nullptr) return left;
  if (left->weight > right->weight) {
    left->right = join(left->right, right);
    summarise(*left);
    return left;
  }
  right->left = join(left, right->left);
  summarise(*right);
  return right;
}

JobIndex::Node* JobIndex::insert(Node* tree, Node& node) {
  if (tree == nullptr || node.weight > tree->weight) {
    std::tie(node.left, node.right) = split(tree, node);
    summarise(node);
    return &node;
  }
  Node*& side = finishes_before(node, *tree) ? tree->left : tree->right;
  side = insert(side, node);
  summarise(*tree);
  return tree;
}

JobIndex::Node* JobIndex::remove(Node* tree, const Node& node) {
  if (tree == &node) return join(tree->left, tree->right);
  Node*& side = finishes_before(node, *tree) ? tree->left : tree->right;
  side = remove(side, node);
  summarise(*tree);
  return tree;
}

std::optional<JobIndex::Place> JobIndex::place_of(JobNumber job) const {
  const auto found = nodes_.find(job);
  return found == nodes_.end() ? std::nullopt : std::optional<Place>(found->second.place);
}

void JobIndex::set(JobNumber job, const std::optional<Place>& place) {
  const auto [entry, is_new] = place ? nodes_.try_emplace(job) : std::pair(nodes_.find(job), false);
  if (entry == nodes_.end()) return;
  Node& node = entry->second;
  if (!is_new && place == node.place) return;
  if (!is_new) {
    const auto root = roots_.find(node.place.priority);
    root->second = remove(root->second, node);
    if (root->second == nullptr) roots_.erase(root);
  }
  if (!place) {
    nodes_.erase(entry);
    return;
  }
  node = {.job = job, .place = *place, .weight = hash(job)};
  Node*& root = roots_[place->priority];
  root = insert(root, node);
}

std::optional<JobNumber> JobIndex::first(double virtual_time, IdentityNumber identity,
                                         const Accept& accept) const {
  for (const auto& [priority, root] : roots_) {
    const Node* found = first_started(root, virtual_time, identity, accept);
    if (found == nullptr) found = first_to_start(root, virtual_time, identity, accept);
    if (found != nullptr) return found->job;
  }
  return std::nullopt;
}

// Of the jobs whose virtual finish is reached, the one that has waited longest: a search for the best node
// through subtrees, each as good as its best.
const JobIndex::Node* JobIndex::first_started(const Node* root, double virtual_time, IdentityNumber identity,
                                              const Accept& accept) {
  struct Part {
    const Node* best;
    // The subtree that contains it; null: the node alone.
    const Node* tree;
  };
  const auto is_worse = [](const Part& a, const Part& b) { return waits_longer(b.best, a.best); };
  std::priority_queue<Part, std::vector<Part>, decltype(is_worse)> parts(is_worse);
  const auto add_node = [&](const Node* node) {
    if (!excludes(node->place, identity)) parts.push({node, nullptr});
  };
  const auto add_tree = [&](const Node* tree) {
    if (const Node* const best = longest_for(tree, identity)) parts.push({best, tree});
  };
  for (const Node* node = root; node != nullptr;) {
    const bool has_started = node->place.virtual_finish <= virtual_time;
    if (has_started) {
      add_node(node);
      add_tree(node->left);
    }
    node = has_started ? node->right : node->left;
  }
  while (!parts.empty()) {
    const Part part = parts.top();
    parts.pop();
    if (part.tree != nullptr) {
      add_node(part.tree);
      add_tree(part.tree->left);
      add_tree(part.tree->right);
    } else if (accept(part.best->job)) {
      return part.best;
    }
  }
  return nullptr;
}

// Of the other jobs, the one that starts first.
const JobIndex::Node* JobIndex::first_to_start(const Node* tree, double virtual_time, IdentityNumber identity,
                                               const Accept& accept) {
  if (longest_for(tree, identity) == nullptr) return nullptr;
  if (tree->place.virtual_finish > virtual_time) {
    if (const Node* const found = first_to_start(tree->left, virtual_time, identity, accept)) return found;
    if (!excludes(tree->place, identity) && accept(tree->job)) return tree;
  }
  return first_to_start(tree->right, virtual_time, identity, accept);
}

}  // namespace tessera::scheduler
