#include "measure/program/described_technique.h"

#include <deque>

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
    check_spoils(row->name(), row->spoils());
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

DescribedParameter row_of(const Json& json) {
  DescribedParameter row;
  row.name = json.at("name").get<std::string>();
  row.unit = json.at("unit").get<std::string>();
  row.sentence = json.at("sentence").get<std::string>();
  row.stage = enum_of(json.at("spoils"), Stage::resolve);
  const std::string value = json.at("default").get<std::string>();
  const Json& of_kind = json.at("kind");
  if (!of_kind.is_object() || of_kind.size() != 1) throw Error("{} is no kind of parameter", json_text(of_kind));
  const std::string kind = of_kind.begin().key();
  const Json& facts = of_kind.begin().value();
  const auto ranged = [&](auto zero) {
    using Value = decltype(zero);
    return DescribedParameter::Ranged<Value>{parse_json(value).get<Value>(),
                                             {"", facts.at("min"), facts.at("max"), facts.at("log")}};
  };
  if (kind == "whole")
    row.kind = ranged(int());
  else if (kind == "real")
    row.kind = ranged(double());
  else if (kind == "flag")
    row.kind = value == "true";
  else
    row.kind = DescribedParameter::Word{value, facts.get<std::vector<std::string>>(), kind == "object"};
  return row;
}

/// What both kinds of entries have.
struct Facts {
  Facts(const Json& sheet, const Json& object, const std::string& why_broken)
      : id(sheet.at("id").get<std::string>()), broken(why_broken) {
    if (object.is_null()) return;
    for (const Json& row : object.at("parameters")) rows.push_back(row_of(row));
  }
  std::string id, broken;
  std::vector<DescribedParameter> rows;
};

class DescribedTechnique final : public Technique {
 public:
  struct AllFacts : Facts {
    using Facts::Facts;
    std::vector<DebugLayer> layers;
    bool has_detail = false;
  };
  explicit DescribedTechnique(std::shared_ptr<const AllFacts> facts)
      : facts_(std::move(facts)), rows_(described_rows(facts_->rows, this)) {
    set_id(facts_->id);
  }

  Support supports(const Scene&, const Light&, const View&) const override { elsewhere(); }
  void setup() override { elsewhere(); }
  void build(const Scene&) override { elsewhere(); }
  void relight(const Light&) override { elsewhere(); }
  void resolve(const GBuffer&, VisibilityMask&) override { elsewhere(); }
  void forget() override { elsewhere(); }
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
  std::shared_ptr<const AllFacts> facts_;
  std::vector<std::unique_ptr<Parameter>> rows_;
};

class DescribedScene final : public SceneGenerator {
 public:
  DescribedScene(std::shared_ptr<const Facts> facts, MakeScene make)
      : facts_(std::move(facts)), make_(std::move(make)), rows_(described_rows(facts_->rows, this)) {
    set_id(facts_->id);
  }
  Scene make() const override {
    if (!facts_->broken.empty()) throw Error("scene {} {}", facts_->id, facts_->broken);
    return make_(facts_->id, settings());
  }

 private:
  std::shared_ptr<const Facts> facts_;
  MakeScene make_;
  std::vector<std::unique_ptr<Parameter>> rows_;
};

Json color_json(const glm::dvec3& color) { return {color.x, color.y, color.z}; }
glm::dvec3 color_of(const Json& color) {
  return {color.at(0).get<double>(), color.at(1).get<double>(), color.at(2).get<double>()};
}

/// Calls use(key, member) for every text, flag and number of a data sheet, and use(key, member, last) for every enum.
template <class SomeAbout>
void for_each_fact(SomeAbout& about, const auto& use) {
  use("title", about.title);
  use("summary", about.summary);
  use("is_default", about.is_default);
  if constexpr (std::is_same_v<std::remove_const_t<SomeAbout>, About>) {
    use("source", about.source);
    use("error", about.error);
    use("fails", about.fails);
    use("promise", about.promise, Promise::sampled);
    use("sees", about.sees, Truth::mesh);
    use("estimates", about.estimates, LightShareKind::irradiance);
    use("role", about.role, Role::reference);
    use("floor", about.floor, Floor::copy);
    use("device", about.device, Device::vulkan);
    use("rasterizes", about.rasterizes);
    use("named_only", about.named_only);
    use("update_error", about.update_error);
    use("remembers", about.remembers);
  }
}

/// Id, texts, enums, flags and numbers of a data sheet.
Json facts_json(const auto& entry) {
  Json sheet = json_object({{"id", entry.id}});
  for_each_fact(entry.about, [&](const char* key, const auto& fact, [[maybe_unused]] auto... last) {
    if constexpr (sizeof...(last) > 0)
      sheet[key] = static_cast<int>(fact);
    else
      sheet[key] = fact;
  });
  return sheet;
}

/// A copy that lives as long as this process, for entries to point to.
std::string_view kept(const Json& text) {
  static std::deque<std::string> all;
  return all.emplace_back(text.get<std::string>());
}

/// The same of the features that a data sheet handles. Throws Error on a name that is none.
std::span<const Feature> kept_features(const Json& names) {
  static std::deque<std::vector<Feature>> all;
  std::vector<Feature>& features = all.emplace_back();
  for (const std::string& name : names.get<std::vector<std::string>>()) {
    const std::optional<Feature> feature = feature_named(name);
    if (!feature) throw Error("handles = {} is no feature of scenes", name);
    features.push_back(*feature);
  }
  return features;
}

void read_facts(const Json& sheet, auto& about) {
  for_each_fact(about, [&](const char* key, auto& fact, [[maybe_unused]] auto... last) {
    if constexpr (sizeof...(last) > 0)
      fact = enum_of(sheet.at(key), last...);
    else if constexpr (std::is_same_v<decltype(fact), bool&>)
      fact = sheet.at(key).get<bool>();
    else if constexpr (std::is_same_v<decltype(fact), float&>)
      fact = sheet.at(key).get<float>();
    else
      fact = kept(sheet.at(key));
  });
}

}  // namespace

Json sheet_json(const TechniqueEntry& entry) {
  Json sheet = facts_json(entry);
  sheet["handles"] = Json::array();
  for (const Feature feature : entry.about.handles) sheet["handles"].push_back(name(feature));
  sheet["causes"] = Json::array();
  for (const OwnCause& cause : entry.about.causes)
    sheet["causes"].push_back(json_object({{"id", cause.id}, {"sentence", cause.sentence}, {"color", cause.color}}));
  return sheet;
}

Json sheet_json(const SceneEntry& entry) {
  Json sheet = facts_json(entry);
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
  const auto facts = std::make_shared<DescribedTechnique::AllFacts>(sheet, object, broken);
  TechniqueEntry entry;
  entry.id = facts->id;
  entry.broken = broken;
  About& about = entry.about;
  read_facts(sheet, about);
  about.handles = kept_features(sheet.at("handles"));
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
  if (!object.is_null()) {
    facts->has_detail = object.at("has_detail");
    for (const Json& layer : object.at("layers")) {
      DebugLayer& one = facts->layers.emplace_back(DebugLayer{layer.at("name"), layer.at("sentence")});
      for (const Json& swatch : layer.at("legend"))
        one.legend.push_back({swatch.at("name").get<std::string>(), color_of(swatch.at("color"))});
    }
  }
  entry.make = [facts] { return std::make_unique<DescribedTechnique>(facts); };
  entry.make();  // throws Error where a row is none
  return entry;
}

SceneEntry described_scene(const Json& sheet, const Json& object, const std::string& broken, const MakeScene& make) {
  const auto facts = std::make_shared<const Facts>(sheet, object, broken);
  SceneEntry entry;
  entry.id = facts->id;
  read_facts(sheet, entry.about);
  for (const Json& key : sheet.at("keys"))
    entry.about.keys.push_back({static_cast<char>(key.at("letter").get<int>()), kept(key.at("parameter")),
                                kept(key.at("value")), kept(key.at("sentence"))});
  entry.make = [facts, make] { return std::make_unique<DescribedScene>(facts, make); };
  entry.make();
  return entry;
}

}  // namespace gnomon
