#pragma once
#include <gnomon/scene.h>

#include <filesystem>

namespace gnomon {

/// Writes a scene as glTF 2.0, FILE and beside it its numbers as .bin: meshes with their triangles and colors, views as
/// cameras, lights without area by KHR_lights_punctual. An alpha mask is the alpha of a PNG in the .bin, 255 where it is solid,
/// its material's mode MASK with cutoff 0.5, nearest. What glTF cannot express is in `extras` under the keys of a scene file:
/// of every light and view its exact numbers, of a mesh whether it casts and receives, and its shape. Throws Error when a file
/// cannot be written.
void write_gltf(const std::filesystem::path& file, const Scene& scene);

}  // namespace gnomon
