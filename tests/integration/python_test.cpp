// SPDX-License-Identifier: Apache-2.0
// docs/examples/submit.py: a client in another language renders the same bytes.
#include <gmock/gmock.h>

#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kPython = "/usr/bin/python3";  // of Debian, with python3-grpcio

class PythonTest : public FarmTest {
 protected:
  void SetUp() override {
    if (run("import", {kPython, "-c", "import grpc"}).exit_code != 0)
      GTEST_SKIP() << "there is no python3-grpcio (scripts/setup.sh test installs it)";
    std::filesystem::create_directory(folder_ / "stubs");
    const std::string stubs = folder_ / "stubs", proto = TESSERA_SOURCE_DIR "/proto";
    const std::string generate = "protoc -I " + proto + " --python_out=" + stubs +
                                 " --grpc_python_out=" + stubs +
                                 " --plugin=protoc-gen-grpc_python=\"$(command -v grpc_python_plugin)\" " +
                                 proto + "/tessera/v1/*.proto";
    const Outcome generated = run("generate", {"/bin/sh", "-c", generate});
    ASSERT_EQ(generated.exit_code, 0) << generated.err;
  }

  Outcome run(const std::string& name, const std::vector<std::string>& arguments) {
    ProcessOptions options;
    options.arguments = arguments;
    options.out = folder_ / (name + ".out");
    options.err = folder_ / (name + ".err");
    options.environment = {{"PYTHONPATH", folder_ / "stubs"}, {"PYTHONDONTWRITEBYTECODE", "1"}};
    Process process(options);
    const auto ended = process.wait(std::chrono::seconds(60));
    return {ended.value_or(-1), process.out(), process.err()};
  }
  Outcome run_example(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {kPython, TESSERA_SOURCE_DIR "/docs/examples/submit.py", address()});
    return run("example", arguments);
  }
};

TEST_F(PythonTest, TheExampleRendersTheSameBytes) {
  start_coordinator();
  start_worker("worker", 2);
  const std::string image = folder_ / "image.exr";
  const Outcome first = run_example({kCornell, image, "--spp", "2"});
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("DONE"));
  EXPECT_TRUE(read_file(image) == render_here({"--spp", "2"}, ".exr"));
}

TEST_F(PythonTest, TheExampleSaysWhyASceneCannotBeRendered) {
  start_coordinator();
  std::filesystem::create_directory(folder_ / "scene");
  write_file(folder_ / "scene" / "scene.json", "{}");
  const Outcome outcome = run_example({folder_ / "scene" / "scene.json", folder_ / "image.png"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("scene.json"));
}

}  // namespace
}  // namespace tessera::test
