// What a worker tells of a technique is all that the program needs of it, whatever technique it is.
#include "measure/program/described_technique.h"

#include <gnomon/kit/bases/inner_technique.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "error_words.h"

namespace described_technique_test {
using namespace gnomon;

/// As the two come to the program: as text.
Json sent(const Json& json) { return parse_json(json_text(json)); }

void expect_same_rows(const Parametrized& there, const Parametrized& here) {
  const auto expected = there.parameters(), got = here.parameters();
  ASSERT_EQ(expected.size(), got.size()) << there.id();
  for (std::size_t k = 0; k < expected.size(); ++k) {
    SCOPED_TRACE(fmt::format("{}.{}", there.id(), expected[k]->name()));
    EXPECT_EQ(expected[k]->name(), got[k]->name());
    EXPECT_EQ(expected[k]->unit(), got[k]->unit());
    EXPECT_EQ(expected[k]->sentence(), got[k]->sentence());
    EXPECT_EQ(expected[k]->spoils(), got[k]->spoils());
    EXPECT_EQ(expected[k]->text(), got[k]->text());
    EXPECT_EQ(expected[k]->default_text(), got[k]->default_text());
    EXPECT_EQ(expected[k]->allowed(), got[k]->allowed());
    EXPECT_EQ(expected[k]->probes(), got[k]->probes());
  }
}

TEST(described_technique, has_data_sheet_parameters_and_layers_of_the_one_that_it_describes) {
  for (const TechniqueEntry& there : registry().techniques()) {
    SCOPED_TRACE(there.id);
    const TechniqueEntry here = described_technique(sent(sheet_json(there)), sent(object_json(there)), {}, "");
    const About &a = there.about, &b = here.about;
    EXPECT_EQ(there.id, here.id);
    EXPECT_EQ(std::tie(a.title, a.summary, a.source, a.error, a.fails),
              std::tie(b.title, b.summary, b.source, b.error, b.fails));
    EXPECT_EQ(std::tie(a.promise, a.sees, a.estimates, a.role, a.floor),
              std::tie(b.promise, b.sees, b.estimates, b.role, b.floor));
    EXPECT_EQ(std::tie(a.device, a.is_default, a.rasterizes, a.named_only, a.update_error, a.remembers),
              std::tie(b.device, b.is_default, b.rasterizes, b.named_only, b.update_error, b.remembers));
    EXPECT_TRUE(std::ranges::equal(a.handles, b.handles));
    ASSERT_EQ(a.causes.size(), b.causes.size());
    for (std::size_t k = 0; k < a.causes.size(); ++k)
      EXPECT_EQ(std::tie(a.causes[k].id, a.causes[k].sentence, a.causes[k].color),
                std::tie(b.causes[k].id, b.causes[k].sentence, b.causes[k].color));
    const auto first = there.make(), second = here.make();
    EXPECT_EQ(first->id(), second->id());
    expect_same_rows(*first, *second);
    EXPECT_EQ(first->surface_detail().has_value(), second->surface_detail().has_value());
    const auto layers = first->debug_layers(), told = second->debug_layers();
    ASSERT_EQ(layers.size(), told.size());
    for (std::size_t k = 0; k < layers.size(); ++k) {
      EXPECT_EQ(std::tie(layers[k].name, layers[k].sentence), std::tie(told[k].name, told[k].sentence));
      ASSERT_EQ(layers[k].legend.size(), told[k].legend.size());
      for (std::size_t i = 0; i < layers[k].legend.size(); ++i) {
        EXPECT_EQ(layers[k].legend[i].name, told[k].legend[i].name);
        EXPECT_EQ(layers[k].legend[i].color, told[k].legend[i].color);
      }
    }
  }
}

// Every setting that the one takes the other takes, and what the one refuses the other refuses with the same words.
TEST(described_technique, takes_and_refuses_the_same_settings) {
  for (const TechniqueEntry& there : registry().techniques()) {
    const TechniqueEntry here = described_technique(sent(sheet_json(there)), sent(object_json(there)), {}, "");
    std::vector<std::string> settings = {"nothing=1"};
    const auto fresh = there.make();
    for (const Parameter* row : fresh->parameters()) {
      for (const std::string& probe : row->probes()) settings.push_back(fmt::format("{}={}", row->name(), probe));
      settings.push_back(fmt::format("{}=nonsense", row->name()));
    }
    const auto outcome = [](Technique& technique, const std::string& text) -> std::string {
      try {
        technique.apply(text);
      } catch (const Error& error) {
        return error.what();
      }
      return technique.settings();
    };
    for (const std::string& text : settings) EXPECT_EQ(outcome(*there.make(), text), outcome(*here.make(), text));
  }
}

TEST(described_technique, does_nothing_here_and_says_why) {
  const TechniqueEntry& there = registry().technique("svbsp");
  const auto sound = described_technique(sheet_json(there), object_json(there), {}, "").make();
  EXPECT_THROW(sound->supports({}, {}, {}), Error);
  EXPECT_THROW(sound->setup(), Error);
  EXPECT_THROW(sound->forget(), Error);
  const TechniqueEntry broken = described_technique(sheet_json(there), Json(), {}, "crashed in describe");
  EXPECT_EQ(broken.broken, "crashed in describe");
  EXPECT_TRUE(broken.make()->parameters().empty());
  try {
    broken.make()->setup();
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "svbsp crashed in describe");
  }
}

// No object is here to call: it supports the lights that it was given, and where none were given it may support all.
TEST(described_technique, knows_the_lights_that_are_told_or_all) {
  const TechniqueEntry& there = registry().technique("area_rays");
  const std::vector<std::string> lights = {"rect", "disc"};
  EXPECT_EQ(known_lights(described_technique(sheet_json(there), object_json(there), lights, "")).size(), 2u);
  for (const char* broken : {"", "crashed"}) {
    const TechniqueEntry here = described_technique(sheet_json(there), Json(), {}, broken);
    EXPECT_EQ(known_lights(here).size(), 6u);
    EXPECT_EQ(has_no_hard_shadow(here), "");
  }
}

TEST(described_technique, nonsense_is_refused) {
  const TechniqueEntry& there = registry().technique("svbsp");
  for (const char* key : {"id", "title", "promise", "causes", "device", "handles", "update_error", "remembers"}) {
    Json sheet = sheet_json(there);
    sheet[key] = json_object({{"no", "sense"}});
    EXPECT_ANY_THROW(described_technique(sheet, object_json(there), {}, "")) << key;
  }
  Json sheet = sheet_json(there);
  sheet["role"] = 17;
  EXPECT_THROW(described_technique(sheet, object_json(there), {}, ""), Error);
  sheet = sheet_json(there);
  sheet["handles"] = {"shadows"};
  EXPECT_THROW(described_technique(sheet, object_json(there), {}, ""), Error);
  Json object = object_json(there);
  object["parameters"][0]["default"] = "none of these";
  EXPECT_ANY_THROW(described_technique(sheet_json(there), object, {}, ""));
}

TEST(described_technique, has_the_update_error_of_the_one_that_it_describes) {
  TechniqueEntry there = registry().technique("svbsp");
  const Json object = object_json(there);
  there.about.update_error = 3e-6f;
  EXPECT_EQ(described_technique(sent(sheet_json(there)), object, {}, "").about.update_error, 3e-6f);
}

TEST(described_technique, remembers_where_the_one_that_it_describes_does) {
  TechniqueEntry there = registry().technique("svbsp");
  const Json object = object_json(there);
  for (const bool remembers : {false, true}) {
    there.about.remembers = remembers;
    EXPECT_EQ(described_technique(sent(sheet_json(there)), object, {}, "").about.remembers, remembers);
  }
}

class SpoilsUpdate final : public Technique {
  Number<int> level{this, "level", 3, {"", 1, 9}, Stage::update, "A whole number."};

 public:
  Support supports(const Scene&, const Light&, const View&) const override { return Support::full(); }
  void setup() override {}
  void build(const Scene&) override {}
  void relight(const Light&) override {}
  void resolve(const GBuffer&, VisibilityMask&) override {}
  Counts counts() const override { return {}; }
};

TEST(described_technique, has_no_parameter_that_spoils_update) {
  const char* const words = "parameter level spoils update; a parameter spoils one of setup, build, relight, resolve";
  const TechniqueEntry spoils{.id = "spoils_update", .about = {}, .make = [] { return std::make_unique<SpoilsUpdate>(); }};
  EXPECT_EQ(error_words::error_of([&] { object_json(spoils); }), words);
  const TechniqueEntry& there = registry().technique("shadow_map");
  Json object = object_json(there);
  object["parameters"][0]["spoils"] = static_cast<int>(Stage::update);
  object["parameters"][0]["name"] = "level";
  EXPECT_EQ(error_words::error_of([&] { described_technique(sheet_json(there), object, {}, ""); }), words);
}

TEST(described_scene, has_the_parameters_of_the_one_that_it_describes_and_is_made_elsewhere) {
  for (const SceneEntry& there : registry().scenes()) {
    std::string asked;
    const auto make = [&](const std::string& id, const std::string& settings) {
      asked = id + ":" + settings;
      return Scene();
    };
    const SceneEntry here = described_scene(sent(sheet_json(there)), sent(object_json(there)), "", make);
    EXPECT_EQ(there.about.title, here.about.title);
    ASSERT_EQ(there.about.keys.size(), here.about.keys.size());
    for (std::size_t k = 0; k < there.about.keys.size(); ++k) EXPECT_EQ(there.about.keys[k].letter, here.about.keys[k].letter);
    expect_same_rows(*there.make(), *here.make());
    here.make()->make();
    EXPECT_EQ(asked, there.id + ":");
    EXPECT_THROW(described_scene(sheet_json(there), Json(), "crashed", make).make()->make(), Error);
  }
}

}  // namespace described_technique_test
