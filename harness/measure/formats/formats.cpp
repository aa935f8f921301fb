// Which reader takes which file, and what the readers share.
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>

#include "measure/counted.h"
#include "measure/formats/readers.h"
#include "measure/formats/text_lines.h"

namespace gnomon::importing {
namespace {

namespace fs = std::filesystem;

/// A reader of a format of which texture coordinates are not read.
template <MeshFile (*read_shape)(const fs::path& file, const ReadFile& read)>
MeshFile without_uv(const fs::path& file, const ReadFile& read, bool) {
  return read_shape(file, read);
}

struct MeshFormat {
  std::string_view extension;
  MeshFile (*read)(const fs::path& file, const ReadFile& read, bool with_uv);
};
constexpr MeshFormat own_formats[] = {{".ply", without_uv<read_ply>}, {".off", without_uv<read_off>},
                                      {".stl", without_uv<read_stl>}, {".obj", read_obj},
                                      {".gltf", read_gltf},           {".glb", read_gltf}};

const MeshFormat* own_format(const fs::path& file) {
  const auto found = std::ranges::find(own_formats, lower(file.extension().string()), &MeshFormat::extension);
  return found == std::end(own_formats) ? nullptr : found;
}

}  // namespace

void ImportedMesh::add_face(std::span<const std::uint32_t> face) {
  corner_counts.push_back(static_cast<std::uint32_t>(face.size()));
  corners.insert(corners.end(), face.begin(), face.end());
}

void MeshFile::note(std::size_t count, std::string_view what, std::string_view more) {
  if (count > 0) notes.push_back(counted(count, what).append(more));
}

MeshFile read_mesh_file(const fs::path& file, const ReadFile& read, bool with_uv) {
  const MeshFormat* format = own_format(file);
  MeshFile answer = format ? format->read(file, read, with_uv) : read_by_assimp(file, read);
  for (ImportedMesh& mesh : answer.meshes)
    if (mesh.places.empty()) mesh.places = {glm::dmat4(1)};  // formats without nodes
  return answer;
}

bool has_mesh_format(const fs::path& file) {
  return own_format(file) || (file.has_extension() && Assimp::Importer().IsExtensionSupported(file.extension().string()));
}

std::uint32_t add_image_file(MeshFile& answer, const fs::path& file, const ReadFile& read, bool is_gray_alpha) {
  const auto number = static_cast<std::uint32_t>(answer.mask_images.size());
  MaskImage& image = answer.mask_images.emplace_back();
  image.name = file.string();
  image.is_gray_alpha = is_gray_alpha;
  std::error_code code;
  if (fs::is_directory(file, code)) {
    image.failure = fmt::format("{} is a directory, not an image", image.name);
    return number;
  }
  try {
    image.bytes = read(file);
  } catch (const Error& error) {
    image.failure = error.what();
  }
  return number;
}

std::uint32_t add_broken_image(MeshFile& answer, const std::string& name, const std::string& why) {
  MaskImage& image = answer.mask_images.emplace_back();
  image.name = name;
  image.failure = why;
  return static_cast<std::uint32_t>(answer.mask_images.size() - 1);
}

void need_vertex(const std::string& where, std::size_t face, double index, std::size_t vertex_count) {
  if (!(index >= 0 && index < static_cast<double>(vertex_count) && index == std::floor(index)))
    throw Error("{}: face {} names vertex {:.16g}, out of range: allowed are 0 .. {}", where, face, index,
                static_cast<std::int64_t>(vertex_count) - 1);
}

void need_corners(const std::string& where, std::size_t face, double count) {
  if (!(count >= 0 && count <= most_corners && count == std::floor(count)))
    throw Error("{}: face {} has {:.16g} corners; a whole number is allowed, at most {}", where, face, count, most_corners);
}

}  // namespace gnomon::importing
