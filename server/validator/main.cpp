// tessera-validator: reads a Question on standard input, writes a Verdict on standard output. The coordinator
// starts one for every submitted scene, so that a hostile file can take down no more than this process.
#include <cstdlib>
#include <iostream>

#include "server/validator/judge.hpp"
#include "server/validator/limits.hpp"

int main() {
  using namespace tessera::validator;
  Question question;
  if (!question.ParseFromIstream(&std::cin)) {
    std::cerr
        << "tessera-validator: reads one serialised tessera.validator.Question; the coordinator starts it\n";
    return EXIT_FAILURE;
  }
  if (const auto limited = apply_limits({}); !limited) {
    std::cerr << "tessera-validator: " << limited.error().message << '\n';
    return EXIT_FAILURE;
  }
  const Verdict verdict = judge(question);
  return verdict.SerializeToOstream(&std::cout) && std::cout.flush() ? EXIT_SUCCESS : EXIT_FAILURE;
}
