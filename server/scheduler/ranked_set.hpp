// SPDX-License-Identifier: Apache-2.0
// A set that also knows how many of its elements come before a value, in time logarithmic in their number:
// an order-statistic tree of the GNU library. set.order_of_key(value) is that number. Not thread-safe.
#pragma once

#include <ext/pb_ds/assoc_container.hpp>
#include <ext/pb_ds/tree_policy.hpp>
#include <functional>

namespace tessera::scheduler {

template <typename T>
using RankedSet = __gnu_pbds::tree<T, __gnu_pbds::null_type, std::less<T>, __gnu_pbds::rb_tree_tag,
                                   __gnu_pbds::tree_order_statistics_node_update>;

}  // namespace tessera::scheduler
