// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/producer.hpp"

namespace tessera::scheduler {

ProducerNumber Producers::number(const Producer& producer) {
  const auto [known, is_new] = numbers_.try_emplace(producer, static_cast<ProducerNumber>(producers_.size()));
  if (!is_new) return known->second;
  producers_.push_back(producer);
  const auto next = static_cast<IdentityNumber>(identities_.size() + 1);
  identity_of_.push_back(identities_.try_emplace(identity_of(producer), next).first->second);
  return known->second;
}

void Producers::introduce(const Producer& producer) {
  const auto nameless = numbers_.find({{}, producer.worker, {}, producer.principal});
  if (producer.name.empty() || nameless == numbers_.end() || numbers_.contains(producer)) return;
  const ProducerNumber number = nameless->second;
  numbers_.erase(nameless);
  numbers_.emplace(producer, number);
  producers_[number] = producer;
}

IdentityNumber Producers::identity(const Producer& producer) const {
  const auto known = identities_.find(identity_of(producer));
  return known == identities_.end() ? kNoIdentity : known->second;
}

void Producers::distrust(const Producer& producer) {
  ++times_changed_;
  distrusted_workers_.insert(producer.worker);
  if (!producer.machine.empty()) distrusted_machines_.insert(producer.machine);
  if (!producer.principal.empty()) distrusted_principals_.insert(producer.principal);
}

void Producers::trust(const Producer& producer) {
  ++times_changed_;
  distrusted_workers_.erase(producer.worker);
  distrusted_machines_.erase(producer.machine);
  distrusted_principals_.erase(producer.principal);
}

bool Producers::is_distrusted(const Producer& producer) const {
  return distrusted_workers_.contains(producer.worker) || distrusted_machines_.contains(producer.machine) ||
         distrusted_principals_.contains(producer.principal);
}

}  // namespace tessera::scheduler
