// SPDX-License-Identifier: Apache-2.0
// Frames on the command line, and the files that the built program writes for them.
#include "client/frames.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/client/process.hpp"

namespace tessera::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Numbers = std::vector<std::int32_t>;

TEST(FrameList, IsRangesStepsAndNumbers) {
  EXPECT_EQ(*parse_frames("7"), Numbers{7});
  EXPECT_EQ(*parse_frames("1-4"), (Numbers{1, 2, 3, 4}));
  EXPECT_EQ(*parse_frames("1-8x3"), (Numbers{1, 4, 7}));
  EXPECT_EQ(*parse_frames("9,1-2,20-30x5"), (Numbers{9, 1, 2, 20, 25, 30}));
  EXPECT_EQ(parse_frames("0-99999")->size(), 100'000u);
}

TEST(FrameList, RefusesEverythingElse) {
  for (const char* wrong :
       {"", ",", "1,", "a", "-3", "4-1", "1-4x0", "1-4x", "1x3", "1--4", "1-4-5", "1000001", "1.5"})
    EXPECT_EQ(parse_frames(wrong).error().message,
              std::string("must be frames from 0 to 1000000 such as 1-48, 1-48x2 or 1,5,9-12; got '") +
                  wrong + "'");
  EXPECT_EQ(parse_frames("1-4,3").error().message, "frame 3 is named twice");
  EXPECT_EQ(parse_frames("0-100000").error().message, "must be at most 100000 frames; got '0-100000'");
}

TEST(FrameList, IsWrittenAsShortAsItCanBe) {
  for (const char* text : {"7", "1-48", "1-9x2", "9,1-2,20-30x5", "1,5", "3,2,1"})
    EXPECT_EQ(frames_text(*parse_frames(text)), text);
}

TEST(FramePath, HasTheNumberWithZerosInFront) {
  EXPECT_EQ(path_of_frame("out.####.exr", 7), "out.0007.exr");
  EXPECT_EQ(path_of_frame("out.#.exr", 123), "out.123.exr");
  EXPECT_EQ(path_of_frame("a#1/b##_###.png", 5), "a#1/b##_005.png");
  EXPECT_EQ(path_of_frame("####", 1), "0001");
  EXPECT_EQ(path_of_frame("out.exr", 7), "out.exr");
  EXPECT_TRUE(has_frame_number("out.#.exr"));
  EXPECT_FALSE(has_frame_number("take #3/out.exr"));
}

TEST(FramePath, MustHaveAPlaceForTheNumberOfSeveralFrames) {
  EXPECT_TRUE(check_frame_paths({"out.exr"}, 1));
  EXPECT_TRUE(check_frame_paths({"out.#.exr"}, 2));
  EXPECT_EQ(check_frame_paths({"out.#.exr", "out.png"}, 2).error().message,
            "'out.png' is one file for 2 frames: write the place of the number as in out.####.exr");
}

TEST(RenderOrder, BeginsWithAPreviewIfThatIsWanted) {
  EXPECT_THAT(render_order({*parse_frames("1-5"), false}), ElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(render_order({*parse_frames("1-5"), true}), ElementsAre(1, 3, 5, 2, 4));
  EXPECT_THAT(render_order({*parse_frames("1-3"), true}), ElementsAre(1, 2, 3));
  EXPECT_THAT(render_order({*parse_frames("4,2"), true}), ElementsAre(4, 2));
}

class RenderedFrames : public testing::Test {
 protected:
  RenderedFrames() {
    write_file(path("scene.json"), R"({
  "render": {"width": 40, "height": 30, "spp": 2},
  "camera": {"position": {"keyframes": [{"frame": 1, "value": [0, 0, 6]}, {"frame": 5, "value": [2, 0, 4]}]},
             "look_at": [0, 0, 0]},
  "materials": {"glow": {"type": "lambert", "albedo": 0.5, "emission": [2, 1, 0.5]}},
  "shapes": [{"type": "sphere", "radius": 1, "material": "glow",
              "transform": [{"translate": {"keyframes": [{"frame": 1, "value": [0, 0, 0]},
                                                         {"frame": 5, "value": [1, 1, 0]}]}}]}]
})");
  }
  std::string path(const std::string& name) const { return folder_.path() / name; }
  std::string bytes(const std::string& name) const { return read_file(path(name)); }
  ProcessResult render(std::vector<std::string> more) const {
    more.insert(more.begin(), {"render", path("scene.json")});
    return run_tessera(more);
  }

  TemporaryFolder folder_;
};

TEST_F(RenderedFrames, OfOneProcessAreThoseOfOneProcessEach) {
  const ProcessResult all =
      render({"--frames", "1-5x2,4", "-o", path("all.###.exr"), "-o", path("all.###.png")});
  ASSERT_EQ(all.exit_status, 0) << all.err;
  EXPECT_THAT(all.err, testing::Not(HasSubstr("from frame to frame")));
  for (const char* frame : {"1", "3", "5", "4"}) {
    ASSERT_EQ(render({"--frames", frame, "-o", path("one.exr")}).exit_status, 0);
    EXPECT_TRUE(bytes(std::string("all.00") + frame + ".exr") == bytes("one.exr")) << frame;
    EXPECT_FALSE(bytes(std::string("all.00") + frame + ".png").empty());
  }
  EXPECT_FALSE(bytes("all.001.exr") == bytes("all.003.exr"));
  EXPECT_FALSE(std::filesystem::exists(path("all.002.exr")));
}

TEST_F(RenderedFrames, WithoutANumberAreFrameZero) {
  ASSERT_EQ(render({"-o", path("none.exr")}).exit_status, 0);
  ASSERT_EQ(render({"-o", path("zero.exr"), "--frames", "0"}).exit_status, 0);
  EXPECT_TRUE(bytes("none.exr") == bytes("zero.exr"));
}

TEST_F(RenderedFrames, CanHaveParametersReplaced) {
  const std::string still = "shapes[0].transform=[]";
  ASSERT_EQ(render({"-o", path("moved.pfm"), "-D", still, "-D", "camera.position=[1, 0, 5]", "-D",
                    "render.integrator=nee"})
                .exit_status,
            0);
  ASSERT_EQ(
      render({"-o", path("third.pfm"), "--frames", "3", "--integrator", "nee", "-D", still}).exit_status, 0);
  EXPECT_TRUE(bytes("moved.pfm") == bytes("third.pfm"));
  const ProcessResult wrong = render({"-o", path("wrong.exr"), "-D", "camera.positon=3"});
  EXPECT_EQ(wrong.exit_status, 1);
  EXPECT_THAT(wrong.err, HasSubstr("camera: unknown key 'positon'; did you mean 'position'?"));
}

TEST_F(RenderedFrames, OfAStillSceneAreTheSameWithAWarning) {
  const ProcessResult still = render({"--frames", "1-2", "-o", path("still.#.exr"), "-D",
                                      "shapes[0].transform=[]", "-D", "camera.position=[1, 0, 5]"});
  ASSERT_EQ(still.exit_status, 0) << still.err;
  EXPECT_THAT(still.err, HasSubstr("changes from frame to frame: all are the same image"));
}

TEST_F(RenderedFrames, AreCheckedBeforeTheFirstIsRendered) {
  const ProcessResult result = render(
      {"--frames", "1-5", "-o", path("x.#.exr"), "-D",
       R"(camera.look_at={"keyframes": [{"frame": 1, "value": [0, 0, 0]}, {"frame": 4, "value": [1.5, 0, 4.5]}]})"});
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.err, HasSubstr("scene.json: frame 4: camera.look_at: must differ from camera.position"));
  EXPECT_FALSE(std::filesystem::exists(path("x.1.exr")));
}

TEST_F(RenderedFrames, NeedFilesOfTheirOwn) {
  const ProcessResult result = render({"--frames", "1-2", "-o", path("x.exr")});
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.err, HasSubstr("is one file for 2 frames"));
  const ProcessResult sample = render({"--frames", "1-2", "--sample", "0,0,0"});
  EXPECT_EQ(sample.exit_status, 2);
  EXPECT_THAT(sample.err, HasSubstr("--sample"));
}

}  // namespace
}  // namespace tessera::client
