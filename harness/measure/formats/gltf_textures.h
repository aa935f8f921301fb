#pragma once
// Private to formats: what glTF's materials take from images, which is alpha masks and transmission, and the places of vertices
// in them.
#include <map>
#include <set>

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
  bool operator==(const GltfTextureMap&) const = default;

 private:
  std::size_t set_ = 0;
  glm::dvec2 offset_{0}, scale_{1};
  double rotation_ = 0;  ///< radians
};

/// A material's base color, or its diffuse color by KHR_materials_pbrSpecularGlossiness.
struct GltfColor {
  glm::dvec4 factor{1};
  const Json* texture = nullptr;  ///< textureInfo; null without one
};

class GltfTextures {
 public:
  GltfTextures(const GltfFile& file, const ReadFile& read, MeshFile& answer) : file_(file), read_(read), answer_(answer) {}

  /// Of a material of alphaMode MASK whose color has an image. Without an image where that is missing.
  ImportedMask mask(const Json& material, const std::string& where, const GltfColor& color);
  /// Of any material. `places` is the textureInfo whose coordinates all its images share, null where it has none; where it is
  /// given, as that of a mask, it stays.
  ImportedTransmission transmission(const Json& material, const std::string& where, const GltfColor& color,
                                    const Json*& places);
  /// What was left out.
  void note();

 private:
  enum Use { for_mask, for_transmission };
  struct Sampled {
    std::uint32_t image = ImportedMask::no_image;
    AlphaMask::Wrap wrap_u = AlphaMask::Wrap::repeat, wrap_v = AlphaMask::Wrap::repeat;
  };
  Sampled sampled(const Json& texture, const std::string& where, Use use);
  std::uint32_t image(const Json& texture, const std::string& where, Use use);
  std::uint32_t read_image(std::size_t index, Use use);

  const GltfFile& file_;
  const ReadFile& read_;
  MeshFile& answer_;
  std::map<std::size_t, std::uint32_t> known_;            ///< images of the answer by their number in the file
  std::size_t missing_[2] = {}, without_source_[2] = {};  ///< of each use
  std::string first_missing_[2];                          ///< of each use
  std::set<const Json*> with_volume_, with_mask_, of_metal_, without_alpha_;  ///< materials
  std::set<const Json*> elsewhere_;                                           ///< textures with other places
};

}  // namespace gnomon::importing
