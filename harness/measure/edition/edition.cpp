#include "measure/edition/edition.h"

#include <gnomon/registry.h>

#include "measure/edition/edition_text.h"
#include "measure/paths.h"
#include "measure/pattern.h"
#include "measure/run/light_selection.h"
#include "measure/scene/blob.h"
#include "measure/scene/time_reference.h"
#include "measure/scene/toml_table.h"
#include "measure/worker/build.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view ending = ".toml", errata_ending = ".errata.toml";
/// Keys of a suite that an edition states, because their defaults are the program's.
constexpr const char* stated_keys[] = {"title",       "width",   "height",  "truth",           "truth_over",    "processes",
                                       "repetitions", "warmups", "timeout", "reference_error", "reference_rays"};

fs::path editions_folder() { return data_root() / "bench/editions"; }

/// A scene without settings and time: "soup" of "soup:ground=false".
std::string family_of(const std::string& scene) {
  const std::string whole = without_time(scene);
  return whole.substr(0, whole.find(':'));
}

/// Whether a word names one light, or several together one by one.
bool names_lights(const std::string& word) {
  for (std::size_t begin = 0; begin <= word.size();) {
    const std::size_t end = std::min(word.find('+', begin), word.size());
    const std::string part = word.substr(begin, end - begin);
    if (part.empty() || part == "all" || !is_light_name(part)) return false;
    begin = end + 1;
  }
  return true;
}

/// Throws Error where a group leaves open which rows it has.
void require_named(const SuiteGroup& group, std::size_t number, const fs::path& file) {
  const auto refuse = [&](std::string_view what, std::string_view why) {
    throw Error("group {} of an edition names its {}: {} ({})", number, what, why, file.string());
  };
  const auto has_star = [](const std::string& word) { return word.find('*') != word.npos; };
  if (group.lights.empty() || !std::ranges::all_of(group.lights, names_lights))
    refuse("lights", "`lights` is a list of names without *");
  if (group.views.empty() || std::ranges::any_of(group.views, has_star))
    refuse("views", "`views` is a list of names without *");
  if (std::ranges::any_of(group.contenders, &Contender::is_from_wildcard))
    refuse("techniques", "* is every technique there is");
  if (std::ranges::any_of(group.animations, has_star)) refuse("animations", "* is each of the scene");
  if (!group.animations.empty() && !(group.times.frames && group.times.frame_rate && group.times.start))
    refuse("frames", "`frames`, `frame_rate` and `start` are there with `animations`");
}

/// Training scenes, none of them of a family that is scored.
std::vector<std::string> read_training(const Table& table, const Suite& suite) {
  std::set<std::string> scored;
  for (const SuiteGroup& group : suite.groups)
    for (const std::string& scene : group.scenes) scored.insert(family_of(scene));
  std::vector<std::string> training = table.texts("training");
  for (const std::string& scene : training)
    if (scored.contains(family_of(scene))) table.refuse("training", scene, "a scene of which the edition scores nothing");
  return training;
}

/// "0.2.0" as its numbers; nothing where it is no version.
std::optional<std::array<int, 3>> version_numbers(const std::string& text) {
  std::array<int, 3> numbers{};
  std::size_t at = 0;
  for (int& number : numbers) {
    const std::size_t end = std::min(text.find('.', at), text.size());
    const std::string part = text.substr(std::min(at, text.size()), end - std::min(at, text.size()));
    if (part.empty() || part.size() > 6 || part.find_first_not_of("0123456789") != part.npos) return std::nullopt;
    number = std::stoi(part);
    at = end + 1;
  }
  return at == text.size() + 1 ? std::optional(numbers) : std::nullopt;
}

std::vector<Erratum> read_errata(const fs::path& file, const Suite& suite) {
  std::vector<Erratum> errata;
  if (!fs::exists(file)) return errata;
  std::vector<std::string> ids;
  for (const SuiteGroup& group : suite.groups)
    for (const Contender& contender : group.contenders)
      if (std::ranges::find(ids, contender.technique) == ids.end()) ids.push_back(contender.technique);
  const toml::table raw = read_toml("errata " + file.string(), file);
  for (const toml::table* entry : Table(raw, file, "errata", {"erratum"}).tables("erratum")) {
    const Table table(*entry, file, "erratum", {"technique", "version", "reason", "rows"});
    Erratum& erratum = errata.emplace_back(Erratum{table.text("technique"), table.text("version"), table.text("reason"),
                                                   table.has("rows") ? table.text("rows") : ""});
    if (std::ranges::find(ids, erratum.technique) == ids.end())
      table.refuse("technique", erratum.technique, fmt::format("a technique of the edition: {}", joined(ids, ", ")));
    if (!version_numbers(erratum.version)) table.refuse("version", erratum.version, "a version of the program, such as 0.2.0");
    if (erratum.reason.empty()) table.refuse("reason", "''", "a sentence");
    try {
      if (!erratum.rows.empty()) Pattern(erratum.rows, "");
    } catch (const Error&) {
      table.refuse("rows", erratum.rows, "a regular expression");
    }
  }
  return errata;
}

Json json_of(const toml::node& node) {
  if (const auto whole = node.value_exact<std::int64_t>()) return *whole;
  if (const auto number = node.value_exact<double>()) return *number;
  if (const auto text = node.value_exact<std::string>()) return *text;
  return nullptr;
}

const toml::table& table_of(const toml::table& top, std::string_view key, const fs::path& file) {
  const toml::node* const node = top.get(key);
  if (!node || !node->is_table())
    throw Error("edition {} has no table [{}]: `gnomon edition {} --freeze` writes it", file.string(), key,
                file.stem().string());
  return *node->as_table();
}

void read_frozen_part(Edition& edition, const toml::table& top, const fs::path& file) {
  const toml::table& own = table_of(top, "edition", file);
  const Table table(own, file, "edition");
  if (!table.has("hash"))
    throw Error("edition {} is not frozen: `gnomon edition {} --freeze` writes what it has today", file.string(), edition.name);
  edition.hash = table.text("hash");
  if (const std::string hash = edition_hash(edition.suite.text); hash != edition.hash)
    throw Error("edition {} is not as it was frozen: its hash is {}, and the file says {} ({}). An edition stays as it is",
                edition.name, hash, edition.hash, table.where("hash"));
  edition.frames = table.integer("frames", 0, 1, 1'000'000);
  const toml::table& scenes = table_of(top, "scenes", file);
  for (const auto& [key, node] : scenes) edition.scenes.emplace(key.str(), Table(scenes, file, "scenes").text(key.str()));
  const toml::table& metrics = table_of(top, "metrics", file);
  for (const auto& [key, node] : metrics)
    edition.metrics.emplace(key.str(), Table(metrics, file, "metrics").integer(key.str(), 0, 1, 1'000'000));
  for (const auto& [id, node] : table_of(top, "techniques", file)) {
    Json& parameters = edition.techniques[std::string(id.str())] = json_object();
    const toml::table& rows = table_of(table_of(top, "techniques", file), id.str(), file);
    for (const auto& [key, value] : rows) {
      parameters[std::string(key.str())] = json_of(value);
      if (parameters[std::string(key.str())].is_null())
        Table(rows, file, fmt::format("techniques.{}", id.str())).refuse(key.str(), "a list or a date", "a number or a text");
    }
  }
}

}  // namespace

Division parse_division(const std::string& text) {
  const auto found = std::ranges::find(division_names, text);
  if (found == std::end(division_names))
    throw Error("division {} is not one of {}", text,
                joined(std::vector<std::string>(std::begin(division_names), std::end(division_names)), ", "));
  return static_cast<Division>(found - std::begin(division_names));
}

std::vector<std::string> edition_names() {
  std::vector<std::string> names;
  const fs::path folder = editions_folder();
  if (!fs::is_directory(folder)) return names;
  for (const auto& entry : fs::directory_iterator(folder))
    if (const std::string file = entry.path().filename(); file.ends_with(ending) && !file.ends_with(errata_ending))
      names.push_back(file.substr(0, file.size() - ending.size()));
  std::ranges::sort(names);
  return names;
}

std::string edition_suite_name(const std::string& name) { return "edition_" + name; }

fs::path edition_file(const std::string& name) {
  const std::vector<std::string> names = edition_names();
  if (names.empty()) throw Error("there is no edition {}: {} holds none", name, editions_folder().string());
  if (std::ranges::find(names, name) == names.end())
    throw Error("there is no edition {}; did you mean {}? There are: {}", name, nearest_word(name, names), joined(names, ", "));
  return editions_folder() / (name + std::string(ending));
}

Edition read_edition(const std::string& name) { return read_edition_file(edition_file(name)); }

Edition read_hand_written_part(const fs::path& file) {
  Edition edition;
  edition.name = file.stem();
  edition.suite = read_suite(file);
  edition.title = edition.suite.title;
  edition.suite.name = edition_suite_name(edition.name);
  const toml::table top = read_toml("edition " + file.string(), file);
  const Table suite(top, file, "edition");
  for (const char* key : stated_keys)
    if (!suite.has(key)) throw Error("edition {} does not state `{}`, whose default may change", file.string(), key);
  if (suite.has("interval")) suite.refuse("interval", edition.suite.interval, "for an edition: each row has as many processes");
  for (std::size_t k = 0; k < edition.suite.groups.size(); ++k) require_named(edition.suite.groups[k], k + 1, file);
  const toml::table& own = table_of(top, "edition", file);
  edition.training = read_training(Table(own, file, "edition", {"training", "hash", "frames"}), edition.suite);
  edition.errata = read_errata(file.parent_path() / (edition.name + std::string(errata_ending)), edition.suite);
  return edition;
}

Edition read_edition_file(const fs::path& file) {
  Edition edition = read_hand_written_part(file);
  read_frozen_part(edition, read_toml("edition " + file.string(), file), file);
  return edition;
}

Suite with_contenders(const Edition& edition, const std::vector<Contender>& contenders) {
  Suite suite = edition.suite;
  for (SuiteGroup& group : suite.groups) {
    group.contenders = contenders;
    for (Contender& contender : group.contenders) contender.is_from_wildcard = true;
  }
  return suite;
}

void require_division(const Edition& edition, Division division, const std::vector<Contender>& contenders) {
  if (division != Division::default_settings) return;
  for (const Contender& contender : contenders)
    if (!contender.settings.empty() && !edition.techniques.contains(contender.name()))
      throw Error(
          "{} has settings, and division default has techniques as they are: name --division tuned (settings found on training "
          "scenes alone) or open",
          contender.name());
}

bool applies(const Erratum& erratum) {
  const auto since = version_numbers(erratum.version), now = version_numbers(plain_text(build_context()["version"]));
  return since && now && *since <= *now;
}

}  // namespace gnomon
