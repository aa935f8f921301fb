// What readers take of glass: alpha of blended materials, KHR_materials_transmission, d and Tr of OBJ.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "error_words.h"
#include "measure/formats/mesh_file.h"
#include "measure/scratch_folder.h"

namespace transmission_formats_test {

using namespace gnomon;
using namespace error_words;
using namespace gnomon::importing;
namespace fs = std::filesystem;

constexpr std::uint32_t no_image = ImportedMask::no_image;

// --- glTF

/// A triangle whose numbers, 0, are in a file beside it, with three images of one byte each.
struct Pane {
  std::string material;  ///< what its material has beside the mode
  std::string mode = "OPAQUE", more_attributes;
  std::string samplers[3] = {"0", "0", "0"};
  std::string images = R"({"uri":"data:;base64,AAAA"},{"uri":"data:;base64,AAAB"},{"uri":"data:;base64,AAAC"})";
  float color = 1;  ///< of the vertices' first number

  MeshFile read(bool with_uv = false) const {
    std::string json = R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"material":0,"attributes":{"POSITION":0,"TEXCOORD_0":1,"TEXCOORD_1":1)" +
                       more_attributes + R"(}}]}],"materials":[{"alphaMode":")" + mode + '"' + material + R"(}],"textures":[)";
    for (int k = 0; k < 3; ++k) json += fmt::format(R"({}{{"source":{},"sampler":{}}})", k > 0 ? "," : "", k, samplers[k]);
    json += R"(],"images":[)" + images + R"(],"samplers":[{"wrapS":33071,"wrapT":33648},{}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
          {"bufferView":0,"componentType":5126,"count":3,"type":"VEC2"},
          {"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,"type":"VEC4"},
          {"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":84}],"buffers":[{"byteLength":84,"uri":"numbers.bin"}]})";
    const std::vector<float> ones(12, 1.0f);
    std::string numbers(36, '\0');
    numbers.append(reinterpret_cast<const char*>(ones.data()), 48);
    std::memcpy(&numbers[36], &color, 4);
    folder.write("numbers.bin", numbers);
    return read_mesh_file(
        folder.scratch.path() / "a.gltf", [&](const fs::path& file) { return file.extension() == ".gltf" ? json : numbers; },
        with_uv);
  }
  struct Files {
    ScratchFolder scratch = ScratchFolder::temporary("gnomon_glass");
    void write(const std::string& name, const std::string& bytes) const {
      std::ofstream(scratch.path() / name, std::ios::binary) << bytes;
    }
  } folder;
  ImportedTransmission transmission() const { return read().meshes.at(0).transmission; }
};

TEST(GltfTransmission, opaque_and_masked_materials_have_none) {
  for (const char* mode : {"OPAQUE", "MASK", "BLEND"}) {
    Pane pane;
    pane.mode = mode;
    EXPECT_FALSE(pane.transmission().is_there()) << mode << ": the alpha is 1";
    pane.material = R"(,"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25]})";
    EXPECT_EQ(pane.transmission().is_there(), pane.mode == "BLEND") << mode;
    EXPECT_EQ(pane.read().meshes.at(0).is_transparent, pane.mode != "OPAQUE") << mode << ": a mask of 0.25 is not there";
  }
}

TEST(GltfTransmission, blend_takes_the_alpha_of_factor_and_image_with_its_wrapping) {
  Pane pane;
  pane.mode = "BLEND";
  pane.material = R"(,"pbrMetallicRoughness":{"baseColorFactor":[0.5,1,1,0.25],"baseColorTexture":{"index":1}})";
  const MeshFile file = pane.read();
  const ImportedTransmission glass = file.meshes.at(0).transmission;
  EXPECT_EQ(glass.alpha, 0.25);
  EXPECT_EQ(glass.transmission, 0);
  EXPECT_EQ(file.mask_images.at(glass.alpha_image).bytes, std::string("\0\0\1", 3));
  EXPECT_FALSE(file.mask_images[glass.alpha_image].wants_colors);
  EXPECT_EQ(glass.color_image, no_image) << "what blends has no color";
  EXPECT_EQ(glass.wrap_u, AlphaMask::Wrap::clamp);
  EXPECT_EQ(glass.wrap_v, AlphaMask::Wrap::mirror);
  EXPECT_EQ(file.meshes[0].uv.size(), 3u);
  EXPECT_FALSE(file.meshes[0].mask.has_image());
}

TEST(GltfTransmission, the_extension_takes_factors_and_images) {
  Pane pane;
  pane.material = R"(,"extensions":{"KHR_materials_transmission":{"transmissionFactor":0.75,"transmissionTexture":{"index":1}}},
      "pbrMetallicRoughness":{"baseColorFactor":[1,0.2,0.1,0.3],"baseColorTexture":{"index":0},
                              "metallicFactor":0.5,"metallicRoughnessTexture":{"index":2}})";
  const MeshFile file = pane.read();
  const ImportedTransmission glass = file.meshes.at(0).transmission;
  EXPECT_EQ(glass.transmission, 0.75);
  EXPECT_EQ(glass.metallic, 0.5);
  EXPECT_EQ(glass.color, glm::dvec3(1, 0.2, 0.1)) << "in double, as written";
  EXPECT_EQ(glass.alpha, 1) << "an opaque material has no other";
  EXPECT_EQ(glass.alpha_image, no_image);
  EXPECT_EQ(file.mask_images.at(glass.color_image).bytes.back(), '\0');
  EXPECT_EQ(file.mask_images.at(glass.transmission_image).bytes.back(), '\1');
  EXPECT_EQ(file.mask_images.at(glass.metallic_image).bytes.back(), '\2');
  for (const MaskImage& image : file.mask_images) EXPECT_TRUE(image.wants_colors) << image.name;
}

// A metal lets no light through, and the format's default is metal.
TEST(GltfTransmission, defaults_are_those_of_the_format) {
  Pane pane;
  pane.material = R"(,"extensions":{"KHR_materials_transmission":{}})";
  EXPECT_FALSE(pane.transmission().is_there());
  pane.material = R"(,"extensions":{"KHR_materials_transmission":{"transmissionFactor":1}})";
  EXPECT_EQ(pane.transmission().metallic, 1);
  const char* const is_metal = "1 material has KHR_materials_transmission and a metallicFactor of 1, the format's default";
  EXPECT_TRUE(has_note(pane.read(), is_metal));
  EXPECT_EQ(pane.transmission().color, glm::dvec3(1));
  EXPECT_EQ(pane.transmission().wrap_u, AlphaMask::Wrap::repeat);
  const std::string glass = pane.material;
  pane.material = glass + R"(,"pbrMetallicRoughness":{"metallicFactor":0})";
  EXPECT_EQ(pane.transmission().metallic, 0);
  EXPECT_FALSE(has_note(pane.read(), is_metal));
  pane.material = glass + R"(,"pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":0}})";
  EXPECT_FALSE(has_note(pane.read(), is_metal)) << "the image decides";
}

TEST(GltfTransmission, images_with_other_places_or_another_wrap_are_noted_and_left_out) {
  Pane pane;
  const auto with = [&](const std::string& more) {
    pane.material = R"(,"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0},
        "extensions":{"KHR_materials_transmission":{"transmissionFactor":1,"transmissionTexture":{"index":1)" +
                    more + "}}}";
    return pane.read();
  };
  const char* const words = "1 texture of transmission has other places or another wrap than the color's";
  EXPECT_FALSE(has_note(with(""), words));
  const std::string turned = R"(,"extensions":{"KHR_texture_transform":{"offset":[0.5,0]}})";
  for (const std::string& more : {std::string(R"(,"texCoord":1)"), turned}) {
    const MeshFile file = with(more);
    EXPECT_TRUE(has_note(file, words)) << more;
    EXPECT_EQ(file.meshes.at(0).transmission.transmission_image, no_image);
    EXPECT_NE(file.meshes[0].transmission.color_image, no_image);
    EXPECT_EQ(file.meshes[0].uv.at(0), glm::vec2(0)) << "the color's places count";
  }
  pane.samplers[1] = "1";
  EXPECT_TRUE(has_note(with(""), words));
}

TEST(GltfTransmission, places_are_those_of_the_only_image) {
  Pane pane;
  pane.material = R"(,"pbrMetallicRoughness":{"metallicFactor":0},"extensions":{"KHR_materials_transmission":{
      "transmissionFactor":1,"transmissionTexture":{"index":1,"extensions":{"KHR_texture_transform":{"offset":[0.5,0.25]}}}}})";
  const MeshFile file = pane.read();
  EXPECT_EQ(file.meshes.at(0).uv.at(0), glm::vec2(0.5f, 0.25f));
  EXPECT_FALSE(has_note(file, "other places"));
}

TEST(GltfTransmission, a_mask_keeps_its_bits_and_transmits_where_it_is_solid) {
  Pane pane;
  pane.mode = "MASK";
  pane.material = R"(,"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.75],"baseColorTexture":{"index":0},"metallicFactor":0},
      "extensions":{"KHR_materials_transmission":{"transmissionFactor":0.5}})";
  const MeshFile file = pane.read();
  EXPECT_EQ(file.meshes.at(0).mask.factor, 0.75f);
  EXPECT_EQ(file.meshes[0].transmission.alpha, 1) << "the mask is the alpha";
  EXPECT_EQ(file.meshes[0].transmission.transmission, 0.5);
  EXPECT_EQ(file.meshes[0].mask.image, file.meshes[0].transmission.color_image);
  EXPECT_TRUE(has_note(file, "1 material has a mask and KHR_materials_transmission"));
}

TEST(GltfTransmission, volume_and_colors_of_vertices_are_noted) {
  Pane pane;
  pane.material = R"(,"extensions":{"KHR_materials_transmission":{"transmissionFactor":1},
      "KHR_materials_volume":{"thicknessFactor":0.1}})";
  EXPECT_TRUE(has_note(pane.read(), "1 material has a volume (KHR_materials_volume) and is read as a thin surface"));
  for (const char* accessor : {"2", "3"}) {
    pane.more_attributes = fmt::format(R"(,"COLOR_0":{})", accessor);
    pane.color = 1;
    EXPECT_FALSE(has_note(pane.read(), "a color, which is not used"));
    pane.color = 0.5f;
    EXPECT_TRUE(has_note(pane.read(), "1 vertex of meshes that transmit light has a color, which is not used")) << accessor;
  }
}

TEST(GltfTransmission, missing_images_are_noted_and_the_factors_count) {
  Pane pane;
  pane.mode = "BLEND";
  pane.material = R"(,"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25],"baseColorTexture":{"index":0}})";
  pane.images = R"({"uri":"nowhere/pane.png"},{},{})";
  const MeshFile file = pane.read();
  EXPECT_FALSE(file.meshes.at(0).transmission.has_image());
  EXPECT_EQ(file.meshes[0].transmission.alpha, 0.25);
  EXPECT_TRUE(file.meshes[0].uv.empty());
  EXPECT_TRUE(has_note(file, "1 image of transmission is not there ('pane.png' is one); the factors of their materials"));
  EXPECT_FALSE(file.meshes[0].has_texture) << "there is none";
  EXPECT_FALSE(has_note(file, "alpha of 1"));
  pane.material = R"(,"pbrMetallicRoughness":{"baseColorTexture":{"index":0}})";
  EXPECT_TRUE(has_note(pane.read(), "1 material of alphaMode BLEND has an alpha of 1 without the image; it is opaque"));
}

// The file is read: a description may take the mesh for opaque, and whoever uses its glass is told.
TEST(GltfTransmission, what_is_wrong_fails_the_transmission_alone) {
  Pane pane;
  pane.mode = "BLEND";
  const auto failure = [&](const std::string& color) {
    pane.material = R"(,"pbrMetallicRoughness":{)" + color + "}";
    const MeshFile file = pane.read();
    const std::uint32_t image = file.meshes.at(0).transmission.alpha_image;
    return image == no_image ? "" : file.mask_images.at(image).failure;
  };
  EXPECT_EQ(failure(R"("baseColorTexture":{"index":0})"), "");
  expect_words(failure(R"("baseColorTexture":{"index":7})"), {"item 7 of 'textures'"});
  expect_words(failure(R"("baseColorTexture":{})"), {"material 0", "no index"});
  pane.samplers[0] = "5";
  expect_words(failure(R"("baseColorTexture":{"index":0})"), {"item 5 of 'samplers'"});
}

// --- OBJ

struct Folder {
  ScratchFolder scratch = ScratchFolder::temporary("gnomon_glass");
  Folder() { write("leaf.png", "image"); }
  void write(const std::string& name, const std::string& bytes) const { std::ofstream(scratch.path() / name) << bytes; }
  MeshFile read(const std::string& material) const {
    write("a.mtl", "newmtl pane\n" + material);
    write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl pane\nf 1/1 2/1 3/1\n");
    return read_mesh_file(scratch.path() / "a.obj", [](const fs::path& file) {
      std::ifstream in(file, std::ios::binary);
      return std::string(std::istreambuf_iterator<char>(in), {});
    });
  }
  double alpha(const std::string& material) const { return read(material).meshes.at(0).transmission.alpha; }
};

TEST(ObjTransmission, is_one_minus_d_and_d_counts_before_tr) {
  const Folder folder;
  EXPECT_EQ(folder.alpha("Kd 1 1 1\n"), 1);
  EXPECT_EQ(folder.alpha("d 0.25\n"), 0.25);
  EXPECT_EQ(folder.alpha("Tr 0.25\n"), 0.75);
  EXPECT_EQ(folder.alpha("Tr 1\nd 0.25\n"), 0.25);
  EXPECT_EQ(folder.alpha("d 0.25\nTr 1\n"), 0.25) << "Tr is not of the specification";
  const MeshFile file = folder.read("d 0.25\n");
  EXPECT_TRUE(file.meshes.at(0).is_transparent);
  EXPECT_TRUE(file.notes.empty() && file.meshes[0].uv.empty());
  EXPECT_FALSE(folder.read("d 1\nTr 0\n").meshes.at(0).transmission.is_there());
}

// The file is read: a description may take the mesh for opaque.
TEST(ObjTransmission, a_part_outside_of_0_to_1_fails_the_transmission_alone) {
  const Folder folder;
  const MeshFile file = folder.read("d 0.5\nd 1.4\n");
  const ImportedTransmission glass = file.meshes.at(0).transmission;
  EXPECT_TRUE(glass.is_there());
  expect_words(file.mask_images.at(glass.alpha_image).failure, {"material 'pane': d = 1.4 (", "a.mtl:3) is not within 0 .. 1"});
  EXPECT_FALSE(folder.read("Tr 7\nd 0.25\n").meshes.at(0).transmission.has_image()) << "d counts";
}

TEST(ObjTransmission, halo_and_filter_are_noted_where_the_material_lets_light_through) {
  const Folder folder;
  EXPECT_EQ(folder.alpha("d -halo 0.5\n"), 0.5);
  EXPECT_TRUE(has_note(folder.read("d -halo 0.5\n"), "1 material has d -halo, which is read as d"));
  const char* const words = "1 material has a filter (Tf), which is not used";
  for (const char* filter : {"Tf 0 1 0\n", "Tf 0.5\n", "Tf xyz 1 1 1\n", "Tf spectral green.rfl\n"})
    EXPECT_TRUE(has_note(folder.read(std::string("d 0.5\n") + filter), words)) << filter;
  for (const char* material : {"d 0.5\nTf 1 1.0 1.000\n", "d 0.5\n", "Tf 0 1 0\n"})
    EXPECT_TRUE(folder.read(material).notes.empty()) << material;
}

TEST(ObjTransmission, what_is_solid_of_a_mask_transmits) {
  const Folder folder;
  const MeshFile file = folder.read("d 0.25\nmap_d leaf.png\n");
  EXPECT_EQ(file.meshes.at(0).mask.factor, 1) << "d would count twice";
  EXPECT_EQ(file.meshes[0].transmission.alpha, 0.25);
  EXPECT_FALSE(file.meshes[0].transmission.has_image());
  EXPECT_TRUE(has_note(file, "1 material has a mask (map_d) and d or Tr: what is solid transmits 1 - d"));
  EXPECT_FALSE(has_note(folder.read("map_d leaf.png\n"), "transmits"));
}

}  // namespace transmission_formats_test
