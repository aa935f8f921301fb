// What a technique says of itself: texts, parameters, support.
#include <algorithm>
#include <set>

#include "stage.h"

namespace conformance {
namespace {

class Says : public Every {};
INSTANTIATE_TEST_SUITE_P(technique, Says, testing::ValuesIn(technique_ids()), id_of);

/// Asked without OpenGL, as the harness asks: this suite makes no context.
class WithoutGl : public Says {
  void SetUp() override {}
};
INSTANTIATE_TEST_SUITE_P(technique, WithoutGl, testing::ValuesIn(technique_ids()), id_of);

bool is_sentence(std::string_view text) {
  return !text.empty() && text.back() == '.' && !std::islower(static_cast<unsigned char>(text.front()));
}

TEST(Registered, exactly_one_technique_is_the_reference) {
  EXPECT_EQ(std::ranges::count(registry().techniques(), Role::reference, [](const auto& e) { return e.about.role; }), 1);
}

TEST_P(Says, says_what_it_is_where_it_comes_from_and_what_breaks_it) {
  EXPECT_TRUE(is_plain_name(entry().id));
  const About& about = entry().about;
  EXPECT_FALSE(about.title.empty());
  EXPECT_FALSE(about.source.empty());
  EXPECT_TRUE(is_sentence(about.summary)) << about.summary;
  EXPECT_TRUE(is_sentence(about.error)) << about.error;
  EXPECT_TRUE(is_sentence(about.fails)) << about.fails;
  EXPECT_EQ(entry().make()->id(), entry().id);
}

// One that refuses everything would pass all that is asked of answers.
TEST_P(Says, supports_a_light_of_the_scenes_that_it_is_asked_with) {
  for (const char* reference : {"sphere_over_plane:segments=24", "box_city:count=12"})
    EXPECT_FALSE(supported_lights(load_scene(reference)).empty()) << reference;
}

TEST_P(Says, documents_every_parameter_and_layer) {
  const auto technique = entry().make();
  std::set<std::string_view> names;
  for (const Parameter* p : technique->parameters()) {
    EXPECT_TRUE(is_plain_name(p->name())) << p->name();
    EXPECT_TRUE(names.insert(p->name()).second) << p->name() << " is there twice";
    EXPECT_TRUE(is_sentence(p->sentence())) << p->name() << ": " << p->sentence();
    EXPECT_FALSE(p->allowed().empty()) << p->name();
    EXPECT_EQ(p->text(), p->default_text()) << p->name();
    EXPECT_GE(p->probes().size(), 2u) << p->name();
    EXPECT_EQ(&technique->parameter(p->name()), p);
  }
  names.clear();
  const std::vector<DebugLayer> layers = technique->debug_layers();
  for (const DebugLayer& layer : layers) {
    EXPECT_TRUE(is_plain_name(layer.name)) << layer.name;
    EXPECT_TRUE(names.insert(layer.name).second) << layer.name << " is there twice";
    EXPECT_TRUE(is_sentence(layer.sentence)) << layer.name << ": " << layer.sentence;
    std::set<std::string_view> swatches;
    for (const Swatch& swatch : layer.legend) {
      EXPECT_TRUE(!swatch.name.empty() && swatches.insert(swatch.name).second) << layer.name << ": " << swatch.name;
      for (int c = 0; c < 3; ++c)
        EXPECT_TRUE(swatch.color[c] >= 0 && swatch.color[c] <= 1) << layer.name << ": " << swatch.name;
    }
  }
  EXPECT_EQ(technique->settings(), "");
}

TEST_P(Says, parameters_take_what_they_allow_and_refuse_the_rest_by_name) {
  const auto technique = entry().make();
  for (Parameter* p : technique->parameters()) {
    std::vector<std::string> values = p->probes();
    values.push_back(p->default_text());
    for (const std::string& value : values) {
      p->set(value);
      EXPECT_EQ(p->text(), value) << p->name();
      p->set(p->text());
      EXPECT_EQ(p->text(), value) << p->name();
    }
    for (const char* value : {"nonsense", "1e300", "-1e300"}) {
      try {
        p->set(value);
        ADD_FAILURE() << p->name() << " took " << value;
      } catch (const Error& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find(fmt::format("{}.{} = {} is outside {}", entry().id, p->name(), value, p->allowed())),
                  std::string::npos)
            << text;
      }
      EXPECT_EQ(p->text(), p->default_text()) << p->name() << " changed by a value that it refused";
    }
  }
  EXPECT_THROW(technique->apply("no_such_parameter=1"), Error);
}

// For every kind of light a fresh object answers: full, or why not. An area light is no exception.
TEST_P(WithoutGl, says_whether_it_supports_every_kind_of_light_and_why_not) {
  for (const char* reference : {"sphere_over_plane:segments=16", "box_city:count=12", "single_triangle"}) {
    const Scene scene = load_scene(reference);
    for (const Light& light : lights_of_all_kinds(scene)) {
      const Support support = this->support(scene, light);
      EXPECT_EQ(support.why().empty(), support.kind() == Support::Kind::full) << reference << ", " << title(light);
      const Support again = this->support(scene, light);
      EXPECT_EQ(support.kind(), again.kind());
      EXPECT_EQ(support.why(), again.why());
    }
  }
}

}  // namespace
}  // namespace conformance
