// Glass that colors the light: the channels of a light are one light of the window, and its picture is in color.
#include "app/viewer/saving.h"
#include "app/viewer/several_lights.h"
#include "composed.h"
#include "glass.h"

namespace colored_test {

using namespace composed_pixels;
using namespace hand_made_frame;

/// A sun and a lamp over a colored pane: six lights.
Scene colored_scene() {
  Scene scene;
  scene.meshes = {glass::with_transmission(hand_made::square(1, 1), glm::vec3(1, 0.5f, 0.25f))};
  scene.lights = {hand_made::sun({0, -1, 0}), hand_made::point_light({0, 3, 0})};
  scene.lights[0].name = "sun";
  scene.lights[1].name = "lamp";
  split_lights(scene);
  return scene;
}

std::vector<std::string> names(const std::vector<Light>& lights) {
  std::vector<std::string> names;
  for (const Light& light : lights) names.push_back(light.name);
  return names;
}
using Names = std::vector<std::string>;

/// The lights of that name, as the window shows them.
Selection selected(const Scene& scene, const std::string& name) {
  const std::vector<Light> lights = lights_named(scene, name);
  Selection selection{.scene = "pane.toml", .light = lights.front()};
  if (lights.size() > 1) selection.together = lights;
  return selection;
}

TEST(viewer_colored, the_list_has_whole_lights_and_their_channels) {
  const Scene scene = colored_scene();
  EXPECT_EQ(names(listed_lights(scene)),
            (Names{"sun", "sun.red", "sun.green", "sun.blue", "lamp", "lamp.red", "lamp.green", "lamp.blue"}));
  EXPECT_EQ(names(lights_named(scene, "lamp")), (Names{"lamp.red", "lamp.green", "lamp.blue"}));
  EXPECT_EQ(names(lights_named(scene, "lamp.green")), (Names{"lamp.green"}));
  EXPECT_EQ(names(lights_named(scene, "moon")), (Names{"sun.red", "sun.green", "sun.blue"}));
  Scene gray = colored_scene();
  gray.lights = whole_lights(gray.lights);
  EXPECT_EQ(names(listed_lights(gray)), (Names{"sun", "lamp"}));
  EXPECT_EQ(names(lights_named(gray, "lamp.green")), (Names{"lamp"}));
}

TEST(viewer_colored, a_moved_light_takes_its_channels_along) {
  const Scene scene = colored_scene();
  Selection selection = selected(scene, "lamp");
  selection.together = scene.lights;
  selection.light.kind = PointLight{{1, 4, 0}};
  const std::vector<Light> lights = lights_of(selection);
  EXPECT_EQ(names(lights), names(scene.lights));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(are_same(lights[k], scene.lights[k])) << k;
  for (std::size_t k = 3; k < 6; ++k) EXPECT_EQ(std::get<PointLight>(lights[k].kind).position, glm::vec3(1, 4, 0)) << k;
}

TEST(viewer_colored, channels_of_a_light_have_its_name) {
  const Scene scene = colored_scene();
  const auto word = [&](std::vector<Light> together) {
    const Selection selection{.scene = "pane.toml", .light = together.front(), .together = together};
    return together_word(selection, scene.lights.size());
  };
  EXPECT_EQ(word(lights_named(scene, "lamp")), "lamp");
  EXPECT_EQ(word(scene.lights), "all+");
  EXPECT_EQ(word({scene.lights[0], scene.lights[1]}), "sun.red+sun.green");
  EXPECT_EQ(word({scene.lights[0], scene.lights[3], scene.lights[4], scene.lights[5]}), "sun.red+lamp");
  EXPECT_EQ(together_word(selected(scene, "sun.red"), scene.lights.size()), "");
}

TEST(viewer_colored, files_and_commands_have_whole_lights) {
  const Scene scene = colored_scene();
  const auto saved = [](Selection selection) {
    selection.view = {.name = "v", .eye = {0, 1, 5}};
    const std::string text = state_toml(selection, "scene.toml"),
                      command = render_command(selection, {}, "scene.toml", "again");
    Names lights;
    for (std::size_t at = 0; (at = text.find("[[light]]\nname = \"", at)) != text.npos;) {
      at += std::string_view("[[light]]\nname = \"").size();
      lights.push_back(text.substr(at, text.find('"', at) - at));
    }
    const std::size_t at = command.find(" --light ") + std::string_view(" --light ").size();
    return std::pair(lights, command.substr(at, command.find(' ', at) - at));
  };
  EXPECT_EQ(saved(selected(scene, "lamp")), std::pair(Names{"lamp"}, std::string("lamp")));
  EXPECT_EQ(saved(selected(scene, "lamp.blue")), std::pair(Names{"lamp"}, std::string("lamp.blue")));
  Selection all = selected(scene, "sun");
  all.together = scene.lights;
  EXPECT_EQ(saved(all), std::pair(Names({"sun", "lamp"}), std::string("all+")));
  // Of the saved scene's six lights these are two.
  all.together = {scene.lights[0], scene.lights[4]};
  EXPECT_EQ(saved(all), std::pair(Names({"sun", "lamp"}), std::string("sun.red+lamp.green")));
}

/// A white ground under the first channels of a sun: of its red all arrives, of its green half, of its blue nothing. `masks`
/// are the answer, by channel.
HandMadeFrame colored_seen(std::vector<std::vector<float>> masks, std::size_t channels = 3) {
  HandMadeFrame seen(2, 1);
  seen.frame->light.name = "sun.red";
  for (std::size_t c = 0; c < channels; ++c) {
    seen.frame->lights.push_back(seen.frame->light);
    seen.frame->lights.back().name = fmt::format("sun.{}", channel_names[c]);
    auto own = std::make_shared<ReferenceState>(*seen.reference);
    own->frame.reset();
    own->mask.assign(2, 1 - 0.5f * static_cast<float>(c));
    seen.reference->lights.push_back(own);
  }
  put_together(*seen.reference);
  seen.answer->masks = std::move(masks);
  ShownMasks shown = shown_together(*seen.frame, seen.frame->gbuffer, seen.answer->masks);
  seen.answer->mask = std::move(shown.mask);
  seen.answer->channels = std::move(shown.channels);
  return seen;
}

Composition colored_left(const HandMadeFrame& seen, Paint paint) {
  Composition c = left_of(seen, paint);
  c.sides[0].channels = spans_of(seen.answer->channels);
  return c;
}

// Ambient 0.25, and 0.75 of the sun: linear 1, 0.25 + 0.75 / 2 = 0.625 and 0.25, whose sRGB bytes are 255, 207 and 137. Masks
// are 255 v + 1/2, rounded down: 255, 128, 0.
TEST(viewer_colored, shaded_and_mask_are_in_color) {
  const HandMadeFrame seen = colored_seen({{1, 1}, {0.5f, 0.5f}, {0, 0}});
  EXPECT_EQ(seen.answer->mask, (std::vector{0.5f, 0.5f}));
  EXPECT_EQ(pixels_of(colored_left(seen, Paint::shaded)), (std::vector<Rgb>{{255, 207, 137}, {255, 207, 137}}));
  EXPECT_EQ(pixels_of(colored_left(seen, Paint::mask)), (std::vector<Rgb>{{255, 128, 0}, {255, 128, 0}}));
  // So is the reference, which the masks are equal to.
  EXPECT_EQ(seen.reference->mask, seen.answer->mask);
  EXPECT_EQ(seen.reference->channels, seen.answer->channels);
}

// Two channels: there is no blue light.
TEST(viewer_colored, a_channel_that_is_not_shown_is_dark) {
  const HandMadeFrame seen = colored_seen({{1, 0}, {0.5f, 1}}, 2);
  EXPECT_EQ(pixels_of(colored_left(seen, Paint::mask)), (std::vector<Rgb>{{255, 128, 0}, {0, 255, 0}}));
  EXPECT_EQ(pixels_of(colored_left(seen, Paint::shaded)), (std::vector<Rgb>{{255, 207, 137}, {137, 255, 137}}));
}

// Too little red and as much too much green: in gray the errors cancel.
TEST(viewer_colored, errors_that_cancel_in_gray_are_errors) {
  const HandMadeFrame seen = colored_seen({{0.75f, 1}, {0.75f, 0.5f}, {0, 0}});
  EXPECT_EQ(seen.answer->mask, seen.reference->mask);
  const auto together = put_together(*seen.answer, *seen.reference, LightShareKind::area, {});
  EXPECT_EQ(std::abs(together->mask[0] - together->reference[0]), 0.25f);
  EXPECT_EQ(together->mask[1], together->reference[1]);
}

TEST(viewer_colored, the_magnifier_says_each_channel) {
  const HandMadeFrame seen = colored_seen({{1, 1}, {0.5f, 0.25f}, {0, 0}});
  const Composition c = colored_left(seen, Paint::shaded);
  const std::vector<PixelFact> facts = pixel_facts(c, 0, 1, 0, nullptr, nullptr);
  const auto found = std::ranges::find(facts, "mask left", &PixelFact::name);
  ASSERT_NE(found, facts.end());
  EXPECT_EQ(found->value, "red 1, green 0.25, blue 0");
}

}  // namespace colored_test
