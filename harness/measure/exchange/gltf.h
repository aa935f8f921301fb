#pragma once
#include <gnomon/scene.h>

#include <filesystem>

namespace gnomon {

/// Writes a scene as glTF 2.0, FILE and beside it its numbers as .bin: meshes with their triangles and colors, views as
/// cameras, lights without area by KHR_lights_punctual. An alpha mask is the alpha of a PNG in the .bin, 255 where it is solid,
/// its material's mode MASK with cutoff 0.5, nearest. What a mesh lets through is KHR_materials_transmission, exactly where it
/// is the same everywhere; texels are a PNG, rounded to 8 bits by at most `transmission_rounding` of the mesh's `extras`. What
/// glTF cannot express is in `extras` under the keys of a scene file: of every light and view its exact numbers, of a mesh
/// whether it casts, receives and is seen, its shape, and its albedo where its color is that of the transmission. Throws Error
/// when a file cannot be written, and on a mesh with an alpha mask and a transmission of colored texels.
void write_gltf(const std::filesystem::path& file, const Scene& scene);

}  // namespace gnomon
