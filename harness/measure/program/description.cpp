#include "measure/program/description.h"

#include <unistd.h>

#include <cstdlib>
#include <mutex>
#include <set>
#include <sstream>

#include "measure/paths.h"
#include "measure/printable.h"
#include "measure/program/program_process.h"
#include "measure/scene/toml_table.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// Texts of a list that must each be one of the `known` words; `fallback` without the key.
std::vector<std::string> words_of(const toml::table& toml, const Table& table, std::string_view key,
                                  const std::vector<std::string>& known, std::vector<std::string> fallback) {
  const toml::node* const node = toml.get(key);
  if (!node) return fallback;
  const toml::array* const array = node->as_array();
  if (!array) table.refuse(key, "no list", "a list of " + joined(known, ", "));
  std::vector<std::string> words;
  for (const toml::node& item : *array) {
    const auto word = item.value_exact<std::string>();
    if (!word || std::ranges::find(known, *word) == known.end())
      table.refuse(key, word ? '\'' + *word + '\'' : "something else than text", "a list of " + joined(known, ", "));
    if (std::ranges::find(words, *word) == words.end()) words.push_back(*word);
  }
  return words;
}

/// Null where the key is missing or no array.
const toml::array* array_of(const toml::table& toml, std::string_view key) {
  return toml.get(key) ? toml.get(key)->as_array() : nullptr;
}

std::vector<std::string> command_of(const toml::table& toml, const Table& table, std::string_view key) {
  const toml::array* const array = array_of(toml, key);
  std::vector<std::string> words;
  for (std::size_t k = 0; array && k < array->size(); ++k) {
    const auto word = (*array)[k].value_exact<std::string>();
    if (!word) table.refuse(key, fmt::format("a list whose word {} is no text", k + 1), "a list of texts");
    words.push_back(*word);
  }
  if (words.empty() || words[0].empty())
    table.refuse(key, toml.get(key) ? "no list of texts" : "missing",
                 R"(a list of texts, the program first: ["python3", "a.py"])");
  return words;
}

bool holds(const std::vector<std::string>& words, std::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

std::vector<std::string> names_of_features() {
  std::vector<std::string> names;
  for (const Feature feature : all_features()) names.emplace_back(name(feature));
  return names;
}

Stage stage_of(const Table& table) {
  const std::string word = table.text("stage");
  for (const Stage stage : spoilable_stages)
    if (word == name(stage)) return stage;
  table.refuse("stage", '\'' + word + '\'', "one of " + spoilable_stage_names());
}

/// By stage whether the program does it: all but update, unless the description lists them.
std::array<bool, std::size(stage_names)> stages_of(const toml::table& toml, const Table& table) {
  std::vector<std::string> all, usual;
  for (const Stage stage : all_stages) {
    all.emplace_back(name(stage));
    if (stage != Stage::update) usual.emplace_back(name(stage));
  }
  const std::vector<std::string> stages = words_of(toml, table, "stages", all, usual);
  if (!holds(stages, name(Stage::resolve))) table.refuse("stages", "this", "a list with resolve, which makes the mask");
  if (holds(stages, name(Stage::update)) && !holds(stages, name(Stage::build)))
    table.refuse("stages", "this", "a list with build beside update, which takes its place where geometry moved");
  std::array<bool, std::size(stage_names)> has{};
  for (const Stage stage : all_stages) has[static_cast<std::size_t>(stage)] = holds(stages, name(stage));
  return has;
}

float update_error_of(const Table& table) {
  const double error = table.number("update_error", 0);
  if (!(error >= 0 && error <= 1)) table.refuse("update_error", error, "within 0 .. 1");
  return static_cast<float>(error);
}

DescribedParameter parameter_of(const toml::table& toml, const fs::path& file, const std::vector<DescribedParameter>& others) {
  const Table table(toml, file, "parameter", {"name", "value", "min", "max", "choices", "unit", "log", "stage", "sentence"});
  DescribedParameter row;
  row.name = table.name("name", others, "");
  row.sentence = table.text("sentence");
  row.stage = stage_of(table);
  row.unit = table.has("unit") ? table.text("unit") : "";
  const toml::node* const value = toml.get("value");
  const auto range_of = [&](auto whole) {
    using Number = decltype(whole);
    Range<Number> range{.unit = {},
                        .min = static_cast<Number>(table.number("min")),
                        .max = static_cast<Number>(table.number("max")),
                        .log = table.flag("log", false)};
    if (!(range.min <= range.max)) table.refuse("min", range.min, fmt::format("at most max = {}", range.max));
    const auto number = static_cast<Number>(table.number("value"));
    if (!(number >= range.min && number <= range.max))
      table.refuse("value", number, fmt::format("within {} .. {}", range.min, range.max));
    return std::pair(number, range);
  };
  const auto refuse_keys = [&](std::initializer_list<std::string_view> keys, std::string_view kind) {
    for (const std::string_view key : keys)
      if (table.has(key)) table.refuse(key, "given", fmt::format("a key of a {}", kind));
  };
  if (value && value->is_boolean()) {
    refuse_keys({"min", "max", "log", "choices", "unit"}, "true or false value");
    row.kind = *value->value_exact<bool>();
  } else if (value && value->is_string()) {
    refuse_keys({"min", "max", "log", "unit"}, "word");
    DescribedParameter::Word word{table.text("value"), {}};
    if (const toml::array* const choices = array_of(toml, "choices"))
      for (const toml::node& choice : *choices) word.choices.push_back(choice.value_exact<std::string>().value_or(""));
    if (!holds(word.choices, word.value) || holds(word.choices, ""))
      table.refuse("choices", "this", fmt::format("a list of words with '{}' among them", word.value));
    row.kind = word;
  } else if (value && value->is_integer()) {
    refuse_keys({"choices"}, "word");
    for (const std::string_view key : {"value", "min", "max"}) table.integer(key, 0, -1'000'000'000, 1'000'000'000);
    const auto [number, range] = range_of(int());
    row.kind = DescribedParameter::Whole{number, range};
  } else {
    refuse_keys({"choices"}, "word");
    const auto [number, range] = range_of(double());
    row.kind = DescribedParameter::Real{number, range};
  }
  return row;
}

ProgramCause cause_of(const toml::table& toml, const fs::path& file) {
  const Table table(toml, file, "cause", {"id", "sentence", "color"});
  ProgramCause cause{table.text("id"), table.text("sentence")};
  const toml::array* const color = array_of(toml, "color");
  bool is_color = color && color->size() == cause.color.size();
  for (std::size_t c = 0; is_color && c < cause.color.size(); ++c) {
    const std::int64_t level = (*color)[c].value_exact<std::int64_t>().value_or(-1);
    is_color = level >= 0 && level <= 255;
    cause.color[c] = static_cast<std::uint8_t>(level);
  }
  if (!is_color) table.refuse("color", "this", "a list of three whole numbers, 0 .. 255: red, green and blue in sRGB");
  return cause;
}

ProgramNeed need_of(const toml::table& toml, const fs::path& file) {
  const Table table(toml, file, "need", {"program", "runs", "install"});
  ProgramNeed need;
  need.install = table.text("install");
  if (table.has("program") == table.has("runs")) table.refuse("program", "this", "one of program and runs, and only one");
  if (table.has("program")) need.program = table.text("program");
  if (table.has("runs")) need.runs = command_of(toml, table, "runs");
  return need;
}

/// One of a few words of a text key.
template <class Value>
Value one_of(const Table& table, std::string_view key, std::initializer_list<std::pair<std::string_view, Value>> values,
             Value fallback) {
  if (!table.has(key)) return fallback;
  std::vector<std::string> words;
  for (const auto& [word, value] : values) {
    if (word == table.text(key)) return value;
    words.emplace_back(word);
  }
  table.refuse(key, '\'' + table.text(key) + '\'', "one of " + joined(words, ", "));
}

bool is_program(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0;
}

bool is_in_path(const std::string& program) {
  std::istringstream folders(search_path());
  for (std::string folder; std::getline(folders, folder, ':');)
    if (is_program(fs::path(folder) / program)) return true;
  return false;
}

/// Titles, sentences, names and units are shown in a terminal, where they may do nothing else.
void refuse_control_characters(const toml::table& table, const fs::path& file) {
  for (const auto& [key, value] : table) {
    const auto text = value.value_exact<std::string>();
    if (text && has_control_characters(*text))
      throw Error("program.{} = '{}' is not a text without control characters ({}:{})", key.str(), *text, file.string(),
                  value.source().begin.line);
    if (const toml::array* const tables = value.as_array())
      for (const toml::node& item : *tables)
        if (const toml::table* const inner = item.as_table()) refuse_control_characters(*inner, file);
  }
}

}  // namespace

std::shared_ptr<const ProgramDescription> read_program(const fs::path& file) {
  const toml::table toml = read_toml("program " + file.string(), file);
  const Table table(
      toml, file, "program",
      {"title",     "summary", "source",     "error",      "fails",   "command",      "stages",   "lights", "approximate",
       "promise",   "sees",    "estimates",  "role",       "answers", "scene",        "gbuffer",  "mask",   "need",
       "parameter", "cause",   "rasterizes", "named_only", "handles", "update_error", "remembers"});
  auto made = std::make_shared<ProgramDescription>();
  ProgramDescription& d = *made;
  d.file = file;
  d.id = file.stem().string();
  if (!is_plain_name(d.id))
    throw Error("program {}: '{}' is no id; a file's stem of a..z, 0..9 and _ is required", file.string(), d.id);
  refuse_control_characters(toml, file);
  d.title = table.text("title");
  d.summary = table.text("summary");
  d.source = table.text("source");
  d.error = table.text("error");
  d.fails = table.text("fails");
  d.about = {.title = d.title, .summary = d.summary, .source = d.source, .error = d.error, .fails = d.fails};
  d.about.promise =
      one_of<Promise>(table, "promise", {{"exact", Promise::exact}, {"sampled", Promise::sampled}}, Promise::sampled);
  d.about.sees = one_of<Truth>(table, "sees", {{"mesh", Truth::mesh}, {"shape", Truth::shape}}, Truth::mesh);
  d.about.estimates = one_of<LightShareKind>(
      table, "estimates", {{"area", LightShareKind::area}, {"irradiance", LightShareKind::irradiance}}, LightShareKind::area);
  d.about.role = one_of<Role>(table, "role", {{"contender", Role::contender}, {"baseline", Role::baseline}}, Role::contender);
  d.mask = one_of<ProgramMask>(table, "mask",
                               {{"float32", ProgramMask::float32}, {"exr", ProgramMask::exr}, {"png", ProgramMask::png}},
                               ProgramMask::float32);
  d.command = command_of(toml, table, "command");
  if (d.command[0].find('/') != std::string::npos)
    d.command[0] = fs::absolute(file.parent_path() / d.command[0]).lexically_normal().string();
  const auto list = [&](std::string_view key, const std::vector<std::string>& known, std::vector<std::string> fallback) {
    return words_of(toml, table, key, known, std::move(fallback));
  };
  d.has_stage = stages_of(toml, table);
  d.about.update_error = update_error_of(table);
  d.about.remembers = table.flag("remembers", false);
  d.lights = list("lights", {std::begin(all_light_kinds), std::end(all_light_kinds)}, {"point", "spot", "directional"});
  d.light_kinds.assign(d.lights.begin(), d.lights.end());
  d.about.lights = d.light_kinds;
  if (table.has("approximate")) d.approximate = table.text("approximate");
  const std::vector<std::string> answers = list("answers", {"supports", "explain"}, {});
  d.answers_supports = holds(answers, "supports");
  d.explains = holds(answers, "explain");
  const std::vector<std::string> scene = list("scene", {"arrays", "gltf"}, {"arrays"});
  const std::vector<std::string> gbuffer = list("gbuffer", {"arrays", "exr"}, {"arrays"});
  d.wants_scene_arrays = holds(scene, "arrays");
  d.wants_gltf = holds(scene, "gltf");
  d.wants_gbuffer_arrays = holds(gbuffer, "arrays");
  d.wants_gbuffer_exr = holds(gbuffer, "exr");
  for (const toml::table* need : table.tables("need")) d.needs.push_back(need_of(*need, file));
  for (const toml::table* row : table.tables("parameter")) d.parameters.push_back(parameter_of(*row, file, d.parameters));
  for (const toml::table* row : table.tables("cause")) d.causes.push_back(cause_of(*row, file));
  for (const ProgramCause& cause : d.causes) d.cause_rows.push_back({cause.id, cause.sentence, cause.color});
  d.about.causes = d.cause_rows;
  d.about.rasterizes = table.flag("rasterizes", false);
  d.about.named_only = table.flag("named_only", false);
  for (const std::string& word : list("handles", names_of_features(), {})) d.handles.push_back(feature_named(word).value());
  d.about.handles = d.handles;
  return made;
}

bool is_program(const TechniqueEntry& entry) { return entry.origin.ends_with(".toml"); }

std::vector<std::string> described_stages(const TechniqueEntry& entry) {
  std::vector<std::string> names;
  if (!is_program(entry)) return names;
  const auto description = read_program(entry.origin);
  for (const Stage stage : all_stages)
    if (description->has_stage[static_cast<std::size_t>(stage)]) names.emplace_back(name(stage));
  return names;
}

std::string search_path() {
  const char* const path = std::getenv("PATH");
  return fmt::format("{}:{}", program_path().parent_path().string(), path ? path : "/usr/bin:/bin");
}

std::vector<fs::path> program_files(const ProgramDescription& d) {
  std::vector<fs::path> files = {d.file};
  std::set<fs::path> folders = {fs::path(d.file).replace_extension()};
  std::error_code ignored;
  for (std::size_t k = 1; k < d.command.size(); ++k) {
    const fs::path word = d.command[k], file = d.file.parent_path() / word;
    if (!fs::is_regular_file(file, ignored)) continue;
    files.push_back(file);
    if (word.is_relative() && word.has_parent_path() && *word.begin() != "." && *word.begin() != "..")
      folders.insert(file.parent_path());
  }
  std::set<fs::path> own;  // of its folders, where there are any
  for (const fs::path& folder : folders)
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
      if (entry.is_regular_file(ignored) && std::ranges::find(files, entry.path()) == files.end()) own.insert(entry.path());
  files.insert(files.end(), own.begin(), own.end());
  return files;
}

std::string missing_needs(const ProgramDescription& d) {
  static std::map<const ProgramDescription*, std::string> known;  // a need may be a command, which takes its time
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  if (const auto found = known.find(&d); found != known.end()) return found->second;
  std::vector<std::string> missing;
  const bool has_path = d.command[0].find('/') != std::string::npos;
  if (has_path ? !is_program(d.command[0]) : !is_in_path(d.command[0]))
    missing.push_back(fmt::format("{} is not on this machine", d.command[0]));
  for (const ProgramNeed& need : d.needs) {
    if (need.runs.empty() ? is_in_path(need.program) : ends_well(need.runs, d.file.parent_path())) continue;
    const std::string what =
        need.runs.empty() ? need.program + " is not on this machine" : joined(need.runs, " ") + " fails here";
    missing.push_back(fmt::format("{}: {}", what, need.install));
  }
  return known[&d] = joined(missing, "; ");
}

}  // namespace gnomon
