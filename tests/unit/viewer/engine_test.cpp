// The viewer without its window: what is selected comes, as `gnomon render` would make it, and nothing waits for it.
#include "app/viewer/engine.h"

#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "engine_rig.h"
#include "measure/scene/load.h"

namespace gnomon::viewer::engine_test {

using namespace engine_rig;

// Masks, reference, classes and causes are those of `gnomon render`, where it starts and after camera and light have moved. The
// scene has curved shapes, so that causes need the truth of the mesh too.
TEST(viewer_engine, shows_what_render_makes) {
  TestRig rig;
  rig.open("composite:object=sphere");
  expect_as_rendered(rig.selection, rig.finish());
  rig.selection.view.eye += glm::vec3(0.7f, -0.3f, 0.4f);
  std::get<PointLight>(rig.selection.light.kind).position += glm::vec3(-1, 0.5f, 2);
  rig.selection.sides[0].settings = "resolution=64";
  const EngineState state = rig.finish();
  expect_as_rendered(rig.selection, state);
  EXPECT_GT(state.sides[0].verdict->errors.wrong, 0u);
}

// All lights of a scene with curved shapes, of which one is moved: what stays where it is, is not traced again, and the picture
// of all is still that of render. A depth map does not support the lamp, which has an area: it casts no shadows.
TEST(viewer_engine, shows_what_render_makes_of_several_lights) {
  TestRig rig;
  rig.open("composite:object=sphere");
  rig.selection.together = {rig.selection.light,
                            {.name = "moon", .kind = DirectionalLight{{1, -2, 0.5f}}, .intensity = 0.5f},
                            {.name = "lamp", .kind = SphereLight{{-2, 5, 1}, 0.5f}}};
  rig.selection.width = 80;
  rig.selection.height = 45;
  for (const float moved : {0.0f, 1.0f}) {
    std::get<PointLight>(rig.selection.light.kind).position.x += moved;
    const EngineState state = rig.finish();
    const MeasuredRow row = rendered(rig.selection, 0);
    const SideState& side = state.sides[0];
    ASSERT_EQ(side.phase, Phase::done) << side.words;
    EXPECT_TRUE(side.is_approximate());
    EXPECT_NE(side.answer->support.why().find("lamp"), std::string::npos) << side.answer->support.why();
    EXPECT_EQ(side.answer->mask, row.together->shown);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(side.answer->masks[k], row.lights[k].answer.mask) << k;
      EXPECT_TRUE(std::ranges::equal(state.reference->lights[k]->mask, row.lights[k].answer.reference.mask)) << k;
    }
    ASSERT_TRUE(side.verdict && side.verdict->has_causes);
    EXPECT_EQ(side.verdict->together->mask, row.together->mask);
    EXPECT_EQ(side.verdict->together->reference, row.together->reference);
    EXPECT_EQ(side.verdict->together->reference_error, row.together->reference_error);
    EXPECT_EQ(side.verdict->together->classes, row.together->classes);
    EXPECT_EQ(side.verdict->together->causes, row.together->causes);
    EXPECT_EQ(state.reference->classes, row.together->classes);
    EXPECT_EQ(side.verdict->errors.error_sum, errors_of(row, rig.selection).error_sum);
    const Evidence evidence = row.together->evidence();
    EXPECT_EQ(side.verdict->received_error, Scoring(evidence).light_error().rms);
    EXPECT_GT(*side.verdict->received_error, 0.01);  // of the lamp, whose shadows are missing
    EXPECT_EQ(state.frame->received, row.together->received);
    EXPECT_EQ(shade(state.frame->scene(), state.frame->gbuffer, state.frame->received, side.answer->mask).rgb,
              shade(state.frame->scene(), row).rgb);
  }
  // One of them alone again.
  rig.selection.together.clear();
  expect_as_rendered(rig.selection, rig.finish());
}

// Error against samples is that of the settings themselves; nothing of the side changes, and the curve goes with the frame that
// it is of. Of n random places the error falls as the square root of n: from 1 to 16 by 4, here by 3 at least.
TEST(viewer_engine, measures_error_against_samples_beside_the_side) {
  TestRig rig;
  rig.open("composite:object=sphere");
  rig.selection.light = {.name = "lamp", .kind = SphereLight{{4, 9, 0}, 2}};
  rig.selection.width = 80;
  rig.selection.height = 45;
  rig.selection.sides[0] = {.technique = "area_rays", .settings = "samples=16,pattern=random", .layer = ""};
  const EngineState before = rig.finish();
  EXPECT_FALSE(before.curve);
  const ErrorCounts& errors = before.sides[0].verdict->errors;
  rig.selection.curve = 1;
  const EngineState after = rig.finish();
  ASSERT_TRUE(after.curve && after.curve->is_complete);
  const SampleCurve& curve = *after.curve;
  EXPECT_EQ(curve.why_not, "");
  ASSERT_GE(curve.samples.size(), 3u);
  for (std::size_t k = 0; k < curve.samples.size(); ++k) EXPECT_EQ(curve.samples[k], std::pow(4, k));
  EXPECT_EQ(curve.error[2], errors.error_sum / static_cast<double>(errors.tested));
  EXPECT_LT(curve.error[2], curve.error[0] / 3);
  EXPECT_EQ(curve.error_floor, before.sides[0].verdict->error_floor);
  EXPECT_EQ(after.sides[0].answer, before.sides[0].answer);
  EXPECT_EQ(after.sides[0].answer_count, before.sides[0].answer_count);
  rig.selection.picked = 7;
  EXPECT_TRUE(rig.finish().curve) << "a pixel that is picked changes nothing";
  std::get<SphereLight>(rig.selection.light.kind).center.x = 3;
  EXPECT_FALSE(rig.finish().curve) << "and it does not come back by itself";
  rig.selection.curve = 2;
  const auto samples = [&] {
    const auto& now = rig.engine().state().curve;
    return now ? now->samples.size() : 0;
  };
  rig.engine().select(rig.selection);
  rig.until([&](const EngineState&) { return samples() > 0; });
  rig.selection.curve = 0;  // in the middle of it
  const EngineState dropped = rig.finish();
  EXPECT_FALSE(dropped.curve);
  EXPECT_EQ(dropped.sides[0].phase, Phase::done);
}

// A technique that remembers frames tells the parts of its error where it was asked for them in each frame before. Nobody asks
// while the light moves on; the first frame of a sequence, which another size begins, has none before it.
TEST(viewer_engine, says_where_the_parts_of_an_error_are_not_known) {
  TestRig rig;
  rig.open("box_city:count=12");
  rig.selection.light = {.name = "lamp", .kind = SphereLight{{4, 9, 0}, 2}};
  rig.selection.width = 80;
  rig.selection.height = 45;
  rig.selection.sides[0] = {.technique = "denoised_rays", .settings = "memory=accumulate", .layer = ""};
  const auto lacks_parts = [&] {
    const EngineState state = rig.finish();
    if (!state.sides[0].verdict || !state.sides[0].verdict->has_causes) throw Error("no causes: {}", state.sides[0].words);
    return state.sides[0].verdict->lacks_parts;
  };
  EXPECT_FALSE(lacks_parts());
  auto answers = rig.finish().sides[0].answer_count;
  for (int k = 0; k < 3; ++k) {
    std::get<SphereLight>(rig.selection.light.kind).center.x -= 0.25f;
    rig.engine().select(rig.selection);
    answers = rig.until([&](const EngineState& s) { return s.sides[0].answer_count > answers; }).sides[0].answer_count;
  }
  EXPECT_TRUE(lacks_parts());
  rig.selection.width = 96;
  EXPECT_FALSE(lacks_parts());
  rig.selection.sides[0] = {.technique = "area_rays", .settings = "", .layer = ""};
  EXPECT_FALSE(lacks_parts()) << "it has no parts";
}

// While the camera moves frames may be smaller; once it rests they are not, and the mask is that of render.
TEST(viewer_engine, full_frames_come_back_at_rest) {
  TestRig rig;
  rig.open("composite:object=cone");
  rig.finish();
  rig.selection.is_moving = true;
  std::uint64_t last = 0;
  for (int k = 0; k < 12; ++k) {
    rig.selection.view.eye.x += 0.05f;
    const std::uint64_t number = rig.engine().select(rig.selection);
    const EngineState state = rig.until([&](const EngineState& s) {
      return s.selection_number == number && s.frame->number > last && s.frame->gbuffer.view.eye == rig.selection.view.eye;
    });
    last = state.frame->number;
    EXPECT_FALSE(state.frame->is_full() && k == 0);
  }
  rig.selection.is_moving = false;
  const EngineState state = rig.finish();
  EXPECT_TRUE(state.frame->is_full());
  expect_as_rendered(rig.selection, state);
}

// A parameter of resolve leaves build and relight alone: their times stay those that they were.
TEST(viewer_engine, redoes_only_what_a_parameter_spoils) {
  const auto technique = registry().technique("shadow_map").make();
  const auto rows = technique->parameters();
  const auto row = std::ranges::find(rows, Stage::resolve, &Parameter::spoils);
  ASSERT_NE(row, rows.end());
  const std::vector<std::string> probes = (*row)->probes();
  const std::string other = probes[0] != (*row)->text() ? probes[0] : probes[1];
  TestRig rig;
  rig.open("composite:object=sphere");
  rig.selection.sides[0].settings = "";
  const EngineState before = rig.finish();
  rig.selection.sides[0].settings = fmt::format("{}={}", (*row)->name(), other);
  const EngineState after = rig.finish();
  const auto &then = before.sides[0].newest_ms, &now = after.sides[0].newest_ms;
  for (const Stage kept : {Stage::setup, Stage::build, Stage::relight})
    EXPECT_EQ(then[static_cast<int>(kept)], now[static_cast<int>(kept)]) << name(kept);
  EXPECT_NE(then[static_cast<int>(Stage::resolve)], now[static_cast<int>(Stage::resolve)]);
  EXPECT_EQ(after.sides[0].answer_count, before.sides[0].answer_count + 1);
  expect_as_rendered(rig.selection, after);
}

TEST(viewer_engine, says_why_a_side_is_unsupported_and_goes_on) {
  TestRig rig;
  rig.open("fence");
  rig.selection.sides[0] = {.technique = "composite_planar", .settings = "", .layer = ""};
  const EngineState state = rig.finish();
  EXPECT_EQ(state.sides[0].phase, Phase::unsupported);
  EXPECT_FALSE(state.sides[0].words.empty());
  EXPECT_EQ(state.sides[1].phase, Phase::done);
  rig.selection.sides[0] = {.technique = "unshadowed", .settings = "", .layer = ""};
  EXPECT_EQ(rig.finish().sides[0].phase, Phase::done);
}

// Who steps through a list and back has given the worker up and needs it again: whether it was at rest or in the middle of
// something, it is interrupted, and that is no failure of the technique.
TEST(viewer_engine, a_technique_left_for_a_moment_comes_back) {
  TestRig rig;
  rig.open("composite:object=sphere");
  rig.finish();
  for (const int ms : {0, 0, 1, 5, 20, 60}) {
    Selection away = rig.selection;
    away.sides[0] = {.technique = "exact_rays", .settings = "", .layer = ""};
    rig.selection.view.eye.x += 0.01f;
    rig.engine().select(rig.selection);
    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
    rig.engine().select(away);
    rig.engine().select(rig.selection);
    const EngineState state = rig.finish();
    EXPECT_EQ(state.sides[0].phase, Phase::done) << ms << " ms: " << state.sides[0].words;
    ASSERT_TRUE(state.sides[0].verdict && state.sides[0].verdict->has_causes);
    EXPECT_EQ(state.sides[0].answer->frame, state.frame);
  }
}

TEST(viewer_engine, a_scene_that_cannot_be_loaded_leaves_the_one_before) {
  TestRig rig;
  rig.open("composite:object=sphere");
  rig.finish();
  rig.selection.scene = "composit";
  const EngineState state = rig.finish();
  EXPECT_NE(state.scene_error.find("did you mean composite"), std::string::npos) << state.scene_error;
  EXPECT_EQ(state.loaded->reference, "composite:object=sphere");
  EXPECT_EQ(state.sides[0].phase, Phase::done);
  rig.open("composite:object=cone");
  EXPECT_EQ(rig.finish().frame->loaded->reference, "composite:object=cone");
}

TEST(viewer_engine, draws_layers_and_explains_the_picked_pixel) {
  TestRig rig;
  rig.open("composite:object=sphere");
  const EngineState plain = rig.finish();
  const auto tested = std::ranges::find(plain.reference->classes, PixelClass::T);
  rig.selection.picked = static_cast<std::uint32_t>(tested - plain.reference->classes.begin());
  rig.selection.sides[0].layer = "map";
  const EngineState state = rig.finish();
  const SideState& side = state.sides[0];
  ASSERT_TRUE(side.layer);
  EXPECT_EQ(side.layer->layer.name, "map");
  EXPECT_EQ(side.layer->rgb.size(), 3u * 160 * 90);
  EXPECT_EQ(side.explained, rig.selection.picked);
  ASSERT_TRUE(side.explanation);
  EXPECT_FALSE(side.explanation->taps.empty());
  rig.selection.sides[0].layer = "";
  rig.selection.picked.reset();
  const EngineState bare = rig.finish();
  EXPECT_FALSE(bare.sides[0].layer);
  EXPECT_FALSE(bare.sides[0].explanation);
}

TEST(viewer_engine, a_picked_pixel_behind_glass_has_the_curve_of_its_texel) {
  TestRig rig;
  rig.open("glass_stack");
  rig.selection.sides[0] = {.technique = "transmittance_map", .settings = "resolution=256", .layer = ""};
  const std::vector<float> mask = rig.finish().sides[0].answer->mask;
  const auto shaded = std::ranges::find_if(mask, [](float v) { return v > 0.05f && v < 0.95f; });
  ASSERT_NE(shaded, mask.end());
  rig.selection.picked = static_cast<std::uint32_t>(shaded - mask.begin());
  const EngineState state = rig.finish();
  EXPECT_EQ(state.sides[0].explained, rig.selection.picked);
  ASSERT_TRUE(state.sides[0].depth_curve);
  EXPECT_EQ(state.sides[0].depth_curve->exact.share.front(), 1);
  EXPECT_LT(state.sides[0].depth_curve->exact.share.back(), 1);
  EXPECT_FALSE(state.sides[1].depth_curve) << "rays hold no curve";
  rig.selection.picked.reset();
  EXPECT_FALSE(rig.finish().sides[0].depth_curve);
}

// Of a stage that takes long, of a technique that tells, the share that is done grows while it lasts.
TEST(viewer_engine, tells_how_far_a_long_stage_has_come) {
  TestRig rig;
  rig.open("cornell_box");
  rig.selection.light = *std::ranges::find(rig.selection.loaded->scene.lights, "ceiling", &Light::name);
#ifdef __SANITIZE_THREAD__  // ten times as slow: the engine would give the stage up after a minute
  constexpr const char* settings = "bounces=all,levels=0,patch_size=0.3";
#else
  constexpr const char* settings = "bounces=all,levels=0,patch_size=0.1";
#endif
  rig.selection.sides[0] = {.technique = "radiosity", .settings = settings, .layer = ""};
  const std::uint64_t number = rig.engine().select(rig.selection);
  std::vector<double> told;
  for (;;) {
    const EngineState state = rig.engine().state();
    if (state.selection_number == number && state.is_finished) break;
    const double share = state.sides[0].progress;
    if (share > 0 && (told.empty() || share != told.back())) told.push_back(share);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_EQ(rig.engine().state().sides[0].phase, Phase::done);
  EXPECT_GT(told.size(), 3u);
  EXPECT_LT(told.front(), 0.9);
}

// An engine that is let go in the middle of its work ends at once, with its workers and its files.
TEST(viewer_engine, ends_in_the_middle_of_work) {
  for (const int ms : {0, 30, 150, 600}) {
    const auto start = Clock::now();
    {
      TestRig rig;
      rig.open("soup");
      rig.selection.width = 960;
      rig.selection.height = 540;
      rig.selection.sides[0] = {.technique = "exact_rays", .settings = "", .layer = ""};
      rig.engine().select(rig.selection);
      std::this_thread::sleep_for(std::chrono::milliseconds(ms));
    }
    EXPECT_LT(Clock::now() - start, seconds(20));
  }
}

}  // namespace gnomon::viewer::engine_test
