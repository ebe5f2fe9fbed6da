// Two pieces of work at once, for recursion over a tree.
#pragma once

namespace tessera::core {

// Runs both and returns when both are done: side by side if `in_parallel`, on whatever threads the enclosing
// parallel region has to spare; else one after the other, at no cost.
template <typename First, typename Second>
void fork(bool in_parallel, const First& first, const Second& second) {
  if (!in_parallel) {
    first();
    second();
    return;
  }
#pragma omp task default(shared)
  first();
  second();
#pragma omp taskwait
}

}  // namespace tessera::core
