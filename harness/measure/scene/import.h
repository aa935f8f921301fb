#pragma once
// Private to the importer: what the child reads from a mesh file, how it crosses the pipe, and the helpers of both sides.
#include <gnomon/scene.h>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measure/scene/fields.h"
#include "measure/scene/load.h"

namespace gnomon::importing {

// What a file holds, just as it has it: nothing is checked, no face is split.

/// One mesh of one node.
struct ImportedMesh {
  std::string name;
  glm::dmat4 world_from_mesh{1};
  bool has_color = false, has_texture = false, is_transparent = false;
  glm::vec3 color{0};  ///< diffuse color of the material, when has_color
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> corner_counts;  ///< one per face
  std::vector<std::uint32_t> corners;        ///< vertex indices of all faces, one after the other
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
};
struct ImportedFile {
  std::vector<ImportedMesh> meshes;
  std::vector<ImportedCamera> cameras;
  std::vector<ImportedLight> lights;
  std::vector<std::string> complaints;  ///< errors that assimp logged and went on after
  std::string failure;                  ///< why nothing could be read; empty where something was
};

/// The fields in the order in which they cross the pipe, for FieldWriter and FieldReader alike.
void visit_file(auto& io, auto& file) {
  io.list(file.meshes, [](auto& sub, auto& mesh) {
    sub(mesh.name, mesh.world_from_mesh, mesh.has_color, mesh.has_texture, mesh.is_transparent, mesh.color, mesh.positions,
        mesh.corner_counts, mesh.corners);
  });
  io.list(file.cameras, [](auto& sub, auto& camera) { sub(camera.name, camera.eye, camera.forward, camera.up, camera.fov_y); });
  io.list(file.lights, [](auto& sub, auto& light) {
    sub(light.name, light.kind, light.position, light.direction, light.inner, light.outer);
  });
  io.list(file.complaints, [](auto& sub, auto& complaint) { sub(complaint); });
  io(file.failure);
}

// What the child may take, beside what its parent had: processor time, and memory.
inline constexpr unsigned least_import_seconds = 10, import_seconds_per_megabyte = 10;
inline constexpr std::uint64_t least_import_memory = 400 << 20, import_memory_factor = 256;  ///< bytes, for each byte of a file

/// Runs `body` in a forked child and returns all that it wrote to `out_fd`. Throws Error, opening with `what`, when the child
/// crashes, aborts, exceeds its time or memory, or returns anything but 0.
std::vector<std::byte> output_of_fork(const std::string& what, const std::function<int(int out_fd)>& body);
/// The same for another program: `program import-mesh file 3`, where 3 is the descriptor to write to.
std::vector<std::byte> output_of_program(const std::string& what, const std::filesystem::path& program,
                                         const std::filesystem::path& file);

/// ".ply" of "A.PLY".
std::string lower_extension(const std::filesystem::path& file);

/// What the head of a file says that the file holds; empty where the format says nothing.
struct DeclaredCounts {
  std::optional<std::size_t> vertex_count, face_count;
};
/// Reads the head (PLY, OFF, STL, glTF, GLB, 3DS, IFC) and throws Error when the file is shorter than it says, or a face (OBJ,
/// PLY, OFF, 3DS) names a vertex that is not there.
DeclaredCounts read_declared(const std::filesystem::path& file);

/// Checks, places and splits what the child answered, and adds it to the scene. Throws Error.
void add_imported(const std::filesystem::path& file, std::span<const std::byte> answer, const DeclaredCounts& declared,
                  const Placement& placement, Scene& scene);

/// Corners of a face: the time to split it grows with their square.
inline constexpr std::size_t most_corners = 10'000;

/// Appends the triangles of a polygon: a fan where it is convex, ear clipping where it is not. Returns false, and appends a
/// fan, where the polygon is not simple. `corners` index `positions`, in range; fewer than three distinct ones give nothing.
bool triangulate(std::span<const glm::vec3> positions, std::span<const std::uint32_t> corners,
                 std::vector<glm::uvec3>& triangles);

}  // namespace gnomon::importing

namespace gnomon {

/// Body of the program's hidden sub-command `import-mesh FILE FD`: reads the file with assimp, sends what it finds to `out_fd`.
/// Returns the exit status.
int import_child_main(const std::string& file, int out_fd);

}  // namespace gnomon
