// Imports a mesh file. A child process reads it, because importers crash on damaged files. This side checks all that the child
// sends, and places (import_vertices.cpp), rounds and triangulates itself.
#include "measure/scene/import.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <numbers>

#include "measure/counted.h"
#include "measure/paths.h"
#include "measure/printable.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/import_masks.h"
#include "measure/scene/import_motion.h"
#include "measure/scene/import_transmission.h"
#include "measure/scene/import_vertices.h"
#include "measure/scene/load.h"
#include "measure/scene/names.h"

namespace gnomon {

namespace fs = std::filesystem;
using namespace importing;

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

std::string name_of(const fs::path& file, const ImportedMesh& raw) {
  return printable(raw.name.empty() ? file.stem().string() : raw.name, true);
}

/// Opens errors.
std::string where_of(const fs::path& file, const ImportedMesh& raw) {
  return fmt::format("{}: mesh '{}'", file.string(), name_of(file, raw));
}

struct Converted {
  Mesh mesh;
  std::vector<std::uint32_t> sources;  ///< as of Welded
};

/// Checks, places, welds and triangulates one mesh. `rig`, null or of the vertices of the file: what moves it.
Converted convert(const fs::path& file, const ImportedMesh& raw, const glm::dmat4& place, const Placement& placement,
                  const Rig* rig, FileMasks& masks, FileTransmissions& transmissions, NoteCounts& counts) {
  Converted converted;
  Mesh& mesh = converted.mesh;
  mesh.name = name_of(file, raw);
  const auto is_share = [](float x) { return x >= 0 && x <= 1; };
  const bool is_albedo = is_share(raw.color.r) && is_share(raw.color.g) && is_share(raw.color.b);
  if (raw.has_color && is_albedo) mesh.albedo = raw.color;
  counts.odd_colors += raw.has_color && !is_albedo;
  const std::string where = where_of(file, raw);
  mesh.alpha_mask = masks.mask(where, raw);
  mesh.transmission = transmissions.transmission(where, raw);
  if (mesh.transmission) mesh.seen = transmissions.are_seen();
  const bool is_noted = raw.mask.has_image() && raw.transmission.is_there();  // by the reader of its format
  counts.masked_glass += mesh.alpha_mask && mesh.transmission && !is_noted;
  const std::string& hint = mesh.alpha_mask ? masks.hint() : transmissions.hint();
  Welded welded = place_vertices(where, raw, place, placement, rig, hint, counts, mesh);
  converted.sources = std::move(welded.sources);

  auto corner = raw.corners.begin();
  std::vector<std::uint32_t> face;
  for (const std::uint32_t count : raw.corner_counts) {
    face.clear();
    for (std::uint32_t k = 0; k < count; ++k) face.push_back(welded.places[*corner++]);
    counts.short_faces += count < 3;
    if (count < 3) continue;
    const std::size_t before = mesh.triangles.size();
    if (!triangulate(mesh.positions, face, mesh.triangles)) ++counts.self_crossing_polygons;
    // Corners that fell together took triangles with them: triangles without area fill the gap, and are dropped and counted
    // with all others.
    mesh.triangles.resize(std::max(mesh.triangles.size(), before + count - 2), glm::uvec3(face[0]));
  }
  if (mesh.alpha_mask || mesh.transmission) masks.drop_duplicates(mesh);
  if (mesh.alpha_mask || (mesh.transmission && !mesh.transmission->is_constant())) return converted;
  const bool is_glass = transmissions.counts(raw);
  if (raw.has_texture && !(is_glass && raw.transmission.has_image())) counts.textured += mesh.triangles.size();
  if (raw.is_transparent && !is_glass) counts.transparent += mesh.triangles.size();
  return converted;
}

/// The nearest name of the form [a-z0-9_]+ that is not taken.
template <class Named>
std::string free_name(std::string name, const std::vector<Named>& taken, std::string_view fallback) {
  name = plain_name(std::move(name), fallback);
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
    return note_item(scene, file, "camera", raw.name, "is at a node without size and is left out");
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

/// Adds all meshes at all of their places, with what moves them. Returns the bounds of those that have triangles. Throws Error,
/// where none has one, too.
Bounds add_meshes(const fs::path& file, MeshFile& raw, const Placement& placement, FileMasks& masks,
                  FileTransmissions& transmissions, NoteCounts& counts, Scene& scene) {
  std::error_code ignored;
  const std::uintmax_t file_bytes = fs::file_size(file, ignored);
  FileMotion motion(file.string(), ignored ? 0 : file_bytes, std::move(raw.motion));
  std::size_t triangle_count = 0;
  Bounds bounds;
  for (ImportedMesh& raw_mesh : raw.meshes) {
    const Rig* const rig = motion.rig_of(where_of(file, raw_mesh), raw_mesh);
    for (std::size_t place = 0; place < raw_mesh.places.size(); ++place) {
      auto [mesh, sources] = convert(file, raw_mesh, raw_mesh.places[place], placement, rig, masks, transmissions, counts);
      triangle_count += mesh.triangles.size();
      if (triangle_count > max_triangle_count) throw Error("{}: more than {} triangles", file.string(), max_triangle_count);
      if (mesh.triangles.empty()) continue;
      bounds.add(mesh.positions);
      if (rig) motion.add(raw_mesh, place, placement, sources, scene.meshes.size());
      scene.meshes.push_back(std::move(mesh));
    }
  }
  if (triangle_count == 0)
    throw Error("{}: has no faces{}", file.string(), raw.notes.empty() ? "" : "; " + joined(raw.notes, "; "));
  motion.finish(scene);
  return bounds;
}

/// Adds the notes of the child, and those of the counts.
void add_notes(const std::string& name, const MeshFile& raw, const NoteCounts& counts, Scene& scene) {
  const auto note = [&](std::size_t count, const char* what) {
    if (count > 0) scene.notes.push_back(fmt::format("{}: {}", name, counted(count, what)));
  };
  for (const std::string& words : raw.notes) scene.notes.push_back(fmt::format("{}: {}", name, printable(words, true)));
  note(counts.short_faces, "{point or line is|points and lines are} left out");
  note(counts.self_crossing_polygons,
       "polygon{s} {crosses itself and is split as a fan|cross themselves and are split as fans}");
  note(counts.odd_colors, "mesh{es} {has|have} a color outside of 0 .. 1, in place of which {it has|they have} the usual one");
  note(counts.textured, "triangle{s} {has|have} textures, which are not used: cut-out leaves and grids are opaque");
  note(counts.transparent, "triangle{s} {is|are} of transparent material and {stops|stop} light all the same");
  note(counts.masked_glass, "mesh{es} {has|have} a mask and a transmission; what is solid transmits");
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
  const Bounds bounds = add_meshes(file, raw, placement, masks, transmissions, counts, scene);
  const std::string name = printable(file.filename().string(), true);
  add_notes(name, raw, counts, scene);
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
