#pragma once
// Private to formats: one reader a format. Each reads the whole file or throws Error, and notes what it left out. And what
// readers of bytes share.
#include "measure/formats/mesh_file.h"

namespace gnomon::importing {

MeshFile read_ply(const std::filesystem::path& file, const ReadFile& read);
MeshFile read_off(const std::filesystem::path& file, const ReadFile& read);
MeshFile read_stl(const std::filesystem::path& file, const ReadFile& read);
MeshFile read_obj(const std::filesystem::path& file, const ReadFile& read, bool with_uv);
/// glTF and GLB 2; those of version 1 go to `read_by_assimp`.
MeshFile read_gltf(const std::filesystem::path& file, const ReadFile& read, bool with_uv);
/// Any other format.
MeshFile read_by_assimp(const std::filesystem::path& file, const ReadFile& read);

/// 32 bits at `offset`, the lowest byte first; what lies beyond the end is 0.
inline std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
  std::uint32_t word = 0;
  for (std::size_t k = 0; k < 4 && offset + k < bytes.size(); ++k)
    word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + k])) << (8 * k);
  return word;
}

/// Adds an image file to those of the answer and returns its number. An image that cannot be read has the reason in `failure`.
std::uint32_t add_image_file(MeshFile& answer, const std::filesystem::path& file, const ReadFile& read, bool is_gray_alpha);
/// Adds an image in place of what is wrong with a mask or a transmission, which is refused where it is used, and returns its
/// number.
std::uint32_t add_broken_image(MeshFile& answer, const std::string& name, const std::string& why);

}  // namespace gnomon::importing
