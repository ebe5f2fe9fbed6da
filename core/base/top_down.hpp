// SPDX-License-Identifier: Apache-2.0
// The recursion of builders that make trees top-down, in parallel: a range of items is divided in two until
// it is a leaf. Bins, costs and the order of nodes are the builders' own. For sources compiled with OpenMP.
#pragma once

#include <cstddef>

#include "core/base/parallel_errors.hpp"

namespace tessera::core {

// Range has size(), and its alignment does not exceed the default, because OpenMP tasks copy it.
// divide(range) stores the node of a range and returns its parts as std::optional<std::pair<Range, Range>>,
// none of a leaf. It is called after that of the range that contains this one, and at the same time as those
// of ranges elsewhere.
template <typename Range, typename Divide>
class TopDownBuild {
 public:
  // Divides `root` and everything below it. Ranges of at most `task_size` items are not worth a task. Throws
  // what `divide` throws.
  static void run(const Range& root, std::size_t task_size, int threads, const Divide& divide) {
    TopDownBuild build(task_size, divide);
#pragma omp parallel num_threads(threads)
#pragma omp single
    build.errors_.run([&] { build.divide_all(root); });
    build.errors_.rethrow();
  }

 private:
  TopDownBuild(std::size_t task_size, const Divide& divide) : task_size_(task_size), divide_(divide) {}

  // Parts may still be pending as tasks when this returns.
  void divide_all(Range range) {
    while (const auto parts = divide_(range)) {
      const Range& left = parts->first;
      if (range.size() > task_size_) {
        spawn(left);
      } else {
        divide_all(left);
      }
      range = parts->second;
    }
  }

  void spawn(Range range) {
#pragma omp task default(none) firstprivate(range)
    errors_.run([&] { divide_all(range); });
  }

  const std::size_t task_size_;
  const Divide& divide_;
  ParallelErrors errors_;  // thrown in tasks
};

template <typename Range, typename Divide>
void build_top_down(const Range& root, std::size_t task_size, int threads, const Divide& divide) {
  TopDownBuild<Range, Divide>::run(root, task_size, threads, divide);
}

}  // namespace tessera::core
