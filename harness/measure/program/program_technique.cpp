#include "measure/program/program_technique.h"

#include <sched.h>

#include <set>

#include "measure/paths.h"
#include "measure/program/changes_json.h"
#include "measure/program/elsewhere.h"
#include "measure/program/explanation_json.h"
#include "measure/program/program_files.h"
#include "measure/program/program_process.h"
#include "measure/scene/scene_json.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// The folder of gnomon_technique.py: in the source tree, or installed.
fs::path python_folder() {
  const fs::path root = find_data_root();
  return fs::is_directory(root / "harness/python") ? root / "harness/python" : root / "python";
}

int usable_cores() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  return sched_getaffinity(0, sizeof cores, &cores) == 0 ? CPU_COUNT(&cores) : 1;
}

class ProgramTechnique final : public Technique, public WorksElsewhere {
 public:
  explicit ProgramTechnique(std::shared_ptr<const ProgramDescription> description)
      : d_(std::move(description)), rows_(described_rows(d_->parameters, this)) {
    set_id(d_->id);
  }

  Support supports(const Scene& scene, const Light& light, const View& view) const override {
    if (const std::string missing = missing_needs(*d_); !missing.empty()) return Support::unsupported(missing);
    if (std::ranges::find(d_->lights, kind_name(light)) == d_->lights.end())
      return Support::unsupported(
          fmt::format("it knows no {} lights; it knows {}", kind_name(light), joined(d_->lights, ", ")));
    if (d_->answers_supports) return asked_support(scene, light, view);
    return d_->approximate.empty() ? Support::full() : Support::approximate(d_->approximate);
  }

  void setup() override {
    program_.reset();
    stage_counts_ = {};
    maker_.clear();
    program_.emplace(*d_);
    tell(Stage::setup, {});
  }
  void build(const Scene& scene) override {
    stage_counts_[static_cast<std::size_t>(Stage::update)].clear();  // build has counted the same things anew
    tell(Stage::build, {{"scene", program().inputs.scene(scene)}});
  }
  /// A program without this stage builds, as every technique does.
  void update(const Scene& scene, const Changes& changes) override {
    if (!program().has_stage(Stage::update)) return build(scene);
    tell(Stage::update, {{"scene", program().inputs.scene(scene)}, {"changes", changes_json(scene, changes)}});
  }
  void relight(const Light& light) override { tell(Stage::relight, {{"light", scene_json(light)}}); }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const ProgramMaskFile file(d_->mask, program().inputs.folder());
    tell(Stage::resolve, {{"view", scene_json(gbuffer.view)},
                          {"gbuffer", program().inputs.gbuffer(gbuffer)},
                          {"mask", file.fresh(gbuffer.width, gbuffer.height)}});
    file.read(mask);
  }
  /// A program that does not remember is not told, and one that has not been started has nothing to forget.
  void forget() override {
    if (!d_->about.remembers || !program_) return;
    const Json answer = program_->process.ask(json_object({{"do", "forget"}, {"settings", settings_json()}}));
    if (!answer.empty()) throw Error("forget was answered with the key {}; it may have none", answer.begin().key());
  }

  /// The last counts of each stage, and `bytes`: by how much the process has grown since it started, unless it counts that
  /// itself.
  Counts counts() const override {
    Counts all;
    std::set<std::string> known;
    for (auto stage = stage_counts_.rbegin(); stage != stage_counts_.rend(); ++stage)
      for (const Count& count : *stage)
        if (known.insert(count.name).second) all.push_back(count);
    if (!known.contains("bytes") && program_) {
      const double grown = program_->process.resident_bytes() - program_->bytes_at_start;
      all.push_back({"bytes", std::max(0.0, grown), "byte"});
    }
    return all;
  }
  std::optional<double> own_ms() const override { return own_ms_; }
  std::string maker() const override { return maker_; }

  std::optional<Explanation> explain(std::size_t index) const override {
    return explain_all(std::vector{static_cast<std::uint32_t>(index)}).at(0);
  }
  std::vector<std::optional<Explanation>> explain_all(std::span<const std::uint32_t> pixels) const override {
    if (!d_->explains) return std::vector<std::optional<Explanation>>(pixels.size());
    std::vector<std::optional<Explanation>> all;
    constexpr std::size_t portion = 1000;
    while (all.size() < pixels.size()) {
      const auto some = pixels.subspan(all.size(), std::min(portion, pixels.size() - all.size()));
      const Json answer = program().process.ask(json_object(
          {{"do", "explain"}, {"settings", settings_json()}, {"pixels", Json(std::vector(some.begin(), some.end()))}}));
      if (!answer.contains("explanations")) throw Error("explain was answered without explanations");
      const auto known = explanations_from_json(answer["explanations"]);
      if (known.size() != some.size()) throw Error("{} explanations came for {} pixels", known.size(), some.size());
      all.insert(all.end(), known.begin(), known.end());
    }
    return all;
  }

 private:
  /// A program that runs, and the files between it and this process.
  struct Running {
    explicit Running(const ProgramDescription& d)
        : inputs(d),
          process(d.command, fs::absolute(d.file).parent_path(),
                  {{"PYTHONPATH", python_folder().string()}, {"PYTHONDONTWRITEBYTECODE", "1"}, {"PATH", search_path()}}) {
      const Json answer = process.ask(json_object({{"do", "hello"},
                                                   {"protocol", program_protocol},
                                                   {"technique", d.id},
                                                   {"folder", inputs.folder().string()},
                                                   {"threads", usable_cores()}}));
      if (answer.value("protocol", Json()) != program_protocol)
        throw Error("{} speaks protocol {}; this program speaks {}", d.command[0], json_text(answer.value("protocol", Json())),
                    program_protocol);
      stages = d.has_stage;
      if (answer.contains("stages")) add_stages(d, answer["stages"]);
      bytes_at_start = process.resident_bytes();
    }
    bool has_stage(Stage stage) const { return stages[static_cast<std::size_t>(stage)]; }
    /// Of an answer to hello: stages beside those of the description.
    void add_stages(const ProgramDescription& d, const Json& more) {
      if (more != Json::array() && more != Json::array({name(Stage::update)}))
        throw Error("hello was answered with stages = {}; update is the one that may be added to those of {}: [\"update\"]",
                    json_text(more), d.file.string());
      if (more.empty()) return;
      if (!has_stage(Stage::build))
        throw Error("hello was answered with stages = {}, but those of {} have no build, in whose place update stands",
                    json_text(more), d.file.string());
      stages[static_cast<std::size_t>(Stage::update)] = true;
    }

    ProgramInputs inputs;
    ProgramProcess process;
    std::array<bool, std::size(stage_names)> stages{};  ///< that it receives, by Stage
    double bytes_at_start = 0;
  };

  Json settings_json() const {
    Json settings = json_object();
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const bool is_word = std::holds_alternative<DescribedParameter::Word>(d_->parameters[k].kind);
      settings[std::string(rows_[k]->name())] = is_word ? Json(rows_[k]->text()) : parse_json(rows_[k]->text());
    }
    return settings;
  }

  Running& program() const {
    if (!program_) throw Error("{} is not set up", id());
    return *program_;
  }

  /// One stage, where the program has it.
  void tell(Stage stage, std::initializer_list<JsonField> facts) {
    own_ms_ = 0;
    if (!program().has_stage(stage)) return;
    Json request = json_object({{"do", name(stage)}, {"settings", settings_json()}});
    for (const JsonField& fact : facts) request[fact.key] = fact.value;
    const Json answer = program().process.ask(request);
    own_ms_.reset();
    for (const auto& [key, value] : answer.items()) {
      if (key == "ms") {
        if (!value.is_number())
          throw Error("{} took ms = {}; a number of milliseconds is required", name(stage), json_text(value));
        own_ms_ = value.get<double>();
      } else if (key == "counts") {
        stage_counts_[static_cast<std::size_t>(stage)] = counts_from(value);
      } else if (key == "maker") {
        if (!value.is_string()) throw Error("maker = {}; a text is required", json_text(value));
        maker_ = value;
      } else {
        throw Error("{} was answered with the key {}; it may have: ms, counts, maker", name(stage), key);
      }
    }
  }

  static Counts counts_from(const Json& list) {
    if (!list.is_array()) throw Error("counts are {}; a list is wanted", list.type_name());
    Counts counts;
    for (const Json& item : list) {
      const bool is_count = item.is_object() && item.contains("name") && item["name"].is_string() && item.contains("value") &&
                            item["value"].is_number() && item["value"].get<double>() >= 0 &&
                            item.value("unit", Json("")).is_string();
      if (!is_count) throw Error("the count {} has not name, value of 0 or more, and unit", json_text(item));
      counts.push_back({item["name"], item["value"], item.value("unit", "")});
    }
    return counts;
  }

  /// By a process of its own, because this comes before anything runs.
  Support asked_support(const Scene& scene, const Light& light, const View& view) const {
    Running running(*d_);
    const Json answer = running.process.ask(json_object({{"do", "supports"},
                                                         {"settings", settings_json()},
                                                         {"scene", running.inputs.scene(scene)},
                                                         {"light", scene_json(light)},
                                                         {"view", scene_json(view)}}));
    const std::string support = plain_text(answer.value("support", Json())), why = plain_text(answer.value("why", Json("")));
    if (support == "full") return Support::full();
    if (why.empty()) throw Error("supports was answered with {} without a why", support);
    if (support == "approximate") return Support::approximate(why);
    if (support == "unsupported") return Support::unsupported(why);
    throw Error("supports was answered with {}; full, approximate or unsupported is required", support);
  }

  std::shared_ptr<const ProgramDescription> d_;
  std::vector<std::unique_ptr<Parameter>> rows_;
  mutable std::optional<Running> program_;
  std::array<Counts, std::size(stage_names)> stage_counts_;
  std::optional<double> own_ms_;
  std::string maker_;
};

}  // namespace

void load_program(const fs::path& file) {
  const auto description = read_program(file);
  std::error_code ignored;
  if (const TechniqueEntry* const known = registry().find_technique(description->id);
      known && fs::equivalent(file, known->origin, ignored))
    return;
  registry().add(TechniqueEntry{.id = description->id,
                                .about = description->about,
                                .make = [description] { return std::make_unique<ProgramTechnique>(description); },
                                .origin = file.string()});
}

void load_programs_of(const fs::path& folder) {
  std::error_code ignored;
  std::set<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().extension() == ".toml") files.insert(entry.path());
  for (const fs::path& file : files) load_program(file);
}

}  // namespace gnomon
