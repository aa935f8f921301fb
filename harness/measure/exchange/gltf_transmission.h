#pragma once
#include <gnomon/transmission.h>

#include <cstdint>
#include <vector>

namespace gnomon {

/// How a material of glTF says what a mesh lets through: by KHR_materials_transmission, with an opaque alpha and no metal. Then
/// t = factor * color, times a texture of bytes: gray ones are of `transmissionTexture`, those of three channels sRGB of
/// `baseColorTexture`.
struct GltfTransmission {
  float factor = 1;
  glm::vec3 color{1};
  int channels = 0;  ///< of the bytes of a texel, 1 or 3; 0: the same everywhere, without a texture
  std::vector<std::uint8_t> bytes;
  double rounding = 0;  ///< the largest difference from the transmission, by rounding to 8 bits
};
GltfTransmission gltf_transmission(const Transmission& transmission);

}  // namespace gnomon
