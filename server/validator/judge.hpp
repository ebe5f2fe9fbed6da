// Loads a bundle's scene and says whether it can be rendered, in the words in which a local render would
// refuse it.
#pragma once

#include "server/validator/options.hpp"
#include "server/validator/verdict.pb.h"

namespace tessera::validator {

// Opens only `question.files()`. Throws nothing; want of memory is a refusal.
Verdict judge(const Question& question, const Options& options);

}  // namespace tessera::validator
