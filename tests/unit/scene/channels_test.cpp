// Scenes whose glass colors the light: lights by channel, and the scene that each of them finds.
#include "measure/scene/channels.h"

#include <gnomon/kit/geometry/circling.h>
#include <gtest/gtest.h>

#include "generated_scene.h"
#include "glass.h"
#include "measure/scene/blob.h"
#include "measure/scene/names.h"
#include "measure/scene/posed_scene.h"

namespace channels_test {

using namespace gnomon;

using Names = std::vector<std::string>;

const std::vector<glm::vec2> corners = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};

/// Two texels, of which red is the same in both.
std::shared_ptr<const Transmission> stained() {
  return std::make_shared<const Transmission>(2, 1, 3, std::vector<float>{0.5f, 0.25f, 0.75f, 0.5f, 1, 0},
                                              Transmission::Wrap::mirror, Transmission::Wrap::clamp);
}

/// A ground; two panes of one stained glass; the same glass with holes; a pane of one color; a gray one; gray texels. Lights
/// sun and lamp.
Scene colored_scene() {
  Scene scene;
  for (int height = 0; height < 7; ++height) scene.meshes.push_back(hand_made::square(1, static_cast<float>(height)));
  const auto glass = stained();
  for (const std::size_t m : {1, 2, 3}) scene.meshes[m] = glass::with_transmission(scene.meshes[m], glass, corners);
  scene.meshes[3].alpha_mask = masked::checker(2, 2);
  scene.meshes[4] = glass::with_transmission(scene.meshes[4], {0.9f, 0.18f, 0.09f});
  scene.meshes[5] = glass::with_transmission(scene.meshes[5], glm::vec3(0.5f));
  scene.meshes[6] = glass::with_transmission(scene.meshes[6], glass::texels(2, 1, {0.5f, 1}), corners);
  scene.lights = {hand_made::sun({0, -1, 0}), {.name = "lamp", .kind = RectLight{{0, 9, 0}}, .intensity = 3}};
  scene.views = {{}};
  return scene;
}
/// The same, all glass gray.
Scene gray_scene() { return in_channel(colored_scene(), Channel::red); }

std::vector<float> values(const Mesh& mesh) { return {mesh.transmission->values().begin(), mesh.transmission->values().end()}; }

TEST(channels, a_name_is_split_at_its_last_dot_where_a_channel_follows) {
  EXPECT_EQ(channel_of("sun.red"), Channel::red);
  EXPECT_EQ(channel_of("sun.green"), Channel::green);
  EXPECT_EQ(channel_of("ring_2.blue"), Channel::blue);
  EXPECT_EQ(whole_name("ring_2.blue"), "ring_2");
  for (const char* other : {"sun", "red", "sun_red", "sun.", "sun.re", "sun.redder", "sun.red.2", ""}) {
    EXPECT_FALSE(channel_of(other)) << other;
    EXPECT_EQ(whole_name(other), other);
  }
  for (const Channel channel : all_channels) EXPECT_EQ(channel_of("a." + std::string(name(channel))), channel);
}

TEST(channels, every_light_of_a_colored_scene_is_three_next_to_each_other) {
  const Scene whole = colored_scene();
  Scene scene = whole;
  split_lights(scene);
  EXPECT_EQ(names_of(scene.lights), (Names{"sun.red", "sun.green", "sun.blue", "lamp.red", "lamp.green", "lamp.blue"}));
  for (std::size_t k = 0; k < scene.lights.size(); ++k) {
    const Light &light = scene.lights[k], &before = whole.lights[k / 3];
    EXPECT_EQ(light.kind.index(), before.kind.index()) << light.name;
    EXPECT_EQ(homogeneous_of_center(light), homogeneous_of_center(before)) << light.name;
    EXPECT_EQ(light.intensity, before.intensity) << light.name;
  }
  EXPECT_EQ(scene_bytes(scene_from_bytes(scene_bytes(scene))), scene_bytes(scene)) << "workers read it";
  scene.lights = whole_lights(scene.lights);
  EXPECT_EQ(scene_bytes(scene), scene_bytes(whole)) << "nothing but the lights has changed, and they come back";
}

TEST(channels, lights_of_a_gray_scene_stay_as_they_are) {
  for (const Scene& scene : {gray_scene(), generated::make("single_triangle"), generated::make("glass_stack")}) {
    Scene split = scene;
    split_lights(split);
    EXPECT_EQ(scene_bytes(split), scene_bytes(scene)) << scene.name;
    EXPECT_EQ(names_of(whole_lights(scene.lights)), names_of(scene.lights)) << scene.name;
  }
  // Glass that casts nothing colors nothing.
  Scene idle = colored_scene();
  for (Mesh& mesh : idle.meshes) mesh.casts = false;
  split_lights(idle);
  EXPECT_EQ(names_of(idle.lights), (Names{"sun", "lamp"}));
}

TEST(channels, a_selection_of_channels_is_whole_lights_too) {
  Scene scene = colored_scene();
  split_lights(scene);
  const std::vector<Light> some = {scene.lights[1], scene.lights[3], scene.lights[5]};
  EXPECT_EQ(names_of(whole_lights(some)), (Names{"sun", "lamp"}));
  EXPECT_TRUE(whole_lights({}).empty());
  EXPECT_EQ(whole_count({"sun.green", "lamp.red", "lamp.blue"}), 2u);
  EXPECT_EQ(whole_count(names_of(scene.lights)), 2u);
}

// Texels (0.5, 0.25, 0.75) and (0.5, 1, 0).
TEST(channels, a_scene_in_a_channel_has_that_channel_of_each_glass) {
  const Scene scene = colored_scene();
  const std::vector<float> textured[] = {{0.5f}, {0.25f, 1}, {0.75f, 0}};
  const float constant[] = {0.9f, 0.18f, 0.09f};
  for (const Channel channel : all_channels) {
    const std::size_t c = static_cast<std::size_t>(channel);
    const Scene one = in_channel(scene, channel);
    EXPECT_TRUE(one.has_transmission() && !one.has_colored_transmission()) << name(channel);
    ASSERT_EQ(one.meshes.size(), scene.meshes.size());
    for (const std::size_t m : {1, 2, 3}) EXPECT_EQ(values(one.meshes[m]), textured[c]) << name(channel) << ' ' << m;
    EXPECT_EQ(values(one.meshes[4]), std::vector<float>{constant[c]}) << name(channel);
  }
  const auto green = in_channel(scene, Channel::green).meshes[1].transmission;
  EXPECT_EQ(green->wrap_u(), Transmission::Wrap::mirror);
  EXPECT_EQ(green->wrap_v(), Transmission::Wrap::clamp);
}

TEST(channels, meshes_that_share_glass_share_it_in_a_channel) {
  const Scene one = in_channel(colored_scene(), Channel::green);
  EXPECT_EQ(one.meshes[1].transmission, one.meshes[2].transmission);
  EXPECT_EQ(one.meshes[1].transmission, one.meshes[3].transmission);
  EXPECT_NE(one.meshes[1].transmission, one.meshes[4].transmission);
}

TEST(channels, gray_glass_and_opaque_meshes_are_untouched) {
  const Scene scene = colored_scene(), one = in_channel(scene, Channel::blue);
  EXPECT_FALSE(one.meshes[0].transmission);
  for (const std::size_t m : {5, 6}) EXPECT_EQ(one.meshes[m].transmission, scene.meshes[m].transmission) << "the very object";
  EXPECT_EQ(one.meshes[6].uv, corners);
  EXPECT_EQ(one.meshes[3].alpha_mask, scene.meshes[3].alpha_mask);
  for (std::size_t m = 0; m < one.meshes.size(); ++m) {
    EXPECT_EQ(one.meshes[m].positions, scene.meshes[m].positions) << m;
    EXPECT_EQ(one.meshes[m].triangles, scene.meshes[m].triangles) << m;
    EXPECT_EQ(one.meshes[m].seen, scene.meshes[m].seen) << m;
  }
}

TEST(channels, places_in_a_picture_go_where_nothing_looks_them_up) {
  const Scene scene = colored_scene(), red = in_channel(scene, Channel::red), green = in_channel(scene, Channel::green);
  EXPECT_TRUE(red.meshes[1].uv.empty()) << "red is the same everywhere";
  EXPECT_EQ(red.meshes[3].uv, corners) << "its mask has texels";
  EXPECT_EQ(green.meshes[1].uv, corners);
  // Whole scenes of one channel are files as all others are.
  for (const Scene& one : {red, green}) EXPECT_EQ(scene_bytes(scene_from_bytes(scene_bytes(one))), scene_bytes(one));
}

TEST(channels, a_light_finds_the_scene_in_its_channel_and_it_is_made_once) {
  Scene scene = colored_scene();
  split_lights(scene);
  ChannelScenes scenes(scene);
  for (std::size_t k = 0; k < scene.lights.size(); ++k) {
    const Scene& found = scenes.of(scene.lights[k]);
    EXPECT_NE(&found, &scene) << k;
    EXPECT_EQ(&found, &scenes.of(scene.lights[k])) << k;
    EXPECT_EQ(&found, &scenes.of(scene.lights[(k + 3) % 6])) << "the other light's scene of that channel";
    EXPECT_EQ(scene_bytes(found), scene_bytes(in_channel(scene, all_channels[k % 3]))) << k;
  }
}

TEST(channels, the_scene_of_a_channel_follows_the_pose_at_its_address) {
  Scene scene = colored_scene();
  Motion motion;
  motion.nodes.resize(1);
  motion.animations = {{"rise", {{.node = 0, .times = {0, 1}, .values = {0, 0, 0, 0, 1, 0}}}}};
  motion.rigs = {rig_at_rest(scene, 1, 0), rig_at_rest(scene, 5, 0)};
  scene.motion = std::make_shared<const Motion>(std::move(motion));
  split_lights(scene);
  ChannelScenes scenes(scene);
  const Scene& red = scenes.of(scene.lights[0]);
  const glm::vec3* const place = red.meshes[1].positions.data();
  PosedScene posed(scene);
  for (const double seconds : {0.5, 1.0, 0.0}) {
    posed.go_to(RowPose{.animation = "rise", .seconds = seconds, .frame_rate = 1, .frames = 2});
    EXPECT_EQ(&scenes.of(scene.lights[0]), &red);
    EXPECT_EQ(red.meshes[1].positions.data(), place);
    EXPECT_EQ(red.meshes[1].positions, scene.meshes[1].positions);
    EXPECT_EQ(red.meshes[5].positions[0].y, static_cast<float>(5 + seconds));
    EXPECT_EQ(red.meshes[1].reach.max, glm::vec3(1, 2, 1));
    EXPECT_EQ(red.pose_number, scene.pose_number);
    const Scene& green = scenes.of(scene.lights[1]);
    EXPECT_EQ(green.meshes[1].positions, scene.meshes[1].positions) << "made in this pose, or moved to it";
  }
  posed.go_to(std::nullopt);
  EXPECT_TRUE(scenes.of(scene.lights[0]).meshes[1].reach.empty());
}

TEST(channels, a_light_of_a_gray_scene_finds_the_very_scene) {
  const Scene scene = gray_scene();
  ChannelScenes scenes(scene);
  for (const Light& light : scene.lights) EXPECT_EQ(&scenes.of(light), &scene);
  Light named = scene.lights[0];
  named.name = "sun.red";
  EXPECT_EQ(&scenes.of(named), &scene) << "its glass has no channels";
}

}  // namespace channels_test
