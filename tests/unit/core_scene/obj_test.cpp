// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "core/scene/loader/obj_reader.hpp"
#include "core/scene/loader/obj_scanner.hpp"
#include "core/scene/loader/text_lines.hpp"

namespace tessera::core::obj_test {
namespace {

std::string obj_error(std::string_view text) {
  const auto file = read_obj(text, "x.obj");
  return file ? "no error" : file.error().message;
}

ObjFile read_text(std::string_view text) {
  auto file = read_obj(text, "x.obj");
  EXPECT_TRUE(file.has_value()) << file.error().message;
  return file ? std::move(*file) : ObjFile{};
}

// "0/1/2 ..." with '-' for what is missing, for all triangles.
std::string corners_of(const ObjFile& file) {
  const auto shown = [](std::int32_t i) { return i < 0 ? std::string("-") : std::to_string(i); };
  std::string all;
  const auto& [positions, uvs, normals] = file.corners;
  for (std::size_t i = 0; i < positions.size(); ++i)
    all += (all.empty() ? "" : " ") + shown(positions[i]) + "/" + shown(uvs.empty() ? -1 : uvs[i]) + "/" +
           shown(normals.empty() ? -1 : normals[i]);
  return all;
}

const std::string kFourCorners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(TextLines, EndInAnyOfThreeWays) {
  std::string_view text = "a\nb\r\nc\rd\n\n\r\re";
  std::string lines;
  while (!text.empty()) lines += "[" + std::string(take_line(text)) + "]";
  EXPECT_EQ(lines, "[a][b][c][d][][][][e]");
}

TEST(ParseFloat, TakesDecimalNumbersOnly) {
  EXPECT_EQ(parse_float("1.5"), 1.5f);
  EXPECT_EQ(parse_float("+1.5"), 1.5f);
  EXPECT_EQ(parse_float("-.5e-3"), -0.0005f);
  EXPECT_EQ(parse_float("7."), 7.0f);
  EXPECT_EQ(parse_float("0.1"), 0.1f);
  EXPECT_EQ(parse_float("16777217"), 16777216.0f);
  EXPECT_EQ(parse_float("3.4028235e38"), 3.4028235e38f);
  EXPECT_EQ(parse_float("1e-60"), 0.0f);
  EXPECT_EQ(parse_float("1e-400"), 0.0f);
  EXPECT_EQ(parse_float("1e-42"), 1e-42f);
  for (const auto word : {"",    "+",    "-",   ".",        "e5",   "1e",    "1.5x",  "1,5", "0x10", "nan",
                          "inf", "-inf", "NaN", "infinity", "1e39", "-1e39", "1e400", "+-1", "1 ",   " 1"})
    EXPECT_EQ(parse_float(word), std::nullopt) << word;
}

TEST(Obj, ReadsAllKindsOfCorners) {
  const std::string vertices = kFourCorners + "vt 0 0\nvt 1\nvn 0 0 1\n";
  EXPECT_EQ(corners_of(read_text(vertices + "f 1 2 3")), "0/-/- 1/-/- 2/-/-");
  EXPECT_EQ(corners_of(read_text(vertices + "f 1/1 2/2 3/1")), "0/0/- 1/1/- 2/0/-");
  EXPECT_EQ(corners_of(read_text(vertices + "f 1//1 2//1 3//1")), "0/-/0 1/-/0 2/-/0");
  EXPECT_EQ(corners_of(read_text(vertices + "f 1/2/1 2/1/1 4/2/1")), "0/1/0 1/0/0 3/1/0");
  EXPECT_EQ(read_text(vertices + "f 1 2 3").text.uvs, (std::vector<Vec2>{{0, 0}, {1, 0}}));
}

TEST(Obj, CountsNegativeIndicesFromTheFace) {
  EXPECT_EQ(corners_of(read_text(
                "v 0 0 0\nv 1 0 0\nvt 0 0\nvn 0 0 1\nv 0 1 0\nf -3/-1/-1 -2/-1/-1 -1/-1/-1\nv 5 5 5\nvt 1 1\n"
                "f -1 -2 -4\n")),
            "0/0/0 1/0/0 2/0/0 3/-/- 2/-/- 0/-/-");
}

TEST(Obj, TakesFacesBeforeTheirVertices) {
  EXPECT_EQ(corners_of(read_text("f 1 2 3\n" + kFourCorners)), "0/-/- 1/-/- 2/-/-");
}

TEST(Obj, CutsPolygons) {
  EXPECT_EQ(corners_of(read_text(kFourCorners + "f 1 2 3 4")), "0/-/- 1/-/- 2/-/- 0/-/- 2/-/- 3/-/-");
}

TEST(Obj, CutsPolygonsOfManyCorners) {
  std::string text, face = "f";
  for (int i = 0; i < 1000; ++i) {
    text += "v " + std::to_string(std::cos(i * 2 * M_PI / 1000)) + " " +
            std::to_string(std::sin(i * 2 * M_PI / 1000)) + " 0\n";
    face += " " + std::to_string(i + 1);
  }
  EXPECT_EQ(read_text(text + face).triangle_count(), 998u);
}

TEST(Obj, AcceptsTheLayoutsThatPeopleWrite) {
  const std::string expected = "0/-/- 1/-/- 2/-/-";
  EXPECT_EQ(corners_of(read_text("\xef\xbb\xbfv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n")), expected);
  EXPECT_EQ(corners_of(read_text("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r")), expected);
  EXPECT_EQ(corners_of(read_text("\tv\t0  0\t0 \nv 1 0 0\t\n  v 0 1 0\nf\t1   2 3  ")), expected);
  EXPECT_EQ(
      corners_of(read_text("# c\n\nv 0 0 0 # origin\nv 1 0 0 1.0\nv 0 1 0 0.5 0.5 0.5\n   # d\nf 1 2 3\n#")),
      expected);
  EXPECT_EQ(corners_of(read_text(
                "o thing\ng a b\nv 0 0 0\nv 1 0 0\nv 0 1 0\ns off\ns 1\nl 1 2\np 1\nvp 0 0\nf 1 2 3")),
            expected);
}

TEST(Obj, PassesOverComments) {
  EXPECT_EQ(
      corners_of(read_text("v 0 0 0# origin\nv 1 0 0 # \\\nv 0 1 0#\n# c \\\nf 1 2 3 # 4 \\\nf 3 2 1#\n")),
      "0/-/- 1/-/- 2/-/- 2/-/- 1/-/- 0/-/-");
  EXPECT_EQ(corners_of(read_text(
                "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0 # uv\nvn 0 0 1 # n\ns 1 # soft\nf 1/1/1 2/1/1 3/1/1")),
            "0/0/0 1/0/0 2/0/0");
}

TEST(Obj, JoinsContinuedLines) {
  for (const std::string end : {"\n", "\r\n", "\r"})
    EXPECT_EQ(corners_of(read_text("v 0 \\" + end + "0 0" + end + "v 1\\" + end + " 0 0" + end + "v 0 1 0" +
                                   end + "f 1\\" + end + "\\" + end + "2 \\" + end + "3" + end)),
              "0/-/- 1/-/- 2/-/-")
        << end;
  EXPECT_EQ(read_text(kFourCorners + "usemtl red \\\nbrick\nf 1 2 3").material_names[0], "red  brick");
}

TEST(Obj, ReadsSmoothingGroups) {
  const ObjFile file =
      read_text(kFourCorners +
                "f 1 2 3\ns 1\nf 1 2 3 4\ns off\nf 1 2 3\ng other\nf 1 2 3\ns 4294967295\nf 1 2 3\n"
                "s 0\nf 1 2 3\ns 2 3\ns on\nf 1 2 3\n");
  std::vector<std::optional<std::uint32_t>> groups;
  for (std::size_t t = 0; t < file.triangle_count(); ++t) groups.push_back(file.run_of(t).smoothing_group);
  EXPECT_EQ(groups, (std::vector<std::optional<std::uint32_t>>{std::nullopt, 1, 1, 0, 0, 4294967295, 0, 1}));
  EXPECT_EQ(file.runs.size(), 6u);
}

TEST(Obj, MixesFacesWithAndWithoutCoordinatesAndNormals) {
  EXPECT_EQ(
      corners_of(read_text(kFourCorners + "vt 0 0\nvn 0 0 1\nf 1 2 3\nf 1/1 2 3\nf 1 2//1 3\nf 2 3 4\n")),
      "0/-/- 1/-/- 2/-/- 0/0/- 1/-/- 2/-/- 0/-/- 1/-/0 2/-/- 1/-/- 2/-/- 3/-/-");
}

TEST(Obj, KeepsOnlyTheListsThatFacesUse) {
  const ObjFile file = read_text(kFourCorners + "vt 0 0\nvn 0 0 1\nf 1 2 3\n");
  EXPECT_TRUE(file.corners.uvs.empty());
  EXPECT_TRUE(file.corners.normals.empty());
}

TEST(Obj, TakesTheFacesOfOldFilesAndAllStatementsOfPolygons) {
  EXPECT_EQ(corners_of(read_text(kFourCorners + "fo 1 2 3\nusemap x\nmaplib y\nlod 3\nmg 1 2\n")),
            "0/-/- 1/-/- 2/-/-");
}

TEST(Obj, TellsMaterialsApart) {
  const ObjFile file = read_text(kFourCorners +
                                 "mtllib a.mtl\nf 1 2 3\nusemtl red brick \nf 1 2 3\nusemtl\tblue\nf 1 2 3 "
                                 "4\nusemtl red brick\nf 2 3 4");
  EXPECT_EQ(file.material_names, (std::vector<std::string>{"red brick", "blue"}));
  EXPECT_EQ(file.material_lines, (std::vector<int>{7, 9}));
  std::vector<std::uint32_t> materials;
  for (std::size_t t = 0; t < file.triangle_count(); ++t) materials.push_back(file.run_of(t).material);
  EXPECT_EQ(materials, (std::vector<std::uint32_t>{kNoMaterialName, 0, 1, 1, 0}));
  ASSERT_EQ(file.text.libraries.size(), 1u);
  EXPECT_EQ(file.text.libraries[0].name, "a.mtl");
  EXPECT_EQ(file.text.libraries[0].line, 5);
  EXPECT_EQ(file.text.first_face_line, 6);
}

// What is told of a file that is read all the same.
std::vector<std::string> warnings_of(const std::string& text) {
  return read_text(text).text.warnings.messages("x.obj");
}

TEST(Obj, LeavesOutFacesThatCannotBeUsed) {
  const std::string good = kFourCorners + "f 1 2 3\n";
  constexpr std::string_view kCorner = "a face's corner must be like 7, 7/2, 7//3 or 7/2/3, got ";
  const auto corner = [&](const std::string& word) { return std::string(kCorner) + "'" + word + "'"; };
  const std::pair<std::string, std::string> cases[] = {
      {"f 1 2", "a face must have at least 3 corners, got 2"},
      {"f", "a face must have at least 3 corners, got 0"},
      {"f 1 2 # 3", "a face must have at least 3 corners, got 2"},
      {"f 1 2 0", corner("0")},
      {"f 1 2 /3", corner("/3")},
      {"f 1 2 3/1/1/1", corner("3/1/1/1")},
      {"f 1 2 three", corner("three")},
      {"f 1 2 3.0", corner("3.0")},
      {"f 1 2 --3", corner("--3")},
      {"f 1 2 99999999999", corner("99999999999")},
      {"f 1 2 3 \\", corner("\\")},
      {"f 1 2 -5", "a face refers to 'v' number -5, but only 4 come before it"},
      {"f 1 2 5", "a face refers to 'v' number 5, but the file has only 4"},
  };
  for (const auto& [line, message] : cases) {
    EXPECT_EQ(corners_of(read_text(good + line)), "0/-/- 1/-/- 2/-/-") << line;
    EXPECT_EQ(warnings_of(good + line),
              (std::vector<std::string>{"x.obj:6: " + message + "; the face is left out"}))
        << line;
  }
}

TEST(Obj, TakesEmptyAndZeroPartsOfCornersAsNone) {
  const std::string vertices = kFourCorners + "vt 0 0\nvn 0 0 1\n";
  for (const auto face : {"f 1// 2/ 3", "f 1/0/0 2/0 3//0", "f 1//-0 2/-0/ 3/00"}) {
    EXPECT_EQ(corners_of(read_text(vertices + face)), "0/-/- 1/-/- 2/-/-") << face;
    EXPECT_TRUE(warnings_of(vertices + face).empty()) << face;
  }
  EXPECT_EQ(corners_of(read_text(vertices + "f 1/1/0 2/1/ 3/0/1")), "0/0/- 1/0/- 2/-/0");
}

TEST(Obj, TakesTextureCoordinatesAndNormalsThatDoNotExistAsNone) {
  const std::string text = kFourCorners + "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/2 3/7/1\nf 1/1/1 2/-2/1 4/1/3\n";
  EXPECT_EQ(corners_of(read_text(text)), "0/0/0 1/0/- 2/-/0 0/0/0 1/-/0 3/0/-");
  EXPECT_EQ(
      warnings_of(text),
      (std::vector<std::string>{
          "x.obj:7: a face refers to 'vn' number 2, but the file has only 1; the corner has none (2 times)",
          "x.obj:7: a face refers to 'vt' number 7, but the file has only 1; the corner has none (2 "
          "times)"}));
}

TEST(Obj, PassesOverValuesThatAreNoNumbersWhereTheyAreNotNeeded) {
  const std::string text =
      "v 0 0 0\nv 1 0 0 nan nan nan\nv 0 1 0\nv nan nan nan\nvt nan nan\nvt 0.5\nvn -nan(ind) 0 1\nvn 0 0 1 "
      "5\n"
      "f 1/1/1 2/2/2 3/1/1\n";
  const ObjFile file = read_text(text);
  EXPECT_EQ(corners_of(file), "0/0/0 1/1/1 2/0/0");
  EXPECT_EQ(file.text.uvs, (std::vector<Vec2>{{0, 0}, {0.5f, 0}}));
  EXPECT_EQ(file.text.normals, (std::vector<Vec3>{{0, 0, 0}, {0, 0, 1}}));
  EXPECT_TRUE(file.text.colors.empty());
  EXPECT_EQ(warnings_of(text).size(), 4u);
}

TEST(Obj, LeavesOutFacesOfVerticesThatAreNoNumbers) {
  const std::string text =
      kFourCorners + "v 1 inf 0\nv 1e39 0 0\nv 1 2\nf 1 2 3\nf 1 2 5\nf 1 6 3\nf 7 2 3\n";
  EXPECT_EQ(corners_of(read_text(text)), "0/-/- 1/-/- 2/-/-");
  EXPECT_EQ(
      warnings_of(text),
      (std::vector<std::string>{
          "x.obj:5: a vertex must be 3 finite numbers, got '1 inf 0'; faces that use it are left out (3 "
          "times)",
          "x.obj:9: a face refers to 'v' number 5 in line 5, which is not 3 finite numbers; the face is left "
          "out (3 "
          "times)"}));
}

TEST(Obj, PassesOverLinesThatItDoesNotUnderstand) {
  const std::pair<std::string, std::string> cases[] = {
      {"newmtl a", "'newmtl' is not a statement of OBJ files; the line is ignored"},
      {"s soft", "'s' must be the number of a smoothing group or 'off', got 'soft'; the line is ignored"},
      {"s -1", "'s' must be the number of a smoothing group or 'off', got '-1'; the line is ignored"},
      {"s", "'s' must be the number of a smoothing group or 'off', got ''; the line is ignored"},
      {"usemtl", "'usemtl' names no material"},
      {"usemtl # name", "'usemtl' names no material"},
      {"mtllib", "'mtllib' names no file"},
      {"cstype bezier", "free-form curves and surfaces are not supported; export the mesh as polygons"},
      {"call other.obj", "'call' reads another file, which is not supported; it is ignored"},
      {"csh rm -r *", "'csh' runs a command, which a scene must not; it is ignored"},
  };
  for (const auto& [line, message] : cases) {
    const std::string text = kFourCorners + line + "\n" + line + "\nf 1 2 3\n";
    EXPECT_EQ(corners_of(read_text(text)), "0/-/- 1/-/- 2/-/-") << line;
    EXPECT_EQ(warnings_of(text), (std::vector<std::string>{"x.obj:5: " + message + " (2 times)"})) << line;
  }
}

TEST(Obj, TellsManyKindsOfWarningsInFewLines) {
  std::string text = kFourCorners + "f 1 2 3\n";
  for (int i = 0; i < 100; ++i) text += "word" + std::to_string(i) + "\n";
  const auto warnings = warnings_of(text);
  ASSERT_EQ(warnings.size(), 25u);
  EXPECT_EQ(warnings.back(), "x.obj: and 76 more warnings");
}

TEST(Obj, PassesOverTheTailsOfOldFiles) {
  for (const std::string& tail :
       {std::string("\0\0\0\0", 4), std::string("\x1a"), std::string("\n\x1a\0", 3)}) {
    EXPECT_EQ(corners_of(read_text(kFourCorners + "f 1 2 3\n" + tail)), "0/-/- 1/-/- 2/-/-");
    EXPECT_TRUE(warnings_of(kFourCorners + "f 1 2 3\n" + tail).empty());
  }
}

TEST(Obj, ReadsUtf16) {
  const std::string text = kFourCorners + "usemtl a\nf 1 2 3\n";
  for (const bool big_endian : {false, true}) {
    std::string wide = big_endian ? "\xfe\xff" : "\xff\xfe";
    for (const char c : text) wide += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
    EXPECT_EQ(corners_of(read_text(wide)), "0/-/- 1/-/- 2/-/-");
  }
  std::string converted;
  EXPECT_EQ(as_utf8(std::string_view("\xff\xfe\xe4\x00\xac\x20\x3d\xd8\x00\xde\x00\xd8", 12), converted),
            "ä€😀\xef\xbf\xbd");
}

TEST(Obj, ReadsVertexColors) {
  const ObjFile file = read_text("v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 1 0 1 1\nv 1 1 0 1\nf 1 2 3\nf 1 2 4\n");
  ASSERT_EQ(file.text.colors.size(), 4u);
  EXPECT_EQ(file.text.colors[0], (Rgb{1, 0, 0}));
  EXPECT_EQ(file.text.colors[1], Rgb::gray(1));
  EXPECT_EQ(file.text.colors[2], (Rgb{0, 1, 1})) << "behind a weight";
  EXPECT_EQ(file.text.colors[3], Rgb::gray(1));
}

TEST(Obj, ReadsVertexColorsWithOpacity) {
  const auto colors = [](const std::string& first, const std::string& second) {
    return read_text("v 0 0 0 " + first + "\nv 1 0 0 " + second + "\nv 0 1 0\nf 1 2 3\n").text.colors;
  };
  EXPECT_EQ(colors("1 0 0 1", "0 1 0 1"), (std::vector<Rgb>{{1, 0, 0}, {0, 1, 0}, Rgb::gray(1)}));
  EXPECT_EQ(colors("1 0 0 1", "1 1 0 1"), (std::vector<Rgb>{{0, 0, 1}, {1, 0, 1}, Rgb::gray(1)}))
      << "the fourth number may be a weight";
  EXPECT_EQ(colors("1 0 0 1", "0 1 0 0"), (std::vector<Rgb>{{0, 0, 1}, {1, 0, 0}, Rgb::gray(1)}))
      << "the last number is no opacity";
}

TEST(Obj, TellsThatItDoesNotReadImagesOfFaces) {
  EXPECT_EQ(
      warnings_of(kFourCorners + "usemap a.png\nf 1 2 3\nusemap b.png\nf 1 2 4\n"),
      (std::vector<std::string>{"x.obj:5: 'usemap' names images, which is not supported; name them in an "
                                "MTL file, as 'map_Kd' (2 times)"}));
}

TEST(Obj, ReadsVertexColorsAsDisplaysShowThem) {
  const std::string triangle = "v 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const Rgb half = read_text("v 0 0 0 0.5 1 0\n" + triangle).text.colors[0];
  EXPECT_NEAR(half.r, 0.21404f, 1e-4f);  // IEC 61966-2-1
  const Rgb bytes = read_text("v 0 0 0 127.5 255 0\n" + triangle).text.colors[0];
  EXPECT_NEAR(bytes.r, half.r, 1e-6f);
  EXPECT_EQ(bytes.g, 1);
  EXPECT_TRUE(read_text("v 0 0 0 1 1 1\n" + triangle).text.colors.empty());
}

TEST(Obj, ReadsPolypaint) {
  const std::string text =
      "v 0 0 0 200 0 0\nv 1 0 0\nv 0 1 0\n#MRGB ffff0000FF00bc00\n#MRGB 00ffffff\n"
      "v 1 1 0\nv 2 1 0\n#MRGB ff0000ff\nf 1 2 3\nf 1 2 4\nf 1 2 5\n";
  const std::vector<Rgb> colors = read_text(text).text.colors;
  ASSERT_EQ(colors.size(), 5u);
  EXPECT_EQ(colors[0], (Rgb{1, 0, 0})) << "in place of that of the vertex";
  EXPECT_NEAR(colors[1].g, 0.50289f, 1e-4f);  // IEC 61966-2-1
  EXPECT_EQ(colors[2], Rgb::gray(1));
  EXPECT_EQ(colors[3], Rgb::gray(1)) << "the block is that of the last vertex";
  EXPECT_EQ(colors[4], (Rgb{0, 0, 1}));
  EXPECT_TRUE(warnings_of(text).empty());
}

TEST(Obj, PassesOverPolypaintThatItCannotUse) {
  const std::string text =
      "#MRGB 01020304\n" + kFourCorners + "#MRGB ffff0000 red\n#MRGB ff00ff00ff0000f\nf 1 2 3\n";
  const std::vector<Rgb> colors = read_text(text).text.colors;
  EXPECT_EQ(colors, (std::vector<Rgb>{{1, 0, 0}, Rgb::gray(1), {0, 1, 0}, Rgb::gray(1)}));
  EXPECT_EQ(
      warnings_of(text),
      (std::vector<std::string>{
          "x.obj:1: '#MRGB' has more colours than the 0 vertices before it; the further ones are ignored",
          "x.obj:6: a colour of '#MRGB' must be 8 hexadecimal digits, got 'red'; the vertex has no "
          "colour (2 times)"}));
}

TEST(Obj, IsRefusedWithoutFaces) {
  const std::pair<std::string, std::string> cases[] = {
      {"", "the file has no faces (no 'f' statement); is it complete?"},
      {kFourCorners, "the file has no faces (no 'f' statement); is it complete?"},
      {"surf 0 1 0 1 1 2 3\n",
       "the file has no faces (no 'f' statement): free-form curves and surfaces are not supported; export "
       "the "
       "mesh as polygons"},
      {"ply\n",
       "the file has no faces (no 'f' statement), and 'ply' is not a statement of OBJ files; is it one?"},
      {kFourCorners + "f 1 2\n",
       "1 of 1 faces cannot be used; is the file complete? The first: line 5: a face must have at least 3 "
       "corners, got 2"},
      {"v 0 0 0\n# one\nv 1 nan 0\nv 0 1 0\nf 1 3 2\n",
       "1 of 1 faces cannot be used; is the file complete? The first: line 5: a face refers to 'v' number 2 "
       "in "
       "line 3, which is not 3 finite numbers"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(obj_error(text), "x.obj: " + message) << text;
}

TEST(Obj, IsRefusedWhereHardlyAFaceIsLeft) {
  std::string text = kFourCorners + "f 1 2 3\n";
  for (int i = 0; i < 9; ++i) text += "f 7 8 9\n";
  EXPECT_EQ(obj_error(text), "no error");
  EXPECT_EQ(
      obj_error(text + "f 7 8 9\n"),
      "x.obj: 10 of 11 faces cannot be used; is the file complete? The first: line 6: a face refers to 'v' "
      "number 7, but the file has only 4");
}

TEST(Obj, LeavesOutConcaveFacesOfTooManyCorners) {
  std::string text, face = "f 1 2 3\nf";
  for (int i = 0; i < 6000; ++i) {
    text += "v " + std::to_string(i) + " " + std::to_string(i % 2) + " 0\n";
    face += " " + std::to_string(i + 1);
  }
  EXPECT_EQ(warnings_of(text + "v 3000 9999 0\n" + face + " 6001\n"),
            (std::vector<std::string>{
                "x.obj:6003: a face of 6001 corners has too many notches; split it; the face is left out"}));
}

TEST(Obj, TellsFacesWithoutAnArea) {
  const std::string text = kFourCorners + "v 2 0 0\nf 1 2 3\nf 1 2 5\nf 1 2 1 2\nf 1 2 5 3\n";
  EXPECT_EQ(warnings_of(text),
            (std::vector<std::string>{"x.obj:7: a face without an area is left out (2 times)"}));
}

TEST(Obj, IsRefusedWhenCutBeforeItsFaces) {
  const std::string text = kFourCorners + "vt 0.5 0.5\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/1/1 4/1/1\n";
  for (std::size_t size = 0; size < text.find("f ") + 10; ++size)
    EXPECT_NE(obj_error(text.substr(0, size)), "no error") << size;
  EXPECT_EQ(obj_error(text), "no error");
}

}  // namespace
}  // namespace tessera::core::obj_test
