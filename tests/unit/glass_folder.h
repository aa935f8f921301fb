#pragma once
// Files with glass for tests of loading: a folder with an OBJ, a glTF and images, and descriptions of what is in it.
#include <fstream>

#include "error_words.h"
#include "measure/exchange/mask_png.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"

namespace gnomon::glass_folder {

using Bytes = std::vector<std::uint8_t>;

inline std::string png(int width, int channels, const Bytes& texels) {
  const auto bytes = png_of(width, static_cast<int>(texels.size()) / (width * channels), channels, texels);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline const std::string plane = "[[shape]]\nkind = \"plane\"\ncenter = [0, 0, 0]\nnormal = [0, 0, 1]\nsize = [2, 2]\n";
inline const std::string sphere = "[[shape]]\nkind = \"sphere\"\ncenter = [0, 1, 0]\nradius = 1\n";
inline const std::string pane = "[[mesh]]\nfile = \"pane.obj\"\n", gltf = "[[mesh]]\nfile = \"a.gltf\"\n";

/// A folder with pane.obj, a square whose material has d = 0.25.
struct Folder {
  ScratchFolder scratch = ScratchFolder::temporary("gnomon_glass");
  Folder() {
    write("pane.obj",
          "mtllib pane.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl pane\n"
          "f 1/1 2/2 3/3 4/4\n");
    write("pane.mtl", "newmtl pane\nd 0.25\n");
    write("half.png", png(2, 1, {51, 204}));
  }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(scratch.path() / name, std::ios::binary) << bytes;
  }
  Scene read(const std::string& toml) const {
    write("test.toml", toml);
    return read_scene_toml(scratch.path() / "test.toml");
  }
  std::string error(const std::string& toml) const {
    return error_words::error_of([&] { read(toml); });
  }
  /// A triangle of glTF with this material; its images are 0.png, 1.png and 2.png. uv are the first numbers of its corners.
  void write_gltf(const std::string& material, const std::string& corners = "0") const {
    std::string bytes;
    for (const float number : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
      bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
    write("a.bin", bytes);
    write("a.gltf", R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
      "meshes":[{"primitives":[{"material":0,"attributes":{"POSITION":0,"TEXCOORD_)" +
                        corners + R"(":1}}]}],"materials":[{)" + material +
                        R"(}],"textures":[{"source":0},{"source":1},{"source":2}],
      "images":[{"uri":"0.png"},{"uri":"1.png"},{"uri":"2.png"}],"buffers":[{"uri":"a.bin","byteLength":36}],
      "bufferViews":[{"buffer":0,"byteLength":36}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                   {"bufferView":0,"componentType":5126,"count":3,"type":"VEC2"}]})");
  }
  std::shared_ptr<const Transmission> of_gltf(const std::string& material) const {
    write_gltf(material);
    return read(gltf).meshes.at(0).transmission;
  }
};

inline std::vector<float> values(const Scene& scene, std::size_t mesh = 0) {
  const auto& glass = scene.meshes.at(mesh).transmission;
  return glass ? std::vector<float>(glass->values().begin(), glass->values().end()) : std::vector<float>();
}
inline std::vector<float> values(const std::shared_ptr<const Transmission>& glass) {
  return {glass->values().begin(), glass->values().end()};
}

inline std::string thin(const std::string& color, const std::string& more = "") {
  return R"("extensions":{"KHR_materials_transmission":{"transmissionFactor":0.9}},"pbrMetallicRoughness":{"metallicFactor":0,
      "baseColorFactor":)" +
         color + "}" + more;
}

}  // namespace gnomon::glass_folder
