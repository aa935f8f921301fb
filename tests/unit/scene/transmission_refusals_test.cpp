// Glass of files and descriptions that is refused: which value, what is allowed, and where it is.
#include <gtest/gtest.h>

#include "error_words.h"
#include "glass_folder.h"

namespace transmission_refusals_test {

using namespace gnomon;
using namespace error_words;
using namespace glass_folder;

TEST(TransmissionRefusals, refuses_numbers_outside_of_0_to_1) {
  const Folder folder;
  for (const std::string& table : {plane, sphere, pane})
    for (const char* value : {"-0.1", "1.1", "[0.5, 2, 0.5]"})
      expect_words(folder.error(table + "transmission = " + value + "\n"), {".transmission = ", "within 0 .. 1", "test.toml:"});
  for (const char* value : {"nan", "inf", "-inf", "1e40", "[0.5, nan, 0.5]", "[-1e40, 0, 0]"})
    expect_words(folder.error(plane + "transmission = " + value + "\n"), {"plane.transmission = ", "is not within 0 .. 1"});
  for (const char* value : {"[]", "[0.5, 0.5]", "[0, 0, 0, 0]", "{}", "2020-01-01"})
    expect_words(folder.error(pane + "transmission = " + value + "\n"),
                 {"mesh.transmission = a", "is not a number of 0 .. 1, three of them, or the name of an image", "test.toml:3"});
  expect_words(folder.error(pane + "transmission = [0.5, \"a\", 0.5]\n"),
               {"mesh.transmission = a list with something else is not a number of 0 .. 1, three of them", "test.toml:3"});
  for (const auto& [line, words] : {std::pair("d 1.5", "d = 1.5"), std::pair("d -0.25", "d = -0.25"),
                                    std::pair("d nan", "d = nan"), std::pair("Tr 3", "Tr = 3")}) {
    folder.write("pane.mtl", std::string("newmtl pane\n") + line + "\n");
    expect_words(folder.error(pane), {"pane.obj: mesh 'pane'", "material 'pane'", words, "pane.mtl:2", "is not within 0 .. 1"});
    EXPECT_EQ(folder.error(pane + "transmission = false\n"), "") << line;
  }
  folder.write("pane.mtl", "newmtl pane\nTr 3\nd 0.5\n");
  EXPECT_EQ(values(folder.read(pane)), std::vector<float>{0.5f}) << "d counts, wherever it is";
  for (const char* color : {"[1,-0.2,0,1]", "[1,1.5,0,1]"}) {
    folder.write_gltf(thin(color));
    expect_words(folder.error(gltf), {"a.gltf: mesh", "its color of", "within 0 .. 1"});
  }
  folder.write_gltf(R"("alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,-1]})");
  expect_words(folder.error(gltf), {"a.gltf: mesh", "alpha of -1"});
  folder.write_gltf(R"("extensions":{"KHR_materials_transmission":{"transmissionFactor":1.25}})");
  expect_words(folder.error(gltf), {"a.gltf: mesh", "transmission of 1.25"});
  folder.write_gltf(
      R"("extensions":{"KHR_materials_transmission":{"transmissionFactor":1}},"pbrMetallicRoughness":{"metallicFactor":-2})");
  expect_words(folder.error(gltf), {"a.gltf: mesh", "metallic factor of -2"});
}

TEST(TransmissionRefusals, refuses_to_show_what_is_opaque) {
  const Folder folder;
  for (const char* seen : {"seen = true\n", "seen = false\n"}) {
    expect_words(folder.error(plane + seen), {"plane.seen", "allowed without a transmission", "test.toml:6"});
    for (const std::string& table : {plane, pane})
      expect_words(folder.error(table + "transmission = 0\n" + seen), {".seen = ", "beside a transmission of false or 0"});
  }
  folder.write("black.png", png(1, 1, {0}));
  expect_words(folder.error(plane + "transmission = \"black.png\"\nseen = true\n"), {"plane.seen", "lets no light through"});
  folder.write("pane.mtl", "newmtl pane\n");
  expect_words(folder.error(pane + "seen = false\n"), {"pane.obj", "has no mesh that lets light through"});
}

TEST(TransmissionRefusals, refuses_images_that_it_cannot_read_or_place) {
  const Folder folder;
  for (const char* flag : {"true", "false"})
    expect_words(folder.error(plane + "transmission = " + flag + "\n"), {"plane.transmission", "an image of a plane"});
  expect_words(folder.error(sphere + "transmission = \"half.png\"\n"), {"sphere.transmission = 'half.png'", "a plane alone"});
  for (const std::string& table : {plane, pane}) {
    expect_words(folder.error(table + "transmission = \"gone.png\"\n"), {"gone.png", "does not exist", "test.toml:"});
    folder.write("bad.png", "no image");
    expect_words(folder.error(table + "transmission = \"bad.png\"\n"), {"bad.png", "cannot be read", "test.toml:"});
  }
  const std::string blend = R"("alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorTexture":{"index":0}})";
  folder.write("0.png", "no image");
  folder.write_gltf(blend);
  expect_words(folder.error(gltf), {"a.gltf: mesh", "its transmission", "0.png", "cannot be read", "transmission = false"});
  EXPECT_EQ(folder.error(gltf + "transmission = 0.5\n"), "");
  folder.write("0.png", png(2, 2, {9, 0, 9, 255}));
  folder.write_gltf(blend, "1");
  expect_words(folder.error(gltf), {"a.gltf: mesh", "vertex 0", "has no texture coordinates", "a transmission of an image",
                                    "transmission = false loads it as opaque"});
}

TEST(TransmissionRefusals, a_file_name_may_not_be_empty) {
  const Folder folder;
  expect_words(folder.error(plane + "transmission = \"\"\n"),
               {"plane.transmission = '' is not the name of a file (", "test.toml:6"});
  expect_words(folder.error(pane + "transmission = \"\"\n"),
               {"mesh.transmission = '' is not the name of a file (", "test.toml:3"});
  expect_words(folder.error("[[mesh]]\nfile = \"\"\n"), {"mesh.file = '' is not the name of a file (", "test.toml:2"});
}

// A mesh file that no description names has no keys.
TEST(TransmissionRefusals, an_error_names_a_key_only_where_a_description_may_have_it) {
  const Folder folder;
  const auto alone = [&](const char* name) {
    return error_of([&] {
      Scene scene;
      import_file(folder.scratch.path() / name, {}, scene);
    });
  };
  const auto expect_hint = [&](const std::string& in_description, const std::string& hint, const char* name) {
    expect_words(in_description, {hint});
    EXPECT_NE(alone(name), "") << name;
    EXPECT_EQ(alone(name).find(" = false"), std::string::npos) << alone(name);
  };
  const std::string opaque = "(transmission = false loads it as opaque)", solid = "(masks = false loads it as solid)";
  folder.write("pane.mtl", "newmtl pane\nd 1.5\n");
  expect_hint(folder.error(pane), opaque, "pane.obj");
  folder.write_gltf(R"("extensions":{"KHR_materials_transmission":{"transmissionFactor":1.25}})");
  expect_hint(folder.error(gltf), opaque, "a.gltf");
  folder.write("0.png", png(2, 2, {9, 0, 9, 255}));
  folder.write_gltf(R"("alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorTexture":{"index":0}})", "1");
  expect_hint(folder.error(gltf), opaque, "a.gltf");
  folder.write_gltf(R"("alphaMode":"MASK","pbrMetallicRoughness":{"baseColorTexture":{"index":0}})", "1");
  expect_hint(folder.error(gltf), solid, "a.gltf");
  folder.write("0.png", "no image");
  folder.write_gltf(R"("alphaMode":"MASK","pbrMetallicRoughness":{"baseColorTexture":{"index":0}})");
  expect_hint(folder.error(gltf), solid, "a.gltf");
}

TEST(TransmissionRefusals, an_error_names_the_mesh_file_once) {
  const Folder folder;
  const std::string texture = R"("pbrMetallicRoughness":{"baseColorTexture":{"index":9}})";
  for (const std::string& material :
       {std::string(R"("extensions":{"KHR_materials_transmission":{"transmissionFactor":"half"}})"),
        R"("alphaMode":"BLEND",)" + texture, R"("alphaMode":"MASK",)" + texture}) {
    folder.write_gltf(material);
    const std::string error = folder.error(gltf), name = "a.gltf: ";
    const std::size_t first = error.find(name);
    EXPECT_NE(first, std::string::npos) << error;
    EXPECT_EQ(error.find(name, first + 1), std::string::npos) << error;
  }
}

}  // namespace transmission_refusals_test
