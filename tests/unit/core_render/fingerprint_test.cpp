#include "core/integrators/fingerprint.hpp"

#include <gtest/gtest.h>

namespace tessera::core {
namespace {

// Every build of this revision, whatever its compiler, optimisation, sanitizers or processor, computes these
// bits. A change that alters pictures alters the number: replace it knowingly, and say so in the change log.
TEST(Fingerprint, IsThatOfThisRevision) {
  EXPECT_EQ(arithmetic_fingerprint(), "8095c9e016c18576");
}

}  // namespace
}  // namespace tessera::core
