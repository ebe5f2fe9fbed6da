#include <gtest/gtest.h>

#include <cmath>

#include "core/scene/loader/obj_reader.hpp"
#include "core/scene/loader/obj_scanner.hpp"
#include "core/scene/loader/text_lines.hpp"

namespace tessera::core {
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
  EXPECT_EQ(parse_float("1e-42"), 1e-42f);
  for (const auto word :
       {"",     "+",   "-",        ".",    "e5",    "1e",    "1.5x",   "1,5", "0x10", "nan", "inf",
        "-inf", "NaN", "infinity", "1e39", "-1e39", "1e400", "1e-400", "+-1", "1 ",   " 1"})
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

TEST(Obj, ReportsMistakesWithTheirLine) {
  constexpr std::string_view kCornerAdvice =
      "a face's corner must be like 7, 7/2, 7//3 or 7/2/3 with numbers that exist, got ";
  const auto corner = [&](const std::string& word) {
    return "5: " + std::string(kCornerAdvice) + "'" + word + "' after 4 v, 0 vt and 0 vn";
  };
  const std::pair<std::string, std::string> cases[] = {
      {"", "0: the file has no faces (no 'f' statement); is it complete?"},
      {"# nothing\n", "1: the file has no faces (no 'f' statement); is it complete?"},
      {kFourCorners, "4: the file has no faces (no 'f' statement); is it complete?"},
      {"v 0 0 0\nv 1 nan 0\n", "2: a vertex must be 3 finite numbers, got '1 nan 0'"},
      {"v 0 0 0\nv 1 inf 0\n", "2: a vertex must be 3 finite numbers, got '1 inf 0'"},
      {"v 1e39 0 0\n", "1: a vertex must be 3 finite numbers, got '1e39 0 0'"},
      {"v 1.0 2", "1: a vertex must be 3 finite numbers, got '1.0 2'"},
      {"v 1.0 2.0 -", "1: a vertex must be 3 finite numbers, got '1.0 2.0 -'"},
      {"v", "1: a vertex must be 3 finite numbers, got ''"},
      {"v 1 2 3 4 5 6 7 8", "1: a vertex must be 3 finite numbers, got '1 2 3 4 5 6 7 8'"},
      {"vn 0 1", "1: a normal must be 3 finite numbers, got '0 1'"},
      {"vn 0 1 x", "1: a normal must be 3 finite numbers, got '0 1 x'"},
      {"vt", "1: a texture coordinate must be 1 to 3 finite numbers, got ''"},
      {"vt 0 -nan", "1: a texture coordinate must be 1 to 3 finite numbers, got '0 -nan'"},
      {kFourCorners + "f 1 2", "5: a face must have at least 3 corners, got 2"},
      {kFourCorners + "f", "5: a face must have at least 3 corners, got 0"},
      {kFourCorners + "f 1 2 0", corner("0")},
      {kFourCorners + "f 1 2 -5", corner("-5")},
      {kFourCorners + "f 1 2 12/", corner("12/")},
      {kFourCorners + "f 1 2 3/", corner("3/")},
      {kFourCorners + "f 1 2 3//", corner("3//")},
      {kFourCorners + "f 1 2 /3", corner("/3")},
      {kFourCorners + "f 1 2 3/-1", corner("3/-1")},
      {kFourCorners + "f 1 2 3/1/1/1", corner("3/1/1/1")},
      {kFourCorners + "f 1 2 three", corner("three")},
      {kFourCorners + "f 1 2 3.0", corner("3.0")},
      {kFourCorners + "f 1 2 99999999999", corner("99999999999")},
      {kFourCorners + "f 1 2 3\nf 1 2 5",
       "6: a face refers to 'v' number 5, but the file has only 4; is it complete?"},
      {kFourCorners + "f 1/1 2 3",
       "5: a face refers to 'vt' number 1, but the file has only 0; is it complete?"},
      {kFourCorners + "f 1//7 2 3",
       "5: a face refers to 'vn' number 7, but the file has only 0; is it complete?"},
      {"solid cube\n", "1: 'solid' is not a statement of OBJ files"},
      {std::string("\0\1\2", 3), "1: '\\x00\\x01\\x02' is not a statement of OBJ files"},
      {"ply\n", "1: 'ply' is not a statement of OBJ files"},
      {kFourCorners + "usemtl \nf 1 2 3\n", "5: 'usemtl' needs a name"},
      {"mtllib\n", "1: 'mtllib' needs a name"},
      {"surf 0 1 0 1 1 2 3\n",
       "1: free-form curves and surfaces are not supported; export the mesh as polygons"},
      {kFourCorners + "f 1 \\\n2 \\\n\nf 1 2 3\n", "5: a face must have at least 3 corners, got 2"},
      {kFourCorners + "\nf 1 \\\n2 0\nf 1 2 3\n",
       "6: a face's corner must be like 7, 7/2, 7//3 or 7/2/3 with numbers that exist, got '0' after 4 v, 0 "
       "vt "
       "and 0 vn"},
      {kFourCorners + "f 1 2 \\\n3\nf 1 2\n", "7: a face must have at least 3 corners, got 2"},
      {kFourCorners + "f 1 2 3 \\", corner("\\")},
      {kFourCorners + "f 1 2 # 3", "5: a face must have at least 3 corners, got 2"},
      {kFourCorners + "f 1 2 3\ns\n", "6: 's' must be the number of a smoothing group or 'off', got ''"},
      {kFourCorners + "s soft\nf 1 2 3\n",
       "5: 's' must be the number of a smoothing group or 'off', got 'soft'"},
      {kFourCorners + "s -1\nf 1 2 3\n", "5: 's' must be the number of a smoothing group or 'off', got '-1'"},
      {kFourCorners + "usemtl # name\nf 1 2 3\n", "5: 'usemtl' needs a name"},
      {"mtllib # name\n", "1: 'mtllib' needs a name"},
      {"call other.obj\n", "1: 'call' reads another file, which is not supported; put its statements here"},
      {"csh rm -r *\n", "1: 'csh' runs a command, which a scene must not; take the line out"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(obj_error(text), "x.obj:" + message) << text;
}

TEST(Obj, RefusesConcaveFacesOfTooManyCorners) {
  std::string text, face = "f 1 2 3\nf";
  for (int i = 0; i < 5000; ++i) {
    text += "v " + std::to_string(i) + " " + std::to_string(i % 2) + " 0\n";
    face += " " + std::to_string(i + 1);
  }
  EXPECT_EQ(obj_error(text + "v 2500 9999 0\n" + face + " 5001\n"),
            "x.obj:5003: a face that is not convex may have 4096 corners at most");
}

TEST(Obj, IsRefusedWhenCutWithinALine) {
  const std::string text = kFourCorners + "vt 0.5 0.5\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/1/1 4/1/1\n";
  const std::size_t first_face = text.find("f ");
  for (std::size_t size = 0; size < first_face + 15; ++size)
    EXPECT_NE(obj_error(text.substr(0, size)), "no error") << size;
  EXPECT_EQ(obj_error(text), "no error");
}

}  // namespace
}  // namespace tessera::core
