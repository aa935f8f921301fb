#include "measure/program/described_technique.h"

#include <algorithm>
#include <deque>

#include "measure/program/described_parameter.h"
#include "measure/program/description.h"

namespace gnomon {

namespace {

// --- There: an entry as JSON -----------------------------------------------------------------------------------------------

Json kind_json(const Parameter& row) {
  const auto range = [](const auto& number) {
    return json_object({{"min", number.range().min}, {"max", number.range().max}, {"log", number.range().log}});
  };
  if (const auto* const whole = dynamic_cast<const Number<int>*>(&row)) return json_object({{"whole", range(*whole)}});
  if (const auto* const real = dynamic_cast<const Number<double>*>(&row)) return json_object({{"real", range(*real)}});
  if (dynamic_cast<const Flag*>(&row)) return json_object({{"flag", nullptr}});
  const bool is_object = dynamic_cast<const ObjectParameter*>(&row) != nullptr;
  return json_object({{is_object ? "object" : "word", row.probes()}});
}

/// Rows of its own; those of an object among them are that object's.
Json parameters_json(const Parametrized& of) {
  Json rows = Json::array();
  for (const Parameter* const row : of.parameters()) {
    if (&typed(*row) != row) continue;
    rows.push_back(json_object({{"name", row->name()},
                                {"unit", row->unit()},
                                {"sentence", row->sentence()},
                                {"spoils", static_cast<int>(row->spoils())},
                                {"default", row->default_text()},
                                {"kind", kind_json(*row)}}));
  }
  return rows;
}

// --- Here: an entry of JSON ------------------------------------------------------------------------------------------------

template <class Enum>
Enum enum_of(const Json& number, Enum last) {
  const int value = number.get<int>();
  if (value < 0 || value > static_cast<int>(last)) throw Error("{} is outside 0 .. {}", value, static_cast<int>(last));
  return static_cast<Enum>(value);
}

/// An object of the registry among the rows, of those that the plugin allows.
class DescribedObject final : public ObjectParameter {
 public:
  DescribedObject(Parametrized* owner, const DescribedParameter& row, const DescribedParameter::Word& word)
      : ObjectParameter(owner, row.name, word.value, row.stage, row.sentence), ids_(word.choices) {}

 private:
  std::vector<std::string> ids() const override { return ids_; }
  std::string objection(std::string_view id) const override {
    if (std::ranges::find(ids_, id) != ids_.end()) return "";
    return fmt::format("did you mean {}?", nearest_word(id, ids_));
  }
  std::unique_ptr<Parametrized> made(std::string_view id) const override { return registry().technique(id).make(); }

  std::vector<std::string> ids_;
};

struct DescribedRow {
  DescribedParameter row;
  bool is_object = false;
};

DescribedRow row_of(const Json& json) {
  DescribedRow result;
  DescribedParameter& row = result.row;
  row.name = json.at("name").get<std::string>();
  row.unit = json.at("unit").get<std::string>();
  row.sentence = json.at("sentence").get<std::string>();
  row.stage = enum_of(json.at("spoils"), Stage::resolve);
  const std::string value = json.at("default").get<std::string>();
  const Json& of_kind = json.at("kind");
  if (!of_kind.is_object() || of_kind.size() != 1) throw Error("{} is no kind of parameter", json_text(of_kind));
  const std::string kind = of_kind.begin().key();
  const Json& facts = of_kind.begin().value();
  if (kind == "whole")
    row.kind = DescribedParameter::Whole{parse_json(value).get<int>(), {"", facts.at("min"), facts.at("max"), facts.at("log")}};
  else if (kind == "real")
    row.kind =
        DescribedParameter::Real{parse_json(value).get<double>(), {"", facts.at("min"), facts.at("max"), facts.at("log")}};
  else if (kind == "flag")
    row.kind = value == "true";
  else
    row.kind = DescribedParameter::Word{value, facts.get<std::vector<std::string>>()};
  result.is_object = kind == "object";
  return result;
}

/// Rows of a Parametrized by their descriptions.
struct Rows {
  Rows(Parametrized* owner, std::span<const DescribedRow> described) {
    for (const DescribedRow& one : described)
      if (one.is_object)
        rows.push_back(std::make_unique<DescribedObject>(owner, one.row, std::get<DescribedParameter::Word>(one.row.kind)));
      else
        rows.push_back(made(one.row, owner));
  }
  std::vector<std::unique_ptr<Parameter>> rows;
};

class DescribedTechnique final : public Technique {
 public:
  struct Facts {
    std::vector<DescribedRow> rows;
    std::vector<DebugLayer> layers;
    bool has_detail = false;
    std::string id, broken;
  };
  explicit DescribedTechnique(std::shared_ptr<const Facts> facts) : facts_(std::move(facts)), rows_(this, facts_->rows) {
    set_id(facts_->id);
  }

  Support supports(const Scene&, const Light&, const View&) const override { elsewhere(); }
  void setup() override { elsewhere(); }
  void build(const Scene&) override { elsewhere(); }
  void relight(const Light&) override { elsewhere(); }
  void resolve(const GBuffer&, VisibilityMask&) override { elsewhere(); }
  Counts counts() const override { elsewhere(); }
  std::optional<SurfaceDetail> surface_detail() const override {
    return facts_->has_detail ? std::optional(SurfaceDetail()) : std::nullopt;
  }
  std::vector<DebugLayer> debug_layers() const override { return facts_->layers; }

 private:
  [[noreturn]] void elsewhere() const {
    if (!facts_->broken.empty()) throw Error("{} {}", facts_->id, facts_->broken);
    throw Error("{} is of a plugin, and only workers run it", facts_->id);
  }
  std::shared_ptr<const Facts> facts_;
  Rows rows_;
};

class DescribedScene final : public SceneGenerator {
 public:
  struct Facts {
    std::vector<DescribedRow> rows;
    std::string id, broken;
    MakeScene make;
  };
  explicit DescribedScene(std::shared_ptr<const Facts> facts) : facts_(std::move(facts)), rows_(this, facts_->rows) {
    set_id(facts_->id);
  }
  Scene make() const override {
    if (!facts_->broken.empty()) throw Error("scene {} {}", facts_->id, facts_->broken);
    return facts_->make(facts_->id, settings());
  }

 private:
  std::shared_ptr<const Facts> facts_;
  Rows rows_;
};

std::vector<DescribedRow> rows_of(const Json& object) {
  std::vector<DescribedRow> rows;
  if (object.is_null()) return rows;
  for (const Json& row : object.at("parameters")) rows.push_back(row_of(row));
  return rows;
}

Json color_json(const glm::dvec3& color) { return {color.x, color.y, color.z}; }
glm::dvec3 color_of(const Json& color) {
  return {color.at(0).get<double>(), color.at(1).get<double>(), color.at(2).get<double>()};
}

/// Calls use(key, text) for every text of a data sheet.
template <class SomeAbout>
void for_each_text(SomeAbout& about, const auto& use) {
  use("title", about.title);
  use("summary", about.summary);
  if constexpr (std::is_same_v<std::remove_const_t<SomeAbout>, About>) {
    use("source", about.source);
    use("error", about.error);
    use("fails", about.fails);
  }
}

/// A kept copy, which entries may look at for as long as this process lives.
std::string_view kept(const Json& text) {
  static std::deque<std::string> all;
  return all.emplace_back(text.get<std::string>());
}

}  // namespace

Json sheet_json(const TechniqueEntry& entry) {
  const About& about = entry.about;
  Json sheet = json_object({{"id", entry.id}});
  for_each_text(about, [&](const char* key, std::string_view text) { sheet[key] = text; });
  sheet["promise"] = static_cast<int>(about.promise);
  sheet["sees"] = static_cast<int>(about.sees);
  sheet["estimates"] = static_cast<int>(about.estimates);
  sheet["role"] = static_cast<int>(about.role);
  sheet["floor"] = static_cast<int>(about.floor);
  sheet["needs_gl"] = about.needs_gl;
  sheet["is_default"] = about.is_default;
  sheet["rasterizes"] = about.rasterizes;
  sheet["named_only"] = about.named_only;
  sheet["causes"] = Json::array();
  for (const OwnCause& cause : about.causes)
    sheet["causes"].push_back(json_object({{"id", cause.id}, {"sentence", cause.sentence}, {"color", cause.color}}));
  return sheet;
}

Json sheet_json(const SceneEntry& entry) {
  Json sheet = json_object({{"id", entry.id}});
  for_each_text(entry.about, [&](const char* key, std::string_view text) { sheet[key] = text; });
  sheet["is_default"] = entry.about.is_default;
  sheet["keys"] = Json::array();
  for (const SceneKey& key : entry.about.keys)
    sheet["keys"].push_back(json_object({{"letter", static_cast<int>(key.letter)},
                                         {"parameter", key.parameter},
                                         {"value", key.value},
                                         {"sentence", key.sentence}}));
  return sheet;
}

Json object_json(const TechniqueEntry& entry) {
  const std::unique_ptr<Technique> technique = entry.make();
  if (!technique) throw Error("its constructor gave nothing");
  Json object = json_object({{"parameters", parameters_json(*technique)}, {"layers", Json::array()}});
  for (const DebugLayer& layer : technique->debug_layers()) {
    Json& one = object["layers"].emplace_back(json_object({{"name", layer.name}, {"sentence", layer.sentence}}));
    one["legend"] = Json::array();
    for (const Swatch& swatch : layer.legend)
      one["legend"].push_back(json_object({{"name", swatch.name}, {"color", color_json(swatch.color)}}));
  }
  object["has_detail"] = technique->surface_detail().has_value();
  return object;
}

Json object_json(const SceneEntry& entry) {
  const std::unique_ptr<SceneGenerator> scene = entry.make();
  if (!scene) throw Error("its constructor gave nothing");
  return json_object({{"parameters", parameters_json(*scene)}});
}

TechniqueEntry described_technique(const Json& sheet, const Json& object, const std::vector<std::string>& lights_known,
                                   const std::string& broken) {
  TechniqueEntry entry;
  entry.id = sheet.at("id").get<std::string>();
  About& about = entry.about;
  for_each_text(about, [&](const char* key, std::string_view& text) { text = kept(sheet.at(key)); });
  about.promise = enum_of(sheet.at("promise"), Promise::sampled);
  about.sees = enum_of(sheet.at("sees"), Truth::mesh);
  about.estimates = enum_of(sheet.at("estimates"), LightShareKind::irradiance);
  about.role = enum_of(sheet.at("role"), Role::reference);
  about.floor = enum_of(sheet.at("floor"), Floor::copy);
  about.needs_gl = sheet.at("needs_gl");
  about.is_default = sheet.at("is_default");
  about.rasterizes = sheet.at("rasterizes");
  about.named_only = sheet.at("named_only");
  static std::deque<std::vector<OwnCause>> all_causes;  // that entries look at
  std::vector<OwnCause>& causes = all_causes.emplace_back();
  for (const Json& cause : sheet.at("causes"))
    causes.push_back({kept(cause.at("id")), kept(cause.at("sentence")), cause.at("color").get<std::array<std::uint8_t, 3>>()});
  about.causes = causes;
  static std::deque<std::vector<std::string_view>> all_lights;
  std::vector<std::string_view>& lights = all_lights.emplace_back();
  for (const std::string& light : lights_known) lights.push_back(kept(light));
  if (lights.empty()) lights.assign(std::begin(all_light_kinds), std::end(all_light_kinds));
  about.lights = lights;

  const auto facts = std::make_shared<DescribedTechnique::Facts>();
  facts->id = entry.id;
  facts->broken = broken;
  facts->rows = rows_of(object);
  if (!object.is_null()) {
    facts->has_detail = object.at("has_detail");
    for (const Json& layer : object.at("layers")) {
      DebugLayer& one = facts->layers.emplace_back(DebugLayer{layer.at("name"), layer.at("sentence")});
      for (const Json& swatch : layer.at("legend"))
        one.legend.push_back({swatch.at("name").get<std::string>(), color_of(swatch.at("color"))});
    }
  }
  entry.broken = broken;
  entry.make = [facts] { return std::make_unique<DescribedTechnique>(facts); };
  entry.make();  // throws Error where a row is none
  return entry;
}

SceneEntry described_scene(const Json& sheet, const Json& object, const std::string& broken, const MakeScene& make) {
  SceneEntry entry;
  entry.id = sheet.at("id").get<std::string>();
  SceneAbout& about = entry.about;
  for_each_text(about, [&](const char* key, std::string_view& text) { text = kept(sheet.at(key)); });
  about.is_default = sheet.at("is_default");
  for (const Json& key : sheet.at("keys"))
    about.keys.push_back({static_cast<char>(key.at("letter").get<int>()), kept(key.at("parameter")), kept(key.at("value")),
                          kept(key.at("sentence"))});
  const auto facts = std::make_shared<DescribedScene::Facts>();
  facts->id = entry.id;
  facts->broken = broken;
  facts->rows = rows_of(object);
  facts->make = make;
  entry.make = [facts] { return std::make_unique<DescribedScene>(facts); };
  entry.make();
  return entry;
}

}  // namespace gnomon
