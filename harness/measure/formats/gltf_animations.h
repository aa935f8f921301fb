#pragma once
// Private to formats: the animations of glTF as they are in the file.
#include "measure/formats/gltf_file.h"

namespace gnomon::importing {

struct GltfAnimations {
  struct Item {
    Animation animation;             ///< its name as it is; nodes are those of the file
    std::size_t without_target = 0;  ///< channels of weights of nodes without morph targets, which are left out
  };
  std::vector<Item> items;
  std::size_t without_node = 0, pointers = 0;  ///< channels that are left out
};

/// Throws Error: the file, the animation, the channel, the key, which value, what is allowed.
GltfAnimations read_animations(const GltfFile& file);

}  // namespace gnomon::importing
