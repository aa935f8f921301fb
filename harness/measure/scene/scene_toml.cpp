// Reads a described scene. It checks the name of every key and the type and range of every value, and errors name file and
// line.
#include <gnomon/kit/geometry/shapes.h>

#include <numbers>

#include "measure/paths.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/load.h"
#include "measure/scene/parts.h"
#include "measure/scene/time_reference.h"
#include "measure/scene/toml_masks.h"
#include "measure/scene/toml_motion.h"
#include "measure/scene/toml_table.h"

namespace gnomon {

namespace fs = std::filesystem;

// --- what descriptions name: their own files, files of fetched scenes, and the scene that they start from, which may be a
// description, too ---

fs::path described_in(const std::string& scene) {
  return names_file(scene) ? fs::path(scene) : data_root() / "scenes" / (scene + ".toml");
}

fs::path described_file(const std::string& name, const fs::path& description) {
  if (!name.starts_with(cache_prefix)) return description.parent_path() / name;
  const fs::path inside = name.substr(cache_prefix.size());
  const fs::path file = cache_root() / "scenes" / inside;
  const std::string id = inside.empty() ? "" : inside.begin()->string();
  if (!fs::exists(file)) throw SceneNotFetched("scene {0} is not fetched: run {1} {0}", id, fetch_command());
  return file;
}

std::string seen_from_here(const std::string& reference, const fs::path& description) {
  if (!names_file(reference)) return reference;
  const std::string scene = without_time(reference);
  return described_file(scene, description).string() + reference.substr(scene.size());
}

std::vector<std::string> files_named_in(const toml::table& description) {
  std::vector<std::string> names;
  for (const char* const list : {"mesh", "shape"})
    if (const toml::array* items = description[list].as_array())
      for (const toml::node& item : *items)
        if (const toml::table* table = item.as_table())
          for (const char* const key : {"file", "mask", "transmission"})
            if (const auto name = (*table)[key].value_exact<std::string>()) names.push_back(*name);
  return names;
}

namespace {

/// An error whose text names the description that named the scene.
class BaseError : public Error {
  using Error::Error;
};

/// Throws SceneNotFetched. Loading reports every other mistake.
void check_fetched(const std::string& reference, std::size_t depth) {
  if (depth > most_descriptions) return;
  const std::string scene = without_time(reference);
  const fs::path file = described_in(scene);
  if (file.extension() != ".toml") return;
  toml::table document;
  try {
    document = read_toml(file.string(), file);
  } catch (const Error&) {
    return;
  }
  for (const std::string& name : files_named_in(document)) described_file(name, file);
  if (const auto base = document["scene"].value_exact<std::string>()) check_fetched(seen_from_here(*base, file), depth + 1);
}

/// Throws Error when a description is one of those above it, or below too many.
void check_above(const fs::path& description, const Descriptions& above) {
  std::error_code ignored;
  const auto same =
      std::ranges::find_if(above, [&](const fs::path& other) { return fs::equivalent(other, description, ignored); });
  if (same != above.end()) {
    std::string chain;
    for (auto file = same; file != above.end(); ++file) chain += file->string() + " names ";
    throw Error("scene comes back to itself: {}{}", chain, description.string());
  }
  if (above.size() >= most_descriptions)
    throw Error("{}: more than {} descriptions, each of which names the next as its scene", description.string(),
                most_descriptions);
}

/// The scene that a description calls `reference`, neither finished nor framed. Throws Error that ends in `where`, which is
/// "FILE:LINE" of the name, or in the place of a mistake further down; SceneNotFetched passes through.
Scene read_base(const std::string& reference, const fs::path& description, const std::string& where,
                const Descriptions& above) {
  Descriptions chain = above;
  chain.push_back(description);
  try {
    return read_scene(seen_from_here(reference, description), chain);
  } catch (const SceneNotFetched&) {
    throw;
  } catch (const BaseError&) {
    throw;
  } catch (const Error& error) {
    throw BaseError("{} (named in {})", error.what(), where);
  }
}

// --- contents of descriptions ---

/// A kind of shape or light, and the keys that it has beside those of all kinds.
struct Kind {
  std::string name;
  std::vector<std::string_view> keys;
};

/// Read before the other keys: it decides which of them are allowed.
const Kind& kind_of(const toml::table& table, const fs::path& file, const std::string& what, const std::vector<Kind>& kinds) {
  const std::string name = Table(table, file, what).text("kind");
  if (const Kind* kind = find_named(kinds, name)) return *kind;
  const std::vector<std::string> names = names_of(kinds);
  throw Error("{}.kind = '{}' is not one of {}; did you mean {}? ({}:{})", what, name, joined(names, ", "),
              nearest_word(name, names), file.string(), table.get("kind")->source().begin.line);
}

void read_mesh(const toml::table& toml, const fs::path& file, Scene& scene) {
  const Table table(toml, file, "mesh",
                    {"name", "file", "scale", "rotate_degrees", "translate", "casts", "receives", "albedo", "mask", "cutoff",
                     "mask_scale", "masks", "transmission", "seen"});
  const glm::dvec3 zero(0);
  const Placement placement{table.scale("scale"), table.vector("rotate_degrees", zero), table.vector("translate", zero)};
  const bool casts = table.flag("casts", true), receives = table.flag("receives", true);
  const glm::vec3 albedo = table.albedo();
  const fs::path path = described_file(table.file_name("file"), file);
  const DescribedFile file_of = [&](const std::string& name) { return described_file(name, file); };
  const MaskChoice masks = read_masks(table, file_of);
  const TransmissionChoice transmission = read_transmission(table, file_of);
  const std::size_t first = scene.meshes.size();
  try {
    import_file(path, placement, scene, masks, transmission);
  } catch (const Error& error) {
    throw Error("{} (named in {})", error.what(), table.where("file"));
  }
  for (std::size_t i = first; i < scene.meshes.size(); ++i) {
    scene.meshes[i].casts = casts;
    scene.meshes[i].receives = receives;
    if (table.has("albedo")) scene.meshes[i].albedo = albedo;
  }
}

/// The rectangle's frame: u points along +x turned into the plane (along +z where the normal is x), v completes
/// cross(u, v) = normal; then both turn about the normal.
Plane read_plane(const Table& table) {
  const glm::dvec3 normal = glm::normalize(table.direction("normal"));
  const glm::dvec2 size = table.pair("size");
  if (!(size.x > 0 && size.y > 0)) table.refuse("size", fmt::format("[{}, {}]", size.x, size.y), "two numbers above 0");
  const glm::dvec3 x = std::abs(normal.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
  const glm::dvec3 u = glm::normalize(x - glm::dot(x, normal) * normal), v = glm::cross(normal, u);
  const double angle = glm::radians(table.number("rotate_degrees", 0));
  const double c = std::cos(angle), s = std::sin(angle);
  return {table.vector("center"), 0.5 * size.x * (c * u + s * v), 0.5 * size.y * (c * v - s * u)};
}

Shape read_geometry(const std::string& kind, const Table& table) {
  if (kind == "sphere") return Sphere{table.vector("center"), table.positive("radius")};
  if (kind == "cone")
    return Cone{table.vector("base"), table.direction("axis"), table.positive("radius"), table.positive("height")};
  if (kind == "disc") return Disc{table.vector("center"), table.direction("normal"), table.positive("radius")};
  if (kind == "plane") return read_plane(table);
  if (kind == "box") return Box{table.vector("min"), table.vector("max")};
  const std::vector<glm::dvec3> p = table.vectors("points", 3, 3);
  return Triangle{{p[0], p[1], p[2]}};
}

void read_shape(const toml::table& toml, const fs::path& file, Scene& scene) {
  static const std::vector<Kind> kinds = {
      {"sphere", {"center", "radius"}},
      {"cone", {"base", "axis", "radius", "height"}},
      {"disc", {"center", "normal", "radius"}},
      {"triangle", {"points"}},
      {"plane", {"center", "normal", "size", "rotate_degrees", "mask", "cutoff", "mask_scale"}},
      {"box", {"min", "max"}}};
  const auto& [kind, keys] = kind_of(toml, file, "shape", kinds);
  for (const std::string_view key : mask_keys)
    if (kind != "plane" && toml.contains(key))
      throw Error("{}.{} is not allowed: of the shapes, a plane alone may have a mask ({})", kind, key,
                  Table(toml, file, kind).where(key));
  const Table table(toml, file, kind, keys,
                    {"name", "kind", "segments", "casts", "receives", "albedo", "transmission", "seen"});
  const Shape shape = read_geometry(kind, table);
  check(shape, fmt::format("{} ({})", kind, table.where()));
  const std::string name = table.has("name") ? table.text("name") : fmt::format("{}_{}", kind, scene.meshes.size());
  Mesh mesh = tessellate(shape, table.integer("segments", 64, 3, 4096), name);
  mesh.casts = table.flag("casts", true);
  mesh.receives = table.flag("receives", true);
  mesh.albedo = table.albedo();
  const DescribedFile file_of = [&](const std::string& name) { return described_file(name, file); };
  add_mask(table, file_of, scene, mesh);
  add_transmission(table, file_of, scene, mesh);
  scene.meshes.push_back(std::move(mesh));
}

/// The light turned by an angle about the vertical line through a point, counter-clockwise seen from above. In double, rounded
/// once.
Light turned(Light light, const glm::dvec3& about, double radians) {
  const double c = std::cos(radians), s = std::sin(radians);
  const auto turned = [&](const glm::dvec3& v) { return glm::dvec3(c * v.x + s * v.z, v.y, c * v.z - s * v.x); };
  const auto place = [&](const char*, glm::vec3& p) { p = glm::vec3(about + turned(glm::dvec3(p) - about)); };
  const auto axis = [&](const char*, glm::vec3& v) { v = glm::vec3(turned(v)); };
  const auto length = [](const char*, float&) {};
  std::visit([&](auto& kind) { for_each_part(kind, place, axis, axis, length); }, light.kind);
  return light;
}

/// Adds the light, or `copies` of it, named NAME_1 and on, each turned a step farther about the vertical line through `about`.
void add_copies(const Light& light, const Table& table, Scene& scene) {
  if (!table.has("copies")) {
    if (table.has("about")) table.refuse("about", "a point", "beside copies: one light is not turned");
    scene.lights.push_back(light);
    return;
  }
  const int count = table.integer("copies", 1, 2, 1024);
  const glm::dvec3 about = table.vector("about", glm::dvec3(0));
  for (int k = 0; k < count; ++k) {
    Light copy = turned(light, about, 2 * std::numbers::pi * k / count);
    copy.name = fmt::format("{}_{}", light.name, k + 1);
    if (find_named(scene.lights, copy.name))
      table.refuse("name", '\'' + light.name + '\'', "unique with its copies: there is a light " + copy.name);
    check(copy, table.where());
    scene.lights.push_back(std::move(copy));
  }
}

LightKind read_kind(const std::string& kind, const Table& table) {
  if (kind == "point") return PointLight{table.vector("position")};
  if (kind == "directional") return DirectionalLight{table.direction("direction")};
  if (kind == "spot")
    return SpotLight{table.vector("position"), table.direction("direction"),
                     static_cast<float>(table.number("inner_degrees", SpotLight{}.inner_degrees)),
                     static_cast<float>(table.number("outer_degrees", SpotLight{}.outer_degrees))};
  if (kind == "sphere") return SphereLight{table.vector("center"), table.positive("radius")};
  const auto emits = [&] { return table.flag("one_sided", false) ? Emits::in_front : Emits::on_both_sides; };
  if (kind == "disc") return DiscLight{table.vector("center"), table.direction("normal"), table.positive("radius"), emits()};
  return RectLight{table.vector("center"), table.length_and_direction("half_u"), table.length_and_direction("half_v"), emits()};
}

void read_light(const toml::table& toml, const fs::path& file, Scene& scene) {
  static const std::vector<Kind> kinds = {{"point", {"position"}},
                                          {"directional", {"direction"}},
                                          {"spot", {"position", "direction", "inner_degrees", "outer_degrees"}},
                                          {"rect", {"center", "half_u", "half_v", "one_sided"}},
                                          {"disc", {"center", "normal", "radius", "one_sided"}},
                                          {"sphere", {"center", "radius"}}};
  const auto& [kind, keys] = kind_of(toml, file, "light", kinds);
  const Table table(toml, file, kind + " light", keys, {"name", "kind", "intensity", "copies", "about"});
  Light light;
  light.kind = read_kind(kind, table);
  light.name = table.name("name", scene.lights);
  light.intensity = table.has("intensity") ? table.positive("intensity") : light.intensity;
  check(light, table.where());
  add_copies(light, table, scene);
}

void read_view(const toml::table& toml, const fs::path& file, Scene& scene) {
  const Table table(toml, file, "view", {"name", "eye", "target", "up", "fov_y_degrees", "exposure"});
  const View fallback;
  const View view{.name = table.name("name", scene.views),
                  .eye = table.vector("eye"),
                  .target = table.vector("target"),
                  .up = table.has("up") ? table.direction("up") : glm::dvec3(fallback.up),
                  .fov_y_degrees = static_cast<float>(table.number("fov_y_degrees", fallback.fov_y_degrees)),
                  .exposure = table.has("exposure") ? table.positive("exposure") : fallback.exposure};
  check(view, table.where());
  scene.views.push_back(view);
}

/// The file's lights, views and paths replace those of the base; its meshes are added to the base's later.
void start_from(Scene base, Scene& scene) {
  if (!scene.lights.empty()) base.lights = std::move(scene.lights);
  if (!scene.views.empty()) base.views = std::move(scene.views);
  if (!scene.paths.empty()) base.paths = std::move(scene.paths);
  scene = std::move(base);
}

}  // namespace

bool names_file(const std::string& reference) {
  const fs::path scene = without_time(reference);
  return scene.extension() == ".toml" || scene.string().find('/') != std::string::npos || is_mesh_file_name(scene);
}

std::string scene_in_words(const std::string& reference) { return names_file(reference) ? reference : "scene " + reference; }

bool is_fetched(const std::string& reference) {
  try {
    check_fetched(reference, 0);
    return true;
  } catch (const SceneNotFetched&) {
    return false;
  }
}

Scene read_scene_toml(const fs::path& file, const Descriptions& above) {
  check_above(file, above);
  const toml::table document = read_toml(file.string() + ":", file);
  const Table top(document, file, "scene",
                  {"name", "scene", "animation", "time", "ambient", "mesh", "shape", "light", "view", "path"});
  Scene scene;
  const auto read_all = [&](std::string_view key, void (*read)(const toml::table&, const fs::path&, Scene&)) {
    for (const toml::table* table : top.tables(key)) read(*table, file, scene);
  };
  read_all("light", read_light);
  read_all("view", read_view);
  read_all("path", read_path);
  if (top.has("scene")) {
    const std::string base = top.text("scene");
    if (base.empty()) top.refuse("scene", "''", "the id or the file of a scene");
    start_from(read_base(base, file, top.where("scene"), above), scene);
  }
  scene.name = top.has("name") ? top.text("name") : file.stem().string();
  const double ambient = top.number("ambient", scene.ambient);
  if (ambient < 0 || ambient > 1) top.refuse("ambient", ambient, "within 0 .. 1");
  scene.ambient = static_cast<float>(ambient);
  MeshNames names(scene.meshes);
  const auto read_meshes = [&](std::string_view key, void (*read)(const toml::table&, const fs::path&, Scene&)) {
    for (const toml::table* table : top.tables(key)) {
      const std::size_t first = scene.meshes.size();
      read(*table, file, scene);
      if (key == "shape")
        names.add(scene.meshes[first].name, first, first + 1);
      else if (const Table named(*table, file, std::string(key)); named.has("name"))
        names.add(named.text("name"), first, scene.meshes.size());
    }
  };
  read_meshes("shape", read_shape);
  read_meshes("mesh", read_mesh);
  read_mesh_paths(top.tables("path"), file, names, scene);
  read_time(top, !above.empty(), scene);
  return scene;
}

}  // namespace gnomon
