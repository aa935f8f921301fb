// Imports a mesh file: a child process reads it with assimp, because importers crash on damaged files; this side believes
// nothing it is told, and places, rounds and triangulates itself.
#include "measure/scene/import.h"

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <numbers>

#include "measure/paths.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/load.h"

namespace gnomon {

namespace fs = std::filesystem;
using namespace importing;

glm::dvec3 Placement::apply(const glm::dvec3& p) const {
  glm::dvec3 q = scale * p;
  for (int axis = 0; axis < 3; ++axis) {
    if (rotate_degrees[axis] == 0) continue;
    // Quarter turns are exact: cos(90 degrees) is 0, not 6e-17.
    const double turns = std::remainder(rotate_degrees[axis], 360.0) / 90;
    const double angle = glm::radians(rotate_degrees[axis]);
    const bool quarter = turns == std::round(turns);
    const double c = quarter ? std::round(std::cos(angle)) : std::cos(angle);
    const double s = quarter ? std::round(std::sin(angle)) : std::sin(angle);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double qu = q[u], qv = q[v];
    q[u] = c * qu - s * qv;
    q[v] = s * qu + c * qv;
  }
  return q + translate;
}

namespace {

constexpr std::size_t max_triangle_count = 200'000'000;

void check_file(const fs::path& file) {
  const std::string name = file.string();
  if (!fs::exists(file)) throw Error("{}: does not exist", name);
  if (fs::is_directory(file)) throw Error("{}: is a directory, not a mesh file", name);
  if (!fs::is_regular_file(file)) throw Error("{}: is not a regular file", name);
  if (!std::ifstream(file)) throw Error("{}: cannot be read (permissions)", name);
  if (fs::file_size(file) == 0) throw Error("{}: is empty", name);
  if (!is_mesh_file_name(file))
    throw Error("{}: extension '{}' is unknown; the importer reads obj, ply, stl, off, gltf, glb, 3ds, ifc, dae and others",
                name, file.extension().string());
}

/// Whether this process has threads beside the one that runs.
bool has_other_threads() { return std::distance(fs::directory_iterator("/proc/self/task"), fs::directory_iterator()) > 1; }

/// The child's answer. While the process has one thread, a plain fork is safe and takes no time. With threads (TBB, GL) a fork
/// may find locks held for ever by threads it does not have, so the program starts itself anew with its hidden sub-command
/// `import-mesh`. A binary of another name (unit tests, users of the library) has no such sub-command: GNOMON_PROGRAM names the
/// program for it, else it forks all the same.
std::vector<std::byte> ask_child(const fs::path& file) {
  const std::string name = file.string();
  if (has_other_threads()) {
    if (const char* program = std::getenv("GNOMON_PROGRAM")) return output_of_program(name, program, file);
    if (const fs::path self = program_path(); self.filename() == "gnomon") return output_of_program(name, self, file);
  }
  return output_of_fork(name, [&](int out_fd) { return import_child_main(name, out_fd); });
}

void check_counts(const fs::path& file, const ImportedFile& raw, const DeclaredCounts& declared) {
  std::size_t vertex_count = 0, face_count = 0;
  for (const ImportedMesh& mesh : raw.meshes) {
    vertex_count += mesh.positions.size();
    face_count += mesh.corner_counts.size();
  }
  const auto compare = [&](const char* what, std::optional<std::size_t> promised, std::size_t found) {
    if (promised && *promised != found)
      throw Error("{}: declares {} {} but holds {}; it is truncated or damaged", file.string(), *promised, what, found);
  };
  compare("vertices", declared.vertex_count, vertex_count);
  compare("faces", declared.face_count, face_count);
}

/// What the scene's notes say of a file, counted over its meshes.
struct NoteCounts {
  std::size_t points_and_lines = 0, self_crossing_polygons = 0;  ///< faces: left out, split as fans
  std::size_t textured = 0, transparent = 0;                     ///< triangles
};

/// Checks, places, welds and triangulates one mesh.
Mesh convert(const fs::path& file, const ImportedMesh& raw, const Placement& placement, NoteCounts& counts) {
  Mesh mesh;
  mesh.name = raw.name.empty() ? file.stem().string() : raw.name;
  const std::string where = fmt::format("{}: mesh '{}'", file.string(), mesh.name);
  const auto is_share = [](float x) { return x >= 0 && x <= 1; };
  if (raw.has_color && is_share(raw.color.r) && is_share(raw.color.g) && is_share(raw.color.b)) mesh.albedo = raw.color;

  // Importers repeat a vertex for every face; one position becomes one vertex again.
  std::vector<glm::vec3> positions;
  positions.reserve(raw.positions.size());
  for (const glm::vec3& p : raw.positions) {
    const glm::dvec3 placed = placement.apply(glm::dvec3(raw.world_from_mesh * glm::dvec4(glm::dvec3(p), 1)));
    if (!is_sound(p) || !is_sound(placed))
      throw Error("{}, vertex {}: position = ({}, {}, {}) is outside {}", where, positions.size(), p.x, p.y, p.z,
                  coordinate_range);
    positions.emplace_back(placed);
  }
  std::vector<std::uint32_t> welded = weld(positions);
  for (std::uint32_t v = 0; v < welded.size(); ++v) {
    const bool is_new = welded[v] == v;
    welded[v] = is_new ? static_cast<std::uint32_t>(mesh.positions.size()) : welded[welded[v]];
    if (is_new) mesh.positions.push_back(positions[v]);
  }

  std::span<const std::uint32_t> corners = raw.corners;
  std::vector<std::uint32_t> face;
  for (std::size_t f = 0; f < raw.corner_counts.size(); ++f) {
    const std::size_t count = raw.corner_counts[f];
    if (count > most_corners) throw Error("{}, face {}: has {} corners; at most {} are taken", where, f, count, most_corners);
    if (count > corners.size()) throw Error("{}, face {}: {} corners are announced, {} there", where, f, count, corners.size());
    face.clear();
    for (const std::uint32_t corner : corners.first(count)) {
      if (corner >= welded.size())
        throw Error("{}, face {}: vertex index {} is outside 0 .. {}", where, f, corner, std::int64_t(welded.size()) - 1);
      face.push_back(welded[corner]);
    }
    corners = corners.subspan(count);
    if (count < 3) ++counts.points_and_lines;
    if (!triangulate(mesh.positions, face, mesh.triangles)) ++counts.self_crossing_polygons;
  }
  if (raw.has_texture) counts.textured += mesh.triangles.size();
  if (raw.is_transparent) counts.transparent += mesh.triangles.size();
  return mesh;
}

/// The nearest name of the form [a-z0-9_]+ that is not taken.
template <class Named>
std::string free_name(std::string name, const std::vector<Named>& taken, std::string_view fallback) {
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? static_cast<char>(std::tolower(c)) : '_';
  if (name.find_first_not_of('_') == std::string::npos) name = fallback;
  const auto is_taken = [&](const std::string& candidate) {
    return std::any_of(taken.begin(), taken.end(), [&](const Named& item) { return item.name == candidate; });
  };
  std::string candidate = name;
  for (int i = 2; is_taken(candidate); ++i) candidate = fmt::format("{}_{}", name, i);
  return candidate;
}

/// Unit direction, scaled and rotated but not moved; not finite for a direction of length 0, which is refused later.
glm::dvec3 placed_direction(const Placement& placement, const glm::dvec3& direction) {
  return glm::normalize(placement.apply(direction) - placement.translate);
}

/// A camera without a target looks at the point of its axis that is nearest to the middle of the scene.
void add_camera(const fs::path& file, const ImportedCamera& raw, const Placement& placement, const Bounds& bounds,
                Scene& scene) {
  if (!(raw.fov_y > 0 && raw.fov_y < std::numbers::pi)) {
    scene.notes.push_back(fmt::format("{}: camera '{}' is not a perspective one and is left out", file.string(), raw.name));
    return;
  }
  const glm::dvec3 eye = placement.apply(raw.eye);
  const glm::dvec3 forward = placed_direction(placement, raw.forward), up = placed_direction(placement, raw.up);
  const glm::dvec3 low(bounds.min), high(bounds.max);
  const double distance = std::max(glm::dot((low + high) / 2.0 - eye, forward), 0.1 * glm::length(high - low));
  scene.views.push_back({.name = free_name(raw.name, scene.views, "view"),
                         .eye = eye,
                         .target = eye + distance * forward,
                         .up = up,
                         .fov_y_degrees = static_cast<float>(glm::degrees(raw.fov_y))});
}

void add_light(const fs::path& file, const ImportedLight& raw, const Placement& placement, Scene& scene) {
  const glm::vec3 position(placement.apply(raw.position));
  const glm::vec3 direction(placed_direction(placement, raw.direction));
  Light light{.name = free_name(raw.name, scene.lights, "light"), .kind = PointLight{position}};
  if (raw.kind == ImportedLightKind::directional) light.kind = DirectionalLight{direction};
  if (raw.kind == ImportedLightKind::spot)
    light.kind = SpotLight{.position = position,
                           .direction = direction,
                           .inner_degrees = static_cast<float>(glm::degrees(raw.inner)),
                           .outer_degrees = static_cast<float>(glm::degrees(raw.outer))};
  if (raw.kind == ImportedLightKind::other)
    scene.notes.push_back(fmt::format("{}: light '{}' is of no punctual kind and is left out", file.string(), raw.name));
  else
    scene.lights.push_back(light);
}

}  // namespace

bool is_mesh_file_name(const fs::path& file) {
  return file.has_extension() && Assimp::Importer().IsExtensionSupported(file.extension().string());
}

void import_file(const fs::path& file, const Placement& placement, Scene& scene) {
  check_file(file);
  const DeclaredCounts declared = read_declared(file);
  add_imported(file, ask_child(file), declared, placement, scene);
}

void importing::add_imported(const fs::path& file, std::span<const std::byte> answer, const DeclaredCounts& declared,
                             const Placement& placement, Scene& scene) {
  FieldReader reader(answer, file.string() + ": the importer's answer breaks off");
  ImportedFile raw;
  visit_file(reader, raw);
  if (!raw.failure.empty()) throw Error("{}: cannot be read: {}", file.string(), raw.failure);
  if (!raw.complaints.empty()) throw Error("{}: {}", file.string(), raw.complaints.front());
  check_counts(file, raw, declared);

  NoteCounts counts;
  std::size_t triangle_count = 0;
  Bounds bounds;
  for (const ImportedMesh& raw_mesh : raw.meshes) {
    Mesh mesh = convert(file, raw_mesh, placement, counts);
    triangle_count += mesh.triangles.size();
    if (triangle_count > max_triangle_count) throw Error("{}: more than {} triangles", file.string(), max_triangle_count);
    if (mesh.triangles.empty()) continue;
    for (const glm::vec3& p : mesh.positions) bounds.add(p);
    scene.meshes.push_back(std::move(mesh));
  }
  if (triangle_count == 0) throw Error("{}: has no faces", file.string());
  const auto note = [&](std::size_t count, const char* what) {
    if (count > 0) scene.notes.push_back(fmt::format("{}: {} {}", file.filename().string(), count, what));
  };
  note(counts.points_and_lines, "points and lines are left out");
  note(counts.self_crossing_polygons, "polygons cross themselves and are split as fans");
  note(counts.textured, "triangles have textures, which are not used: cut-out leaves and grids are opaque");
  note(counts.transparent, "triangles are of transparent material and stop light all the same");

  // Only glTF says what its cameras and lights mean; other importers fill these fields by their own conventions.
  if (const std::string extension = lower_extension(file); extension != ".gltf" && extension != ".glb") return;
  constexpr std::size_t most = 500;  // names are compared with each other
  if (std::max(raw.cameras.size(), raw.lights.size()) > most)
    throw Error("{}: has {} cameras and {} lights; at most {} are taken", file.string(), raw.cameras.size(), raw.lights.size(),
                most);
  for (const ImportedCamera& camera : raw.cameras) add_camera(file, camera, placement, bounds, scene);
  for (const ImportedLight& light : raw.lights) add_light(file, light, placement, scene);
}

}  // namespace gnomon
