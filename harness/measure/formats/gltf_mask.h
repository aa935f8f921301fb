#pragma once
// Private to formats: the alpha masks of glTF's materials, and the places of vertices in them.
#include <map>

#include "measure/formats/gltf_file.h"

namespace gnomon::importing {

/// Texture coordinates of a textureInfo: which of a primitive's sets it takes, and how KHR_texture_transform changes them.
class GltfTextureMap {
 public:
  /// Without a textureInfo, the first set as it is.
  GltfTextureMap(const GltfFile& file, const std::string& where, const Json* texture);

  /// "TEXCOORD_0".
  std::string attribute() const { return fmt::format("TEXCOORD_{}", set_); }
  /// The numbers of that attribute, transformed in double and rounded once.
  std::vector<glm::vec2> uv(const Numbers& numbers) const;

 private:
  std::size_t set_ = 0;
  glm::dvec2 offset_{0}, scale_{1};
  double rotation_ = 0;  ///< radians
};

class GltfMasks {
 public:
  GltfMasks(const GltfFile& file, const ReadFile& read, MeshFile& answer) : file_(file), read_(read), answer_(answer) {}

  /// Of a material of alphaMode MASK whose color has the image of a textureInfo. Without an image where that is missing.
  ImportedMask mask(const Json& material, const std::string& where, const Json& texture, double factor);
  /// In place of one that cannot be read: it is refused where it is used.
  ImportedMask broken(const std::string& where, const std::string& why);
  /// What was left out.
  void note();

 private:
  std::uint32_t image(const Json& texture, const std::string& where);
  std::uint32_t read_image(std::size_t index);

  const GltfFile& file_;
  const ReadFile& read_;
  MeshFile& answer_;
  std::map<std::size_t, std::uint32_t> known_;  ///< images of the answer by their number in the file
  std::size_t missing_ = 0, without_source_ = 0;
  std::string first_missing_;
};

}  // namespace gnomon::importing
