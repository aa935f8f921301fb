#include <gnomon/registry.h>

#include "app/app.h"
#include "measure/scene/load.h"
#include "report/listing.h"
#include "report/table/text_table.h"

namespace gnomon::app {

namespace {

/// "point (point), sun (directional)".
std::string light_names(const Scene& scene) {
  std::string names;
  for (const Light& light : scene.lights)
    names += fmt::format("{}{} ({})", names.empty() ? "" : ", ", light.name, kind_name(light));
  return names;
}

void describe_scene(const std::string& reference) {
  const Scene scene = load_scene(reference);
  fmt::print("{}: {} meshes, {} triangles\n", reference, scene.meshes.size(), scene.triangle_count());
  const Bounds b = scene.bounds();
  fmt::print("bounds  {:g} {:g} {:g} .. {:g} {:g} {:g} m\n", b.min.x, b.min.y, b.min.z, b.max.x, b.max.y, b.max.z);
  fmt::print("lights  {}\n", light_names(scene));
  std::vector<std::string> views;
  for (const View& view : scene.views) views.push_back(view.name);
  fmt::print("views   {}\n", joined(views, ", "));
  for (const std::string& note : scene.notes) fmt::print("note    {}\n", note);
  if (const SceneEntry* entry = registry().find_scene(reference.substr(0, reference.find(':')))) {
    fmt::print("\n{}\n\n{}", entry->about.summary, parameters_text(*entry->make(), terminal_width()));
  }
  fmt::print("\nmesh facts\n");
  TextTable table({{"mesh", ""},
                   {"triangles", "", Align::right},
                   {"shape", ""},
                   {"closed", ""},
                   {"boundary", "edges", Align::right},
                   {"non-manifold", "edges", Align::right},
                   {"misoriented", "edges", Align::right},
                   {"dropped", "triangles", Align::right}});
  constexpr std::size_t shown = 40;
  for (std::size_t k = 0; k < std::min(shown, scene.meshes.size()); ++k) {
    const Mesh& mesh = scene.meshes[k];
    table.add_row({mesh.name, std::to_string(mesh.triangles.size()), mesh.shape ? std::string(kind_name(*mesh.shape)) : "-",
                   mesh.facts.closed() ? "yes" : "no", std::to_string(mesh.facts.boundary_edge_count),
                   std::to_string(mesh.facts.nonmanifold_edge_count), std::to_string(mesh.facts.misoriented_edge_count),
                   std::to_string(mesh.facts.degenerate_count)});
  }
  fmt::print("{}", table.text(terminal_width()));
  if (scene.meshes.size() > shown) fmt::print("and {} more\n", scene.meshes.size() - shown);
}

struct Options {
  std::string id;
  bool json = false;
};

void describe(const Options& options) {
  std::vector<std::string> names;
  for (const TechniqueEntry& entry : registry().techniques()) {
    if (entry.id == options.id) {
      fmt::print("{}", options.json ? json_text(describe_json(entry), 2) + "\n" : describe_text(entry, terminal_width()));
      return;
    }
    names.push_back(entry.id);
  }
  for (const SceneListing& scene : list_scenes()) names.push_back(scene.id);
  const std::string stem = options.id.substr(0, options.id.find(':'));
  const bool is_file = options.id.find_first_of("./") != std::string::npos;
  if (!is_file && std::ranges::find(names, stem) == names.end())
    throw Error("there is no technique or scene {}; did you mean {}? There are: {}", options.id, nearest_word(stem, names),
                joined(names, ", "));
  describe_scene(options.id);
}

}  // namespace

void add_describe(Program& program) {
  auto [command, options] = program.line.command<Options>("describe", "All about one technique or scene", describe);
  command.option("id", &options.id, "Technique id, scene id or scene file").required();
  command.flag("--json", &options.json, "A technique as JSON");
}

}  // namespace gnomon::app
