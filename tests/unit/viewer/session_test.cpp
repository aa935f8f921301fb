// What keys and scripts make of the parameters of sides and scene, and how the sides are named.
#include "app/viewer/session.h"

#include <gtest/gtest.h>

#include "app/viewer/side_names.h"
#include "error_words.h"
#include "measure/scene/load.h"

namespace session_test {

using namespace gnomon;
using namespace gnomon::viewer;
namespace error_words = gnomon::error_words;

/// What the window opens with on a scene.
Selection opening(const std::string& scene, const std::string& left, const std::string& right) {
  const auto side = [](const std::string& text) {
    const std::size_t colon = text.find(':');
    return SideSelection{text.substr(0, colon), colon == std::string::npos ? "" : text.substr(colon + 1), ""};
  };
  Selection selection;
  selection.scene = scene;
  selection.sides = {side(left), side(right)};
  return selection;
}
std::shared_ptr<const LoadedScene> loaded(const std::string& scene) {
  return std::make_shared<LoadedScene>(LoadedScene{scene, load_scene(scene)});
}
Session session_on(const std::string& scene, const std::string& left, const std::string& right) {
  return Session(opening(scene, left, right), loaded(scene));
}

constexpr const char* ball = "sphere_over_plane";

TEST(viewer_session, keys_reach_every_parameter_of_both_sides_and_of_the_scene) {
  Session session = session_on(ball, "shadow_map", "stencil_volume");
  std::vector<std::string> wanted;
  const auto add = [&](const std::string& prefix, const Parametrized& object) {
    for (const Parameter* const row : object.parameters()) wanted.push_back(prefix + std::string(row->name()));
  };
  add("left.", session.technique(0));
  add("right.", session.technique(1));
  add("scene.", *session.generator());
  EXPECT_EQ(session.parameter_names(), wanted);
  for (const std::string& name : wanted) {
    session.act(ParameterSteps{.rows = 1});
    EXPECT_EQ(session.chosen_parameter(), name);
    EXPECT_TRUE(session.message().starts_with(name + " = ")) << session.message();
    // And changes it, there or back.
    const auto state = [&] {
      return session.selection().sides[0].settings + '|' + session.selection().sides[1].settings + '|' +
             session.selection().scene;
    };
    const std::string before = state();
    session.act(ParameterSteps{.values = 1});
    const std::string up = state();
    session.act(ParameterSteps{.values = -1});
    session.act(ParameterSteps{.values = -1});
    EXPECT_TRUE(up != before || state() != before) << name;
  }
  session.act(ParameterSteps{.rows = 1});
  EXPECT_EQ(session.chosen_parameter(), wanted.front()) << "after the last comes the first";
  session.act(ParameterSteps{.rows = -1});
  EXPECT_EQ(session.chosen_parameter(), wanted.back());
}

TEST(viewer_session, a_step_says_the_value_and_what_is_allowed) {
  Session session = session_on(ball, "shadow_map", "embree_rays");
  session.act(ParameterSteps{.values = 1});
  EXPECT_EQ(session.selection().sides[0].settings, "") << "the first press only chooses";
  EXPECT_EQ(session.message(), "left.resolution = 1024 (64 .. 8192 texel)");
  session.act(ParameterSteps{.values = 1});
  EXPECT_EQ(session.message(), "left.resolution = 2048 (64 .. 8192 texel)");
  EXPECT_EQ(session.selection().sides[0].settings, "resolution=2048");
  EXPECT_TRUE(session.selection().is_moving) << "frames are small while it goes on";
  // What was chosen goes with its technique; then keys begin anew.
  session.choose_technique(0, "embree_rays");
  session.act(ParameterSteps{.rows = 1});
  EXPECT_EQ(session.chosen_parameter(), session.parameter_names().front());
}

TEST(viewer_session, a_held_key_makes_whole_steps_of_parts) {
  Session session = session_on(ball, "shadow_map:resolution=64", "embree_rays");
  session.act(ParameterSteps{.rows = 1});
  const ParameterSteps up{.values = 1};
  for (int k = 0; k < 3; ++k) session.act(up, 0.3);
  EXPECT_EQ(session.selection().sides[0].settings, "resolution=64");
  session.act(up, 0.3);
  EXPECT_EQ(session.selection().sides[0].settings, "resolution=128");
  session.act(up, 2.5);
  EXPECT_EQ(session.selection().sides[0].settings, "resolution=512");
  session.act(ParameterSteps{.values = -1});
  EXPECT_EQ(session.selection().sides[0].settings, "resolution=256") << "a pressed key is a whole step";
}

TEST(viewer_session, a_script_sets_parameters_by_the_names_of_their_controls) {
  Session session = session_on(ball, "shadow_map", "stencil_volume");
  session.follow(ParameterSetting{"left.resolution", "777"});
  session.follow(ParameterSetting{"scene.radius", "0.5"});
  EXPECT_EQ(session.selection().sides[0].settings, "resolution=777");
  EXPECT_EQ(session.selection().scene, "sphere_over_plane:radius=0.5");
  const Parameter& right = *session.technique(1).parameters().front();
  session.follow(ParameterSetting{"right." + std::string(right.name()), right.probes().back()});
  EXPECT_EQ(right.text(), right.probes().back());
  using error_words::error_of, error_words::expect_words;
  const auto refusal = [&](const std::string& name, const std::string& value) {
    return error_of([&] { session.follow(ParameterSetting{name, value}); });
  };
  expect_words(refusal("left.resolutoin", "5"), {"shadow_map has no parameter resolutoin", "did you mean resolution?"});
  expect_words(refusal("left.resolution", "5"), {"shadow_map.resolution = 5 is outside 64 .. 8192 texel"});
  expect_words(refusal("resolution", "512"), {"there is no parameter resolution", "left.", "right.", "scene."});
  EXPECT_EQ(session.selection().sides[0].settings, "resolution=777") << "what is refused changes nothing";
}

TEST(viewer_session, a_script_is_checked_as_far_as_it_goes_before_a_window_opens) {
  const auto refusal = [](const std::string& keys) {
    return error_words::error_of(
        [&] { check_script(key_table().parse(keys), opening(ball, "shadow_map", "embree_rays"), loaded(ball)); });
  };
  EXPECT_EQ(refusal("9 left.resolution=512 v Ctrl+S scene.radius=1"), "");
  error_words::expect_words(refusal("v left.resolution=5"), {"left.resolution=5: ", "5 is outside 64 .. 8192 texel"});
  EXPECT_EQ(refusal("Tab right.resolution=512 W = Tab left.resolution=64"), "") << "the sides are swapped by then";
  error_words::expect_words(refusal("Tab left.resolution=512"), {"embree_rays has no parameter resolution"});
  // K opens composite, which has an object and no radius of its own name.
  EXPECT_EQ(refusal("K scene.object=sphere"), "");
  error_words::expect_words(refusal("scene.object=sphere"), {"sphere_over_plane has no parameter object"});
}

TEST(viewer_session, settings_are_in_a_name_where_they_are_not_the_default_or_differ) {
  const auto names = [](const std::string& left, const std::string& right) {
    const Session session = session_on(ball, left, right);
    return std::pair(title_of(session, 0), title_of(session, 1));
  };
  const std::string map(registry().technique("shadow_map").about.title), rays(registry().technique("embree_rays").about.title);
  using Names = std::pair<std::string, std::string>;
  EXPECT_EQ(names("shadow_map", "embree_rays"), Names(map, rays));
  EXPECT_EQ(names("shadow_map:resolution=512,filter=pcf", "embree_rays"), Names(map + ", resolution=512, filter=pcf", rays));
  // Of the same technique the default is told, too, where the other side has another value.
  EXPECT_EQ(names("shadow_map", "shadow_map:resolution=512"), Names(map + ", resolution=1024", map + ", resolution=512"));
  EXPECT_EQ(names("shadow_map:filter=pcf", "shadow_map:filter=pcf"), Names(map + ", filter=pcf", map + ", filter=pcf"));
  EXPECT_EQ(names("shadow_map", "shadow_map"), Names(map, map));
}

}  // namespace session_test
