// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/fingerprint.hpp"

#include <gtest/gtest.h>

#include "core/base/determinism_fingerprint.hpp"

namespace tessera::core::integrators {
namespace {

// Every build of this revision, whatever its compiler, optimisation, sanitizers or processor, computes these
// bits, and coordinators accept no others. A change that alters images alters the number: replace it
// knowingly, and say so in the change log.
TEST(Fingerprint, IsThatOfThisRevision) {
  EXPECT_EQ(determinism_fingerprint(), kDeterminismFingerprint);
}

}  // namespace
}  // namespace tessera::core::integrators
