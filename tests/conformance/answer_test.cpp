// What a technique answers: a mask, the same one twice, and lit where nothing casts.
#include <numeric>

#include "stage.h"

namespace conformance {
namespace {

class Answer : public Every {};
INSTANTIATE_TEST_SUITE_P(technique, Answer, testing::ValuesIn(technique_ids()), id_of);

TEST_P(Answer, is_a_mask_and_the_same_one_twice_under_every_supported_light) {
  for (const char* reference : {"sphere_over_plane:segments=24", "box_city:count=12"}) {
    const auto w = world(reference);
    const GBuffer gbuffer = w->gbuffer();
    for (const Light& light : supported_lights(w->scene)) {
      SCOPED_TRACE(fmt::format("{}, {}", reference, title(light)));
      const auto technique = set_up();
      const std::vector<float> first = answer(*technique, w->scene, light, gbuffer);
      EXPECT_TRUE(is_mask(first, *w, gbuffer, light));
      EXPECT_TRUE(same(first, resolve(*technique, gbuffer))) << "resolve again";
      EXPECT_TRUE(same(first, answer(*technique, w->scene, light, gbuffer))) << "build, relight, resolve again";
      EXPECT_TRUE(same(first, fresh_answer(w->scene, light, gbuffer))) << "another object";
    }
  }
}

TEST_P(Answer, is_one_on_meshes_that_do_not_receive) {
  Scene scene = load_scene("box_city:count=12");
  for (std::size_t m = 1; m < scene.meshes.size(); m += 2) scene.meshes[m].receives = false;
  const auto w = world(std::move(scene));
  const GBuffer gbuffer = w->gbuffer();
  for (const Light& light : supported_lights(w->scene)) {
    SCOPED_TRACE(title(light));
    EXPECT_TRUE(is_mask(fresh_answer(w->scene, light, gbuffer), *w, gbuffer, light));
  }
}

TEST_P(Answer, is_lit_everywhere_when_nothing_casts) {
  Scene scene = load_scene("box_city:count=12");
  for (Mesh& mesh : scene.meshes) mesh.casts = false;
  const auto w = world(std::move(scene));
  const GBuffer gbuffer = w->gbuffer();
  for (const Light& light : supported_lights(w->scene)) {
    SCOPED_TRACE(title(light));
    EXPECT_TRUE(same(fresh_answer(w->scene, light, gbuffer), std::vector<float>(gbuffer.size(), 1.0f)));
  }
}

// The sphere does not cast; the ground does, on nothing: it lies below all that faces the light. A technique of samples may
// find acne there, on one pixel of a hundred.
TEST_P(Answer, is_lit_below_a_mesh_that_does_not_cast) {
  Scene scene = load_scene("sphere_over_plane:segments=24");
  scene.meshes[1].casts = false;
  const auto w = world(std::move(scene));
  const GBuffer gbuffer = w->gbuffer();
  for (const Light& light : supported_lights(w->scene)) {
    SCOPED_TRACE(title(light));
    const auto truth = w->reference(gbuffer, light);
    const std::vector<float> mask = fresh_answer(w->scene, light, gbuffer);
    std::size_t tested = 0, wrong = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (truth.classes[i] != PixelClass::T) continue;
      ASSERT_EQ(truth.mask[i], 1) << "pixel " << i;
      ++tested;
      wrong += mask[i] < 1;
    }
    EXPECT_GT(tested, gbuffer.size() / 10);
    EXPECT_LE(wrong, entry().about.promise == Promise::exact ? 0 : tested / 100);
  }
}

TEST_P(Answer, counts_its_work_and_its_bytes) {
  const auto w = world("box_city:count=12");
  const GBuffer gbuffer = w->gbuffer();
  for (const Light& light : supported_lights(w->scene)) {
    SCOPED_TRACE(title(light));
    const auto technique = set_up();
    answer(*technique, w->scene, light, gbuffer);
    int bytes = 0;
    for (const Count& count : technique->counts()) {
      EXPECT_TRUE(is_plain_name(count.name)) << count.name;
      EXPECT_TRUE(std::isfinite(count.value) && count.value >= 0) << count.name << " = " << count.value;
      bytes += count.name == "bytes";
    }
    EXPECT_EQ(bytes, 1) << "counts named bytes";
  }
}

// Weights of the taps of a pixel sum to 1, and asking changes nothing.
TEST_P(Answer, explains_pixels_without_changing_them) {
  const auto w = world("sphere_over_plane:segments=24");
  const GBuffer gbuffer = w->gbuffer();
  for (const Light& light : supported_lights(w->scene)) {
    SCOPED_TRACE(title(light));
    const auto technique = set_up();
    const std::vector<float> mask = answer(*technique, w->scene, light, gbuffer);
    for (std::size_t i = 0; i < gbuffer.size(); i += 7) {
      const auto why = technique->explain(i);
      if (!why) continue;
      const auto add = [](double sum, const Tap& tap) { return sum + tap.weight; };
      if (!why->taps.empty()) {
        EXPECT_NEAR(std::accumulate(why->taps.begin(), why->taps.end(), 0.0, add), 1, 1e-6) << "pixel " << i;
      }
      for (const Tap& tap : why->taps) EXPECT_NEAR(glm::length(tap.direction), 1, 1e-6) << "pixel " << i;
      EXPECT_TRUE(std::isfinite(why->bias) && why->texel_width >= 0) << "pixel " << i;
    }
    EXPECT_TRUE(same(mask, resolve(*technique, gbuffer)));
  }
}

// On either truth, whatever the technique sees: pictures are of the G-buffer's size and linear RGB, the same when asked twice,
// and leave the answer alone. A layer that is not there is refused by name.
TEST_P(Answer, draws_its_layers_and_refuses_others) {
  for (const Truth truth : {Truth::mesh, Truth::shape}) {
    const World w(load_scene("sphere_over_plane:segments=24"), truth);
    const GBuffer gbuffer = w.gbuffer();
    for (const Light& light : supported_lights(w.scene)) {
      SCOPED_TRACE(title(light));
      const auto technique = set_up();
      const std::vector<float> mask = answer(*technique, w.scene, light, gbuffer);
      for (const DebugLayer& layer : technique->debug_layers()) {
        const std::vector<float> picture = technique->draw_debug(layer.name);
        EXPECT_EQ(picture.size(), 3 * gbuffer.size()) << layer.name;
        EXPECT_TRUE(std::ranges::all_of(picture, [](float v) { return v >= 0 && v <= 1; })) << layer.name;
        EXPECT_TRUE(same(picture, technique->draw_debug(layer.name))) << layer.name;
      }
      EXPECT_TRUE(same(mask, resolve(*technique, gbuffer)));
      for (const char* const unknown : {"no_such_layer", ""}) {
        try {
          technique->draw_debug(unknown);
          ADD_FAILURE() << entry().id << " drew a layer named '" << unknown << "'";
        } catch (const Error& error) {
          EXPECT_NE(std::string(error.what()).find(entry().id), std::string::npos) << error.what();
        }
      }
    }
  }
}

}  // namespace
}  // namespace conformance
