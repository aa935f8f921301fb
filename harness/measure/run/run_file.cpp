#include "measure/run/run_file.h"

#include "measure/part_file.h"
#include "measure/scene/channels.h"
#include "measure/scene/load.h"
#include "measure/scene/scene_json.h"
#include "measure/scene/time_reference.h"
#include "measure/worker/build.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

constexpr const char* schema = "gnomon-run-1";

fs::path run_file(const fs::path& folder) { return folder / "run.json"; }

void write_runs(const fs::path& folder, Json runs) {
  write_file(run_file(folder), json_text(json_object({{"schema", schema}, {"runs", std::move(runs)}}), 1) + "\n", Durable::yes);
}

Json described(const std::string& reference, const Scene* scene) {
  Json json = json_object({{"scene", reference}, {"text", nullptr}, {"lights", Json::array()}, {"views", Json::array()}});
  const std::string file = without_time(reference);
  if (names_file(file) && fs::path(file).extension() == ".toml" && is_plain_file(file)) json["text"] = file_text(file);
  if (!scene) return json;
  for (const Light& light : whole_lights(scene->lights)) json["lights"].push_back(scene_json(light));
  for (const View& view : scene->views) json["views"].push_back(scene_json(view));
  return json;
}

}  // namespace

Json run_entries(const fs::path& folder) {
  const fs::path file = run_file(folder);
  if (!fs::exists(fs::symlink_status(file))) return Json::array();
  if (!is_plain_file(file)) throw Error("{} cannot be read: it is not a file", file.string());
  const Json json = parse_if_json(file_text(file));
  if (!json.is_object() || json.value("schema", Json()) != schema || !json.value("runs", Json()).is_array())
    throw Error("{} does not say how the folder was run ({}): move it away", file.string(), schema);
  return json["runs"];
}

void add_to_run_file(const RunOptions& options, const Json& context, SceneLibrary& library, std::span<const Job> jobs) {
  Json runs = run_entries(options.out);
  Json run = json_object({{"command", options.command},
                          {"suite", json_object({{"name", options.suite.name},
                                                 {"text", options.suite.text.empty() ? Json() : Json(options.suite.text)}})},
                          {"scenes", Json::array()},
                          {"context", context},
                          {"changes", nullptr}});
  if (const std::optional<RunEdition>& edition = options.edition)
    run["edition"] = json_object({{"name", edition->name}, {"hash", edition->hash}, {"division", edition->division}});
  const Json own = build_context();  // another program's changes are not known
  if (context.value("build", Json()) == own["build"] && context.value("commit", Json()) == own["commit"])
    run["changes"] = tree_changes();
  std::set<std::string> known;
  for (const Job& job : jobs) {
    if (!known.insert(job.scene).second) continue;
    const SceneLibrary::Entry& entry = library.get(job.scene);
    run["scenes"].push_back(described(job.scene, entry.scene ? &*entry.scene : nullptr));
  }
  runs.push_back(std::move(run));
  write_runs(options.out, std::move(runs));
}

std::optional<RunEdition> edition_of(const Json& entry, const fs::path& folder) {
  const auto found = entry.is_object() ? entry.find("edition") : entry.end();
  if (found == entry.end()) return std::nullopt;
  const auto word = [&](const char* key) {
    const auto value = found->is_object() ? found->find(key) : found->end();
    if (!found->is_object() || value == found->end() || !value->is_string())
      throw Error("{} names an edition without a text `{}`", run_file(folder).string(), key);
    return value->get<std::string>();
  };
  return RunEdition{word("name"), word("hash"), word("division")};
}

namespace {

std::string in_words(const std::optional<RunEdition>& edition) {
  return edition ? fmt::format("edition {} ({}), division {}", edition->name, edition->hash, edition->division) : "no edition";
}

/// The editions of a folder's runs, each once; none where it has no run.json.
std::vector<std::optional<RunEdition>> editions_in(const fs::path& folder) {
  std::vector<std::optional<RunEdition>> editions;
  for (const Json& entry : run_entries(folder))
    if (auto edition = edition_of(entry, folder); std::ranges::find(editions, edition) == editions.end())
      editions.push_back(std::move(edition));
  return editions;
}

}  // namespace

void require_edition_of_folder(const fs::path& folder, const std::optional<RunEdition>& edition) {
  for (const auto& there : editions_in(folder))
    if (there != edition)
      throw Error("{} holds rows of {}, and this run is of {}: name another --out", folder.string(), in_words(there),
                  in_words(edition));
}

void require_one_edition(std::span<const fs::path> folders) {
  const fs::path* first = nullptr;
  std::optional<RunEdition> edition;
  for (const fs::path& folder : folders) {
    std::vector<std::optional<RunEdition>> there = editions_in(folder);
    if (there.empty()) there.emplace_back();
    if (!first) edition = there.front();
    if (!first) first = &folder;
    for (const auto& other : there)
      if (other != edition)
        throw Error("{} holds rows of {}, and {} of {}: rows of different editions or divisions are not merged",
                    first->string(), in_words(edition), folder.string(), in_words(other));
  }
}

void join_run_files(std::span<const fs::path> folders, const fs::path& out) {
  Json runs = Json::array();
  for (const fs::path& folder : folders)
    for (Json& run : run_entries(folder)) runs.push_back(std::move(run));
  if (!runs.empty()) write_runs(out, std::move(runs));
}

}  // namespace gnomon
