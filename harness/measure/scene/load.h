#pragma once
#include <gnomon/error.h>
#include <gnomon/scene.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "measure/scene/names.h"

namespace gnomon {

/// The scene exists but its files are not fetched yet: its rows say so, and the run goes on.
class SceneNotFetched : public Error {
  using Error::Error;
};

/// Loads what `--scene` names: the id of a generated scene with optional settings (`sphere_field:count=1000`), the id of a
/// described scene (stem of a file in scenes/*.toml), or the path of a .toml or mesh file; each also at a time, as a still
/// (time_reference.h). Lights and views are there afterwards: the scene's own, else the framing default, stated in `notes`.
/// Throws Error on bad input, SceneNotFetched.
Scene load_scene(const std::string& reference);

/// The light or view of that name, else the first.
template <class Item>
const Item& named_or_first(const std::vector<Item>& items, const std::string& name) {
  const Item* found = find_named(items, name);
  return found ? *found : items.front();
}

/// Whether a reference names a file, of a description, of meshes, or anything with a slash in it; else it is an id. Its time
/// does not count.
bool names_file(const std::string& reference);
/// A scene as messages name it: "scene fence", and a file by its path alone, "scenes/fence.toml".
std::string scene_in_words(const std::string& reference);

/// One scene as `gnomon list scenes` shows it.
struct SceneListing {
  std::string id, title, summary;
  bool generated = false;
  bool available = true;  ///< false: described, but its files are not fetched
};
std::vector<SceneListing> list_scenes();

/// Imports a mesh file in a child process, untrusted: see import.cpp. Positions are as in the file, rounded to float32 by
/// `placement` only. Throws Error with file, mesh and vertex or face index.
/// What a description says of the masks of a mesh file; without a description all is as the file says.
struct MaskChoice {
  bool are_used = true;                        ///< false: all meshes are solid
  std::optional<std::filesystem::path> image;  ///< in place of the file's own masks, of all its meshes
  std::optional<double> cutoff;                ///< in place of the file's own
  int scale = 1;                               ///< see AlphaMask
  std::string hint;                            ///< ends errors: what the description may say in place of the mask
};
/// What a description says of the light that the meshes of a file let through.
struct TransmissionChoice {
  bool is_used = true;                         ///< false: all meshes are opaque
  std::optional<glm::vec3> everywhere;         ///< in place of the file's own, of all its meshes
  std::optional<std::filesystem::path> image;  ///< the same, of an image
  std::optional<bool> seen;                    ///< whether the eye sees the meshes that let light through; not unless given
  std::string hint;                            ///< ends errors: what the description may say in place of the transmission
};
/// Appends the file's meshes (and its cameras and punctual lights, for glTF) to the scene.
void import_file(const std::filesystem::path& file, const Placement& placement, Scene& scene, const MaskChoice& masks = {},
                 const TransmissionChoice& transmission = {});
/// The mask of an image file: its alpha, or the brightness of an image without alpha. The scene's own where it has an equal
/// one. A child process reads the file. Throws Error.
std::shared_ptr<const AlphaMask> read_alpha_mask(const std::filesystem::path& file, double cutoff, int scale,
                                                 const Scene& scene);
/// What an image file lets through: gray, or red, green, blue, its bytes / 255, repeated. The scene's own where it has an equal
/// one. A child process reads the file. Throws Error.
std::shared_ptr<const Transmission> read_transmission_image(const std::filesystem::path& file, const Scene& scene);

/// Whether the importer reads files of this name: what makes `--scene NAME` a mesh file.
bool is_mesh_file_name(const std::filesystem::path& file);

/// A light and a view that show the whole scene, for scenes that bring none; adds a note for each.
void add_framing(Scene& scene);

/// Whether a name is of [a-z0-9_] and not empty, as names of lights and views are.
bool is_plain_name(std::string_view name);
/// Throw Error, ending in `where`, on a light without direction or area, a cone outside 0 .. 90 degrees, an eye that equals its
/// target, an `up` along the line of sight, anything that is not finite.
void check(const Light& light, const std::string& where);
void check(const View& view, const std::string& where);

/// The same with directions, normals and `up` at a length that techniques can use: usable_direction of base_scene.h. The
/// numbers of a description are converted before they are rounded to float32.
Light usable(Light light);
View usable(View view);

/// What every loader ends with: drops degenerate triangles, measures facts, checks that coordinates are finite, that names
/// are unique, that no eye equals its target, that motion is sound; throws Error when nothing is left to see. `where` opens the
/// error's text.
void finish_scene(Scene& scene, const std::string& where);

}  // namespace gnomon
