#pragma once
// Private to formats: one reader a format. Each reads the whole file or throws Error, and notes what it left out.
#include "measure/formats/mesh_file.h"

namespace gnomon::importing {

MeshFile read_ply(const std::filesystem::path& file, const ReadFile& read);
MeshFile read_off(const std::filesystem::path& file, const ReadFile& read);
MeshFile read_stl(const std::filesystem::path& file, const ReadFile& read);
MeshFile read_obj(const std::filesystem::path& file, const ReadFile& read);
/// glTF and GLB 2; those of version 1 go to `read_by_assimp`.
MeshFile read_gltf(const std::filesystem::path& file, const ReadFile& read);
/// Any other format.
MeshFile read_by_assimp(const std::filesystem::path& file, const ReadFile& read);

}  // namespace gnomon::importing
