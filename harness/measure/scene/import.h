#pragma once
// Private to the importer: what the child reads from a mesh file, how it crosses the pipe, and the helpers of both sides.
#include <gnomon/error.h>
#include <gnomon/scene.h>

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace gnomon::importing {

/// One mesh of one node, just as the file has it: nothing is checked, no face is split.
struct RawMesh {
  std::string name;
  glm::dmat4 world_from_mesh{1};
  bool has_color = false, has_texture = false, is_transparent = false;
  glm::vec3 color{0};  ///< diffuse color of the material, when has_color
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> corner_counts;  ///< one per face
  std::vector<std::uint32_t> corners;        ///< vertex indices of all faces, one after the other
};
/// Perspective camera; fov_y in radians, 0 for an orthographic one.
struct RawCamera {
  std::string name;
  glm::dvec3 eye{0}, forward{0, 0, -1}, up{0, 1, 0};
  double fov_y = 0;
};
enum class RawKind : std::uint32_t { point, spot, directional, other };
/// Half-angles in radians.
struct RawLight {
  std::string name;
  RawKind kind = RawKind::other;
  glm::dvec3 position{0}, direction{0, 0, -1};
  double inner = 0, outer = 0;
};
struct RawFile {
  std::vector<RawMesh> meshes;
  std::vector<RawCamera> cameras;
  std::vector<RawLight> lights;
  std::vector<std::string> complaints;  ///< errors that assimp logged and went on after
  std::string failure;                  ///< why there is nothing else, or empty
};

// The fields of a record in the order in which they cross the pipe: written once, used to send and to receive.
template <class Wire, class Record>
void transfer(Wire& wire, Record& record) {
  using R = std::remove_const_t<Record>;
  if constexpr (std::is_same_v<R, RawMesh>)
    wire(record.name)(record.world_from_mesh)(record.has_color)(record.has_texture)(record.is_transparent)(record.color)(
        record.positions)(record.corner_counts)(record.corners);
  else if constexpr (std::is_same_v<R, RawCamera>)
    wire(record.name)(record.eye)(record.forward)(record.up)(record.fov_y);
  else if constexpr (std::is_same_v<R, RawLight>)
    wire(record.name)(record.kind)(record.position)(record.direction)(record.inner)(record.outer);
  else
    wire(record);
}

/// What a record on the pipe is. `end` comes last: an answer without it broke off.
enum class Tag : std::uint32_t { mesh, camera, light, complaint, failure, end };

/// Takes fields from the child's answer. It believes no count that the rest of the answer cannot hold.
class Receiver {
 public:
  Receiver(std::span<const std::byte> bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}
  template <class T>
  Receiver& operator()(T& value) {
    if constexpr (requires { value.resize(0); }) {
      std::uint64_t count = 0;
      (*this)(count);
      if (count > bytes_.size() / sizeof(value[0])) broken();
      value.resize(count);
      take(value.data(), count * sizeof(value[0]));
    } else {
      static_assert(std::is_trivially_copyable_v<T>);
      take(&value, sizeof(T));
    }
    return *this;
  }

 private:
  [[noreturn]] void broken() const { throw Error("{}: the importer's answer breaks off", file_); }
  void take(void* target, std::size_t size) {
    if (size > bytes_.size()) broken();
    if (size > 0) std::memcpy(target, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }
  std::span<const std::byte> bytes_;
  std::string file_;
};

/// Runs `body` in a forked child and returns all that it wrote to `out_fd`. Throws Error, opening with `what`, when the child
/// crashes, aborts, exceeds its time or memory, or returns anything but 0.
std::vector<std::byte> output_of_fork(const std::string& what, const std::function<int(int out_fd)>& body);
/// The same for another program: `program import-mesh file 3`, where 3 is the descriptor to write to.
std::vector<std::byte> output_of_program(const std::string& what, const std::filesystem::path& program,
                                         const std::filesystem::path& file);

/// ".ply" of "A.PLY".
std::string lower_extension(const std::filesystem::path& file);

/// What the head of a file promises; empty where the format promises nothing.
struct Declared {
  std::optional<std::size_t> vertex_count, face_count;
};
/// Reads the head (PLY, OFF, STL, glTF, GLB, 3DS, IFC) and throws Error when the file is shorter than it says.
Declared read_declared(const std::filesystem::path& file);

/// For a file that the importer refused because of an index out of range, without saying which: throws Error with line, index
/// and what is allowed, where the format is text and the index is found (OBJ, OFF); else does nothing.
void blame_index(const std::filesystem::path& file);

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
