// Readers of mesh files, called directly: the same mesh in every form that a format allows reads the same.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cstring>

#include "measure/formats/mesh_file.h"
#include "measure/formats/text_lines.h"

namespace formats_test {

using namespace gnomon;
using namespace gnomon::importing;
namespace fs = std::filesystem;

MeshFile read(const std::string& name, const std::string& bytes) {
  return read_mesh_file(name, [&](const fs::path&) { return bytes; });
}
std::string error_of(const std::string& name, const std::string& bytes) {
  try {
    read(name, bytes);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}
void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << '"' << word << "\" in: " << text;
}

/// Small whole coordinates, so that every form keeps them to the bit; faces of three to five corners.
struct Model {
  std::vector<glm::dvec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
};
Model random_model() {
  Model model;
  const auto coordinate = rc::gen::inRange(-20, 20);
  const std::size_t count = *rc::gen::inRange<std::size_t>(3, 12);
  for (std::size_t v = 0; v < count; ++v) model.positions.emplace_back(*coordinate, *coordinate, *coordinate);
  const std::size_t faces = *rc::gen::inRange<std::size_t>(1, 8);
  for (std::size_t f = 0; f < faces; ++f) {
    std::vector<std::uint32_t>& face = model.faces.emplace_back(*rc::gen::inRange<std::size_t>(3, 6));
    for (std::uint32_t& corner : face) corner = *rc::gen::inRange<std::uint32_t>(0, static_cast<std::uint32_t>(count));
  }
  return model;
}

/// The corners of all faces as places: readers may number vertices anew.
std::vector<std::vector<glm::dvec3>> faces_of(const Model& model) {
  std::vector<std::vector<glm::dvec3>> faces;
  for (const auto& face : model.faces) {
    faces.emplace_back();
    for (const std::uint32_t corner : face) faces.back().push_back(model.positions[corner]);
  }
  return faces;
}
std::vector<std::vector<glm::dvec3>> faces_of(const MeshFile& file) {
  std::vector<std::vector<glm::dvec3>> faces;
  for (const ImportedMesh& mesh : file.meshes) {
    auto corner = mesh.corners.begin();
    for (const std::uint32_t count : mesh.corner_counts) {
      faces.emplace_back();
      for (std::uint32_t k = 0; k < count; ++k) faces.back().push_back(mesh.positions.at(*corner++));
    }
  }
  return faces;
}

bool flip() { return *rc::gen::arbitrary<bool>(); }
template <class... Texts>
std::string one_of(const Texts&... texts) {
  return *rc::gen::element(std::string(texts)...);
}

/// Bytes of a number, the highest or the lowest first.
template <class T>
void put(std::string& bytes, T value, bool is_big_endian) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (is_big_endian) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

/// A PLY of one of three forms, with other elements before, between and behind, and properties that nobody needs.
std::string ply_of(const Model& model) {
  const std::string format = one_of("ascii", "binary_little_endian", "binary_big_endian");
  const bool is_text = format == "ascii", is_big = format == "binary_big_endian";
  const std::string end = one_of("\n", "\r\n");
  const bool has_double = flip(), has_extra = flip(), first = flip(), between = !first && flip();
  const std::string other = end + "element camera 2" + end + "property uchar id" + end + "property list ushort short k";
  std::string head = "ply" + end + "format " + format + " 1.0" + end + "comment element face 7";
  if (first) head += other;
  head += end + "element vertex " + std::to_string(model.positions.size());
  if (has_extra) head += end + "property short quality";
  for (const char* axis : {"x", "y", "z"}) head += end + "property " + (has_double ? "double " : "float ") + axis;
  if (between) head += other;
  head += end + "element face " + std::to_string(model.faces.size()) + end + "property list uchar int vertex_indices";
  if (has_extra) head += end + "property list uchar float texcoord";
  if (!first && !between) head += other;
  head += end + "end_header" + end;

  std::string body;
  const auto number = [&](auto value) {
    if (is_text)
      body += fmt::format("{} ", value);
    else
      put(body, value, is_big);
  };
  const auto byte = [&](std::uint8_t value) { is_text ? number(int{value}) : number(value); };
  const auto line_ends = [&] {
    if (is_text) body += end;
  };
  const auto cameras = [&] {
    for (int camera = 0; camera < 2; ++camera) {
      byte(10);  // a line feed, where the body is bytes
      number(std::uint16_t{2});
      number(std::int16_t{-1});
      number(std::int16_t{13});
      line_ends();
    }
  };
  if (first) cameras();
  for (const glm::dvec3& p : model.positions) {
    if (has_extra) number(std::int16_t{-5});
    for (int k = 0; k < 3; ++k) has_double ? number(p[k]) : number(static_cast<float>(p[k]));
    line_ends();
  }
  if (between) cameras();
  for (const auto& face : model.faces) {
    byte(static_cast<std::uint8_t>(face.size()));
    for (const std::uint32_t corner : face) number(static_cast<std::int32_t>(corner));
    if (has_extra) {
      byte(2);
      number(0.5f);
      number(1.5f);
    }
    line_ends();
  }
  if (!first && !between) cameras();
  return (flip() ? "\xEF\xBB\xBF" : "") + head + body;
}

RC_GTEST_PROP(Ply, reads_the_same_in_every_form, ()) {
  const Model model = random_model();
  const MeshFile file = read("model.ply", ply_of(model));
  RC_ASSERT(faces_of(file) == faces_of(model));
  RC_ASSERT(file.notes == std::vector<std::string>{"2 elements are left out: 'camera'"});
}

RC_GTEST_PROP(Obj, reads_the_same_however_its_lines_are_written, ()) {
  const Model model = random_model();
  const std::string end = one_of("\n", "\r\n", "\r");
  const auto blank = [&] { return one_of(" ", "\t", "  ", " \\" + end + " "); };
  const auto line_end = [&] {
    return one_of("", " ", " # v 1 2 3", " #\tf 1 2 3 4") + end + one_of("", end, "# f 9 9 9" + end);
  };
  std::string text = flip() ? "\xEF\xBB\xBF" : "";
  const std::size_t ahead = *rc::gen::inRange<std::size_t>(0, model.positions.size());
  const auto vertex = [&](std::size_t v) {
    text += one_of("", " ", "\t") + "v";
    for (int k = 0; k < 3; ++k) text += blank() + fmt::format("{}", model.positions[v][k]);
    text += one_of("", " 1", " 0.5 0.5 0.5", " 0.5 0.5 0.5 1", " 1 0 0 0 1") + line_end();
  };
  for (std::size_t v = 0; v < ahead; ++v) vertex(v);
  // Faces name vertices that are still to come, or count back from those that are there.
  for (const auto& face : model.faces) {
    text += one_of("", " ") + "f";
    for (const std::uint32_t corner : face) {
      const bool counts_back = corner < ahead && flip();
      const long index = counts_back ? static_cast<long>(corner) - static_cast<long>(ahead) : static_cast<long>(corner) + 1;
      text += blank() + std::to_string(index) + one_of("", "/7", "//7", "/7/7", "/");
    }
    text += line_end();
  }
  for (std::size_t v = ahead; v < model.positions.size(); ++v) vertex(v);
  const MeshFile file = read("model.obj", text);
  RC_ASSERT(faces_of(file) == faces_of(model));
  RC_ASSERT(file.notes.empty());
}

RC_GTEST_PROP(Off, reads_the_same_in_every_variant, ()) {
  const Model model = random_model();
  const bool has_texture = flip(), has_color = flip(), has_normal = flip(), has_weight = flip(), is_binary = flip();
  std::string text =
      std::string(has_texture ? "ST" : "") + (has_color ? "C" : "") + (has_normal ? "N" : "") + (has_weight ? "4" : "") + "OFF";
  const int beside = (has_normal ? 3 : 0) + (has_color ? 4 : 0) + (has_texture ? 2 : 0);
  if (is_binary) {
    text += " BINARY\n";
    for (const std::size_t count : {model.positions.size(), model.faces.size(), std::size_t{0}})
      put(text, static_cast<std::uint32_t>(count), true);
  } else {
    if (text == "OFF" && flip()) text.clear();
    text += one_of("\n", " ", "\n# 1 2 3\n", text.empty() ? "\n" : "") +
            fmt::format("{} {}", model.positions.size(), model.faces.size()) + one_of("", " 0") + "\n";
  }
  for (const glm::dvec3& p : model.positions) {
    const double weight = has_weight ? 2 : 1;
    for (int k = 0; k < 3; ++k)
      is_binary ? put(text, static_cast<float>(weight * p[k]), true) : (text += fmt::format("{} ", weight * p[k]), void());
    if (has_weight) is_binary ? put(text, 2.0f, true) : (text += "2 ", void());
    for (int k = 0; k < beside; ++k) is_binary ? put(text, 0.25f, true) : (text += "0.25 ", void());
    if (!is_binary) text += one_of("\n", " # 3\n", "\n\n", "\r\n");
  }
  for (const auto& face : model.faces) {
    if (is_binary) {
      put(text, static_cast<std::uint32_t>(face.size()), true);
      for (const std::uint32_t corner : face) put(text, corner, true);
      put(text, std::uint32_t{1}, true);
      put(text, 0.5f, true);
      continue;
    }
    text += std::to_string(face.size());
    for (const std::uint32_t corner : face) text += fmt::format(" {}", corner);
    text += one_of("", " 255 0 0", " 0.5 0.5 0.5 1", " # side") + "\n";
  }
  const MeshFile file = read("model.off", text);
  RC_ASSERT(faces_of(file) == faces_of(model));
  RC_ASSERT(file.notes.empty());
}

RC_GTEST_PROP(Stl, reads_the_same_as_text_and_as_bytes, ()) {
  Model model = random_model();
  for (auto& face : model.faces) face.resize(3);
  std::string bytes = one_of("solid ", "\xEF\xBB\xBFsolid", "anything");
  bytes.resize(80, ' ');
  put(bytes, static_cast<std::uint32_t>(model.faces.size()), false);
  const bool is_upper = flip();
  std::string text = one_of("solid a facet of an endsolid\n", "  solid #1 facet\r\n", "\n\nsolid\n");
  for (const auto& face : model.faces) {
    for (int k = 0; k < 3; ++k) put(bytes, 0.0f, false);
    text += "facet normal nan 0 0" + one_of("\n", " ", "\r\n") + "outer loop\n";
    for (const std::uint32_t corner : face) {
      const glm::dvec3& p = model.positions[corner];
      text += fmt::format(" vertex {} {} {}\n", p.x, p.y, p.z);
      for (int k = 0; k < 3; ++k) put(bytes, static_cast<float>(p[k]), false);
    }
    text += "endloop endfacet\n";
    put(bytes, std::uint16_t{0xffff}, false);
  }
  text += "endsolid" + one_of("", " a facet") + "\n";
  if (is_upper)
    for (char& c : text) c = static_cast<char>(std::toupper(c));
  RC_ASSERT(faces_of(read("model.stl", bytes)) == faces_of(model));
  RC_ASSERT(faces_of(read("model.stl", text)) == faces_of(model));
}

TEST(Formats, text_of_16_bits_is_refused) {
  const std::string text("\xFF\xFEv\0 \0", 6);
  for (const char* name : {"a.obj", "a.ply", "a.off", "a.stl", "a.gltf"}) expect_words(error_of(name, text), {name, "UTF-16"});
}

TEST(Formats, numbers_with_tails_name_the_line) {
  for (const char* bad : {"1,5", "1.5D+03", "0x10", "--1", "+-1", "1e", "."}) {
    const std::string text = fmt::format("v 0 0 0\nv 1 0 0\nv {} 1 0\nf 1 2 3\n", bad);
    expect_words(error_of("a.obj", text), {"a.obj:3", bad, "is not a number"});
  }
  for (const char* good : {"+1.5", "1.", ".5", "1e3", "-0", "1E-400"})
    EXPECT_EQ(error_of("a.obj", fmt::format("v 0 0 0\nv 1 0 0\nv {} 1 0\nf 1 2 3\n", good)), "") << good;
}

TEST(Formats, lines_after_the_end_are_noted) {
  const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 2 1\n\n7\n";
  EXPECT_EQ(read("a.off", off).notes, std::vector<std::string>{"2 lines after the last face are left out"});
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0 9\n1 0 0\n0 1 0\n3 0 1 2\n3 0 2 1\n";
  EXPECT_EQ(read("a.ply", ply).notes, (std::vector<std::string>{"1 line holds more than the properties; the rest is left out",
                                                                "1 line after the last element is left out"}));
}

TEST(Obj, objects_groups_and_materials_become_meshes) {
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no house\ng wall\nf 1 2 3\nusemtl red\nf 3 2 1\ng wall\nf 1 3 2\no house\nf 2 3 1\n";
  std::vector<std::pair<std::string, std::size_t>> parts;
  for (const ImportedMesh& mesh : read("a.obj", text).meshes) parts.emplace_back(mesh.name, mesh.corner_counts.size());
  EXPECT_EQ(parts, (std::vector<std::pair<std::string, std::size_t>>{{"", 1}, {"house", 1}, {"wall", 1}, {"red", 2}}));
}

TEST(Obj, a_remark_begins_a_word) {
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0 # 7\nusemtl Material_#25\nf 1 2 3\nusemtl Material_#26\nf 1 2 3 #4\n";
  const MeshFile file = read("a.obj", text);
  ASSERT_EQ(file.meshes.size(), 2u) << "two materials";
  EXPECT_EQ(file.meshes[1].name, "Material_#26");
  for (const char* bad : {"-1.#IND00", "1.#INF", "1.#QNAN"})
    expect_words(error_of("a.obj", fmt::format("v 0 0 {}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", bad)),
                 {"a.obj:1", bad, "not a number"});
}

TEST(Obj, an_object_that_comes_again_keeps_the_material_that_is_used) {
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\no A\nusemtl red\nf 1 2 3\no B\nusemtl blue\nf 1 2 3\no A\nf 1 2 3\n";
  EXPECT_EQ(read("a.obj", text).meshes.size(), 3u);
}

TEST(Obj, what_is_no_face_is_counted) {
  const MeshFile file =
      read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\np 1 2 3\nl 1 2 3\nsurf 0 1 0 1 1 2 3\nnonsense 3\n");
  EXPECT_EQ(file.notes, (std::vector<std::string>{
                            "5 points and lines are left out", "1 face has fewer than three corners and is left out",
                            "1 free-form curve or surface is left out",
                            "1 line opens with a word that is unknown to OBJ and is left out ('nonsense' of line 9)"}));
}

TEST(Ply, counts_of_strips_are_whole_numbers) {
  for (const char* bad : {"2.5", "-1", "nan"})
    EXPECT_NE(
        error_of("a.ply",
                 fmt::format("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                             "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                             "0 0 0\n1 0 0\n0 1 0\n{} 0 1 2\n",
                             bad)),
        "")
        << bad;
}

TEST(Off, letters_may_stand_in_any_order) {
  const std::string text = "NCOFF\n3 1 0\n0 0 0 0 0 1 1 1 1 1\n1 0 0 0 0 1 1 1 1 1\n0 1 0 0 0 1 1 1 1 1\n3 0 1 2\n";
  EXPECT_EQ(faces_of(read("a.off", text)).size(), 1u);
}

TEST(Stl, texts_that_are_none_are_named) {
  std::string page = "<!DOCTYPE html><html>" + std::string(100, ' ');
  expect_words(error_of("a.stl", page), {"neither a text that opens with 'solid'"});
  const std::string facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  EXPECT_EQ(faces_of(read("a.stl", "solid a\n" + facet + "endsolid a\n\x1a")).size(), 1u) << "as old systems end a text";
}

TEST(Ply, a_header_that_ends_lines_in_returns_leaves_the_body_alone) {
  std::string bytes =
      "ply\rformat binary_little_endian 1.0\relement tag 1\rproperty uchar t\relement vertex 3\rproperty float x\r"
      "property float y\rproperty float z\relement face 1\rproperty list uchar uchar vertex_index\rend_header\r\n";
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) put(bytes, x, false);
  bytes += std::string("\3\0\1\2", 4);
  EXPECT_EQ(faces_of(read("a.ply", bytes)).size(), 1u);
}

}  // namespace formats_test
