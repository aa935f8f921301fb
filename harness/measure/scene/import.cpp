// Imports a mesh file. A child process reads it, because importers crash on damaged files. This side checks all that the child
// sends, and places, rounds and triangulates itself.
#include "measure/scene/import.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <numbers>

#include "measure/paths.h"
#include "measure/printable.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/import_masks.h"
#include "measure/scene/import_transmission.h"
#include "measure/scene/load.h"
#include "measure/scene/names.h"

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
  check_readable(file, "a mesh file");
  if (!is_mesh_file_name(file))
    throw Error("{}: extension '{}' is unknown; the importer reads obj, ply, stl, off, gltf, glb, 3ds, ifc, dae and others",
                file.string(), file.extension().string());
}

/// Whether this process has threads beside the one that runs.
bool has_other_threads() { return std::distance(fs::directory_iterator("/proc/self/task"), fs::directory_iterator()) > 1; }

/// How far numbers reach, and whether steps between those that float32 keeps can be seen.
struct Reach {
  double farthest = 0;
  glm::dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
  bool is_float = true;  ///< whether all are numbers of float32 already
  void add(const glm::dvec3& p) {
    const glm::dvec3 size = glm::abs(p);
    farthest = std::max({farthest, size.x, size.y, size.z});
    low = glm::min(low, p);
    high = glm::max(high, p);
    is_float = is_float && glm::dvec3(glm::vec3(p)) == p;
  }
  double step() const { return farthest * std::numeric_limits<float>::epsilon() / 2; }
  bool is_coarse() const {
    constexpr double parts = 4096;  // a picture is not much wider
    return step() * parts > std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  }
};

/// Counts for the scene's notes, over all meshes of a file.
struct NoteCounts {
  std::size_t short_faces = 0, self_crossing_polygons = 0;  ///< left out, split as fans
  std::size_t textured = 0, transparent = 0;                ///< triangles
  std::size_t odd_colors = 0;                               ///< meshes
  std::size_t masked_glass = 0;                             ///< meshes, by what a description says of their file
  Reach raw, placed;
};

/// Marks by 1 the vertices that the faces of a mesh use. Throws Error on a face that names a missing vertex or has too many
/// corners.
std::vector<std::uint8_t> used_vertices(const std::string& where, const ImportedMesh& raw) {
  std::vector<std::uint8_t> used(raw.positions.size());
  std::span<const std::uint32_t> corners = raw.corners;
  for (std::size_t f = 0; f < raw.corner_counts.size(); ++f) {
    const std::size_t count = raw.corner_counts[f];
    if (count > most_corners) throw Error("{}, face {}: has {} corners; at most {} are taken", where, f, count, most_corners);
    if (count > corners.size()) throw Error("{}, face {}: {} corners are announced, {} there", where, f, count, corners.size());
    for (const std::uint32_t corner : corners.first(count)) {
      if (corner >= used.size())
        throw Error("{}, face {}: vertex index {} is outside 0 .. {}", where, f, corner, std::int64_t(used.size()) - 1);
      if (count >= 3) used[corner] = 1;
    }
    corners = corners.subspan(count);
  }
  return used;
}

/// Places the vertices that faces use, and welds them: readers may repeat a vertex for every face; one position becomes one
/// vertex again, of a mesh that needs its places in an image where it has one place there. Returns the place in `mesh` of each
/// vertex of the file. `hint` ends errors of places in an image.
std::vector<std::uint32_t> place_vertices(const std::string& where, const ImportedMesh& raw, const glm::dmat4& place,
                                          const Placement& placement, std::string_view hint, NoteCounts& counts, Mesh& mesh) {
  const std::vector<std::uint8_t> used = used_vertices(where, raw);
  std::vector<glm::vec3> positions(raw.positions.size());
  for (std::size_t v = 0; v < raw.positions.size(); ++v) {
    if (!used[v]) continue;
    const glm::dvec3& p = raw.positions[v];
    const glm::dvec3 placed = placement.apply(glm::dvec3(place * glm::dvec4(p, 1)));
    if (!is_sound(p) || !is_sound(placed))
      throw Error("{}, vertex {}: position = ({}, {}, {}), placed at ({}, {}, {}), is outside {}", where, v, p.x, p.y, p.z,
                  placed.x, placed.y, placed.z, coordinate_range);
    positions[v] = placed;
    counts.raw.add(p);
    counts.placed.add(placed);
  }
  std::vector<std::uint32_t> welded = weld(positions, used);
  if (mesh.needs_uv()) {
    check_uv(where, raw, used, mesh.alpha_mask != nullptr, hint);
    welded = weld_places(welded, raw.uv, used);
  }
  for (std::uint32_t v = 0; v < welded.size(); ++v) {
    if (!used[v]) continue;
    const bool is_new = welded[v] == v;
    welded[v] = is_new ? static_cast<std::uint32_t>(mesh.positions.size()) : welded[welded[v]];
    if (is_new) mesh.positions.push_back(positions[v]);
    if (is_new && mesh.needs_uv()) mesh.uv.push_back(raw.uv[v]);
  }
  return welded;
}

/// Checks, places, welds and triangulates one mesh.
Mesh convert(const fs::path& file, const ImportedMesh& raw, const glm::dmat4& place, const Placement& placement,
             FileMasks& masks, FileTransmissions& transmissions, NoteCounts& counts) {
  Mesh mesh;
  mesh.name = printable(raw.name.empty() ? file.stem().string() : raw.name, true);
  const auto is_share = [](float x) { return x >= 0 && x <= 1; };
  const bool is_albedo = is_share(raw.color.r) && is_share(raw.color.g) && is_share(raw.color.b);
  if (raw.has_color && is_albedo) mesh.albedo = raw.color;
  counts.odd_colors += raw.has_color && !is_albedo;
  const std::string where = fmt::format("{}: mesh '{}'", file.string(), mesh.name);
  mesh.alpha_mask = masks.mask(where, raw);
  mesh.transmission = transmissions.transmission(where, raw);
  if (mesh.transmission) mesh.seen = transmissions.are_seen();
  const bool is_noted = raw.mask.has_image() && raw.transmission.is_there();  // by the reader of its format
  counts.masked_glass += mesh.alpha_mask && mesh.transmission && !is_noted;
  const std::string& hint = mesh.alpha_mask ? masks.hint() : transmissions.hint();
  const std::vector<std::uint32_t> welded = place_vertices(where, raw, place, placement, hint, counts, mesh);

  auto corner = raw.corners.begin();
  std::vector<std::uint32_t> face;
  for (const std::uint32_t count : raw.corner_counts) {
    face.clear();
    for (std::uint32_t k = 0; k < count; ++k) face.push_back(welded[*corner++]);
    counts.short_faces += count < 3;
    if (count < 3) continue;
    const std::size_t before = mesh.triangles.size();
    if (!triangulate(mesh.positions, face, mesh.triangles)) ++counts.self_crossing_polygons;
    // Corners that fell together took triangles with them: triangles without area fill the gap, and are dropped and counted
    // with all others.
    mesh.triangles.resize(std::max(mesh.triangles.size(), before + count - 2), glm::uvec3(face[0]));
  }
  if (mesh.alpha_mask || mesh.transmission) masks.drop_duplicates(mesh);
  if (mesh.alpha_mask || (mesh.transmission && !mesh.transmission->is_constant())) return mesh;
  const bool is_glass = transmissions.counts(raw);
  if (raw.has_texture && !(is_glass && raw.transmission.has_image())) counts.textured += mesh.triangles.size();
  if (raw.is_transparent && !is_glass) counts.transparent += mesh.triangles.size();
  return mesh;
}

/// The nearest name of the form [a-z0-9_]+ that is not taken.
template <class Named>
std::string free_name(std::string name, const std::vector<Named>& taken, std::string_view fallback) {
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? static_cast<char>(std::tolower(c)) : '_';
  if (name.find_first_not_of('_') == std::string::npos) name = fallback;
  std::string candidate = name;
  for (int i = 2; find_named(taken, candidate); ++i) candidate = fmt::format("{}_{}", name, i);
  return candidate;
}

/// Unit direction, scaled and rotated but not moved; not finite for a direction of length 0, which is refused later.
glm::dvec3 placed_direction(const Placement& placement, const glm::dvec3& direction) {
  const Placement turn{.scale = placement.scale, .rotate_degrees = placement.rotate_degrees};
  return glm::normalize(usable_direction(turn.apply(direction)));
}

/// Notes what became of a camera or light of the file.
void note_item(Scene& scene, const fs::path& file, std::string_view kind, const std::string& name, std::string_view what) {
  scene.notes.push_back(fmt::format("{}: {} '{}' {}", file.filename().string(), kind, printable(name, true), what));
}

/// A camera without a target looks at the point of its axis that is nearest to the middle of the scene.
void add_camera(const fs::path& file, const ImportedCamera& raw, const Placement& placement, const Bounds& bounds,
                Scene& scene) {
  if (!(raw.fov_y > 0 && raw.fov_y < std::numbers::pi))
    return note_item(scene, file, "camera", raw.name, "is not a perspective one of 0 to 180 degrees and is left out");
  const glm::dvec3 eye = placement.apply(raw.eye);
  const glm::dvec3 forward = placed_direction(placement, raw.forward), up = placed_direction(placement, raw.up);
  if (!is_sound(forward) || !is_sound(up))
    return note_item(scene, file, "camera", raw.name, "stands at a node without size and is left out");
  const glm::dvec3 low(bounds.min), high(bounds.max);
  const double distance = std::max(glm::dot((low + high) / 2.0 - eye, forward), 0.1 * glm::length(high - low));
  scene.views.push_back({.name = free_name(raw.name, scene.views, "view"),
                         .eye = eye,
                         .target = eye + distance * forward,
                         .up = up,
                         .fov_y_degrees = static_cast<float>(glm::degrees(raw.fov_y))});
}

/// A cone of 90 degrees, which files may have, is a half-space; ours end before it.
constexpr float widest_spot = 89.9f;

void add_light(const fs::path& file, const ImportedLight& raw, const Placement& placement, Scene& scene) {
  const glm::vec3 position(placement.apply(raw.position));
  const glm::vec3 direction(placed_direction(placement, raw.direction));
  Light light{free_name(raw.name, scene.lights, "light"), PointLight{position}, static_cast<float>(raw.intensity)};
  if (raw.kind == ImportedLightKind::directional) light.kind = DirectionalLight{direction};
  if (raw.kind == ImportedLightKind::spot)
    light.kind = SpotLight{position, direction, static_cast<float>(glm::degrees(raw.inner)),
                           static_cast<float>(glm::degrees(raw.outer))};
  if (auto* spot = std::get_if<SpotLight>(&light.kind);
      spot && spot->outer_degrees >= widest_spot && spot->outer_degrees <= 90) {
    note_item(scene, file, "light", raw.name,
              fmt::format("is a spot of {:g} degrees and is read as one of {:g}", spot->outer_degrees, widest_spot));
    spot->outer_degrees = widest_spot;
    spot->inner_degrees = std::min(spot->inner_degrees, widest_spot);
  }
  if (raw.kind == ImportedLightKind::other)
    note_item(scene, file, "light", raw.name, "is of no punctual kind and is left out");
  else if (!(light.intensity > 0 && std::isfinite(light.intensity)))
    note_item(scene, file, "light", raw.name,
              fmt::format("has the intensity {:g} and is left out", raw.intensity * lumens_per_watt));
  else
    scene.lights.push_back(light);
}

}  // namespace

bool is_mesh_file_name(const fs::path& file) { return has_mesh_format(file); }

/// The child's answer. While the process has one thread, a plain fork is safe and takes no time. With threads (TBB, GL) a fork
/// may find locks held for ever by threads that it does not have, so the program starts itself anew with its hidden sub-command
/// `import-mesh`. A binary of another name (unit tests, users of the library) has no such sub-command: GNOMON_PROGRAM names the
/// program for it, else it forks all the same.
std::vector<std::byte> importing::answer_of_child(const fs::path& file, bool with_all) {
  const std::string name = file.string();
  if (has_other_threads()) {
    if (const char* program = std::getenv("GNOMON_PROGRAM")) return output_of_program(name, program, file, with_all);
    if (const fs::path self = program_path(); self.filename() == "gnomon") return output_of_program(name, self, file, with_all);
  }
  return output_of_fork(name, [&](int out_fd) { return import_child_main(name, out_fd, with_all); });
}

void import_file(const fs::path& file, const Placement& placement, Scene& scene, const MaskChoice& masks,
                 const TransmissionChoice& transmission) {
  check_file(file);
  const bool needs_all_uv = (masks.are_used && masks.image) || transmission.image;
  add_imported(file, answer_of_child(file, needs_all_uv), placement, scene, masks, transmission);
}

void importing::add_imported(const fs::path& file, std::span<const std::byte> answer, const Placement& placement, Scene& scene,
                             const MaskChoice& mask_choice, const TransmissionChoice& transmission_choice) {
  FieldReader reader(answer, file.string() + ": the importer's answer breaks off");
  MeshFile raw;
  visit_file(reader, raw);
  if (!raw.failure.empty()) throw Error("{}", raw.failure);
  const std::string opening = file.string() + ": ";  // of the errors that follow, too
  for (MaskImage& image : raw.mask_images)
    if (image.failure.starts_with(opening)) image.failure.erase(0, opening.size());

  FileMasks masks(file, raw, mask_choice, scene);
  FileTransmissions transmissions(raw, transmission_choice, scene);
  NoteCounts counts;
  std::size_t triangle_count = 0;
  Bounds bounds;
  for (const ImportedMesh& raw_mesh : raw.meshes)
    for (const glm::dmat4& place : raw_mesh.places) {
      Mesh mesh = convert(file, raw_mesh, place, placement, masks, transmissions, counts);
      triangle_count += mesh.triangles.size();
      if (triangle_count > max_triangle_count) throw Error("{}: more than {} triangles", file.string(), max_triangle_count);
      if (mesh.triangles.empty()) continue;
      bounds.add(mesh.positions);
      scene.meshes.push_back(std::move(mesh));
    }
  if (triangle_count == 0)
    throw Error("{}: has no faces{}", file.string(), raw.notes.empty() ? "" : "; " + joined(raw.notes, "; "));
  const std::string name = printable(file.filename().string(), true);
  const auto note = [&](std::size_t count, const char* what) {
    if (count > 0) scene.notes.push_back(fmt::format("{}: {} {}", name, count, what));
  };
  for (const std::string& words : raw.notes) scene.notes.push_back(fmt::format("{}: {}", name, printable(words, true)));
  note(counts.short_faces, "points and lines are left out");
  note(counts.self_crossing_polygons, "polygons cross themselves and are split as fans");
  note(counts.odd_colors, "meshes have a color outside of 0 .. 1, in place of which they have the usual one");
  note(counts.textured, "triangles have textures, which are not used: cut-out leaves and grids are opaque");
  note(counts.transparent, "triangles are of transparent material and stop light all the same");
  note(counts.masked_glass, "meshes have a mask and a transmission; what is solid of them transmits");
  masks.finish(name, scene);
  transmissions.finish(file.string(), name, scene);
  for (const Reach* reach : {&counts.raw, &counts.placed})
    if (reach->is_coarse() && (reach->is_float || reach == &counts.placed)) {
      scene.notes.push_back(fmt::format("{}: coordinates lie up to {:.3g} from the origin, where float32 keeps steps of {:.2g}",
                                        name, reach->farthest, reach->step()));
      break;
    }

  constexpr std::size_t most = 500;  // names are compared with each other
  if (std::max(raw.cameras.size(), raw.lights.size()) > most)
    throw Error("{}: has {} cameras and {} lights; at most {} are taken", file.string(), raw.cameras.size(), raw.lights.size(),
                most);
  for (const ImportedCamera& camera : raw.cameras) add_camera(file, camera, placement, bounds, scene);
  for (const ImportedLight& light : raw.lights) add_light(file, light, placement, scene);
}

}  // namespace gnomon
