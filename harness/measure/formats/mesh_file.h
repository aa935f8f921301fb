#pragma once
// The contents of a mesh file, as its reader returns them to the importer: nothing is placed, no face is split.
#include <gnomon/alpha_mask.h>
#include <gnomon/error.h>
#include <gnomon/motion.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measure/formats/motion_fields.h"

namespace gnomon::importing {

/// An image whose alpha says where meshes are solid, or whose alpha or colors say what they let through.
struct MaskImage {
  std::string name;            ///< its file, or the file and the place in it
  std::string bytes;           ///< as the file has them; none is left when it is decoded
  bool is_gray_alpha = false;  ///< whether brightness counts as alpha where there is no alpha channel
  bool wants_colors = false;   ///< whether its colors are decoded, too
  std::int32_t width = 0, height = 0;
  std::vector<std::uint8_t> alpha;   ///< of each texel, the top row first; none: the image has no alpha
  std::vector<std::uint8_t> colors;  ///< red, green, blue of each texel, as the file has them; gray is three times the same
  std::string failure;               ///< why it could not be decoded
};
/// How a material makes a mask of an image; see AlphaMask.
struct ImportedMask {
  static constexpr std::uint32_t no_image = 0xffffffffu;
  std::uint32_t image = no_image;  ///< of MeshFile::mask_images
  float factor = 1, cutoff = 0.5f;
  AlphaMask::Wrap wrap_u = AlphaMask::Wrap::repeat, wrap_v = AlphaMask::Wrap::repeat;
  bool has_image() const { return image != no_image; }
};
/// How a material lets light through. In each channel t = 1 - a + a * transmission * (1 - metallic) * color, in double, with
/// a = alpha. Each number is a factor, multiplied by its image where there is one: by the image's alpha, its colors as sRGB,
/// its red and its blue. All images share the places of the vertices.
struct ImportedTransmission {
  static constexpr std::uint32_t no_image = ImportedMask::no_image;
  double alpha = 1, transmission = 0, metallic = 0;
  glm::dvec3 color{1};
  std::uint32_t alpha_image = no_image, color_image = no_image, transmission_image = no_image,
                metallic_image = no_image;  ///< of MeshFile::mask_images
  AlphaMask::Wrap wrap_u = AlphaMask::Wrap::repeat, wrap_v = AlphaMask::Wrap::repeat;
  auto images() const { return std::array{alpha_image, color_image, transmission_image, metallic_image}; }
  bool has_image() const { return images() != std::array{no_image, no_image, no_image, no_image}; }
  /// Whether it may let light through.
  bool is_there() const { return has_image() || alpha != 1 || transmission != 0; }
};
/// What is used of a material.
struct ImportedMaterial {
  bool has_color = false, has_texture = false, is_transparent = false;
  glm::vec3 color{0};  ///< diffuse, when has_color
  ImportedMask mask;
  ImportedTransmission transmission;
};
/// A mesh with its material, and its places: one for each node that has it.
struct ImportedMesh : ImportedMaterial {
  std::string name;
  std::vector<glm::dmat4> places;  ///< world from mesh
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec2> uv;                 ///< one per position, (0, 0) at the image's top left; none unless requested
  std::vector<std::uint32_t> corner_counts;  ///< one per face
  std::vector<std::uint32_t> corners;        ///< vertex indices of all faces, one after the other

  /// Of a mesh that an animation of the file moves, the node of each place; empty otherwise. `positions` and `places` are those
  /// of the file's own pose all the same.
  std::vector<std::uint32_t> nodes;
  std::uint32_t skin = Rig::no_skin;  ///< of MeshFile::motion
  // As in Rig; `base` is empty where it is `positions`.
  std::vector<glm::dvec3> base, targets;
  std::uint32_t joints_per_vertex = 0;
  std::vector<std::uint32_t> joints;
  std::vector<double> weights;

  void add_face(std::span<const std::uint32_t> face);
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { add_face(std::array{a, b, c}); }
};
/// Perspective camera; fov_y in radians, 0 for an orthographic one.
struct ImportedCamera {
  std::string name;
  glm::dvec3 eye{0}, forward{0, 0, -1}, up{0, 1, 0};
  double fov_y = 0;
};
enum class ImportedLightKind : std::uint32_t { point, spot, directional, other };
/// Half-angles in radians.
struct ImportedLight {
  std::string name;
  ImportedLightKind kind = ImportedLightKind::other;
  glm::dvec3 position{0}, direction{0, 0, -1};
  double inner = 0, outer = 0;
  double intensity = 1;  ///< W/sr, of a directional light W/m2
};
struct MeshFile {
  std::vector<ImportedMesh> meshes;
  std::vector<ImportedCamera> cameras;
  std::vector<ImportedLight> lights;
  std::vector<MaskImage> mask_images;
  Motion motion;                   ///< without rigs, which the importer makes; empty where no animation moves a mesh
  std::vector<std::string> notes;  ///< what the file contains and the scene does not: "3 camera elements are left out"
  std::string failure;             ///< why nothing could be read; empty where something was

  /// counted(COUNT, WHAT) and `more` as it is, unless the count is 0: note(3, "line{s} {is|are} left out").
  void note(std::size_t count, std::string_view what, std::string_view more = "");
};

/// The fields in the order in which they cross the pipe, for FieldWriter and FieldReader alike.
void visit_file(auto& io, auto& file) {
  io.list(file.meshes, [](auto& sub, auto& mesh) {
    sub(mesh.name, mesh.places, mesh.has_color, mesh.has_texture, mesh.is_transparent, mesh.color, mesh.positions,
        mesh.corner_counts, mesh.corners, mesh.mask, mesh.transmission, mesh.uv, mesh.nodes, mesh.skin, mesh.base, mesh.targets,
        mesh.joints_per_vertex, mesh.joints, mesh.weights);
  });
  io.list(file.cameras, [](auto& sub, auto& camera) { sub(camera.name, camera.eye, camera.forward, camera.up, camera.fov_y); });
  io.list(file.lights, [](auto& sub, auto& light) {
    sub(light.name, light.kind, light.position, light.direction, light.inner, light.outer, light.intensity);
  });
  io.list(file.mask_images,
          [](auto& sub, auto& image) { sub(image.name, image.width, image.height, image.alpha, image.colors, image.failure); });
  visit_motion(io, file.motion);
  io.list(file.notes, [](auto& sub, auto& note) { sub(note); });
  io(file.failure);
}

/// The bytes of a file, this one or one that it names. Throws Error where that is not a regular file that can be read.
using ReadFile = std::function<std::string(const std::filesystem::path& file)>;

/// Reads a mesh file with the reader of its format, which follows from its extension. Throws Error: file, line or element,
/// which value, what is allowed. May crash on damaged files of the formats that have no reader of their own (see formats.cpp).
/// Texture coordinates are read for meshes with a mask or a textured transmission, and for all where `with_uv`, of the formats
/// that have them. Images stay encoded.
MeshFile read_mesh_file(const std::filesystem::path& file, const ReadFile& read, bool with_uv = false);
/// Whether files of this name are read.
bool has_mesh_format(const std::filesystem::path& file);

/// Most corners of a face: the time to split it grows with their square.
inline constexpr std::size_t most_corners = 10'000;

/// Throws Error, which opens with `where` ("FILE:LINE"), unless `index` is a whole number of 0 .. vertex_count - 1.
void need_vertex(const std::string& where, std::size_t face, double index, std::size_t vertex_count);
/// Throws Error when a face has more corners than can be split, or fewer than none.
void need_corners(const std::string& where, std::size_t face, double count);

}  // namespace gnomon::importing
