// The answers of a technique: a valid mask, repeatable, and lit where nothing casts.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "measure/conformance/motion_world.h"
#include "measure/conformance/trial.h"
#include "measure/scene/load.h"

namespace gnomon::conformance {
namespace {

void same_mask(Trial& trial) {
  for (const char* reference : {"sphere_over_plane:segments=24", "box_city:count=12"})
    trial.under_each_light(reference, [&](const World& w, const GBuffer& gbuffer, const Light& light) {
      const auto technique = trial.set_up();
      const std::vector<float> first = trial.answer(*technique, w.scene, light, gbuffer);
      trial.expect_mask(first, w.scene, gbuffer, light);
      trial.expect_same(first, trial.resolve(*technique, gbuffer), "resolve again", &gbuffer);
      technique->update(w.scene, no_changes(w.scene));
      technique->relight(light);
      trial.expect_same(first, trial.resolve(*technique, gbuffer), "update where nothing moved, relight, resolve", &gbuffer);
      trial.expect_same(first, trial.answer(*technique, w.scene, light, gbuffer), "build, relight, resolve again", &gbuffer);
      trial.expect_same(first, trial.fresh_answer(w.scene, light, gbuffer), "another object", &gbuffer);
    });
}

void lit_where_nothing_receives(Trial& trial) {
  Scene scene = generated_scene("box_city:count=12");
  for (std::size_t m = 1; m < scene.meshes.size(); m += 2) scene.meshes[m].receives = false;
  trial.at("box_city:count=12, of which every other mesh does not receive");
  trial.under_each_light(trial.world(std::move(scene)), [&](const World& w, const GBuffer& gbuffer, const Light& light) {
    trial.expect_mask(trial.fresh_answer(w.scene, light, gbuffer), w.scene, gbuffer, light);
  });
}

void lit_without_casters(Trial& trial) {
  Scene scene = generated_scene("box_city:count=12");
  for (Mesh& mesh : scene.meshes) mesh.casts = false;
  trial.at("box_city:count=12, of which no mesh casts");
  trial.under_each_light(trial.world(std::move(scene)), [&](const World& w, const GBuffer& gbuffer, const Light& light) {
    trial.expect_same(trial.fresh_answer(w.scene, light, gbuffer), std::vector<float>(gbuffer.size(), 1.0f),
                      "its mask, and one of ones", &gbuffer);
  });
}

// The sphere does not cast. The ground casts on nothing: it is below all that faces the light. A sampled technique may have
// acne there, on one pixel of a hundred.
void lit_below_no_caster(Trial& trial) {
  Scene scene = generated_scene("sphere_over_plane:segments=24");
  scene.meshes[1].casts = false;
  trial.at("sphere_over_plane:segments=24, of which the sphere does not cast");
  const auto w = trial.world(std::move(scene));
  const GBuffer gbuffer = w->gbuffer();
  for (const Light& light : trial.supported_lights(w->scene)) {
    trial.at(light);
    const auto truth = w->reference(gbuffer, light);
    const std::vector<float> mask = trial.fresh_answer(w->scene, light, gbuffer);
    std::size_t tested = 0, wrong = 0, first = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (truth.classes[i] != PixelClass::T) continue;
      if (truth.mask[i] != 1) return trial.found("the reference itself is not lit there", i, gbuffer);
      ++tested;
      if (!is_lit(mask[i]) && wrong++ == 0) first = i;
    }
    const std::size_t most = trial.entry().about.promise == Promise::exact ? 0 : tested / 100;
    if (wrong > most)
      trial.found(fmt::format("{} of {} tested pixels are dark; {} may be", wrong, tested, most), first, gbuffer);
  }
}

void counts(Trial& trial) {
  trial.under_each_light("box_city:count=12", [&](const World& w, const GBuffer& gbuffer, const Light& light) {
    const auto technique = trial.set_up();
    trial.answer(*technique, w.scene, light, gbuffer);
    int bytes = 0;
    for (const Count& count : technique->counts()) {
      trial.expect(is_plain_name(count.name), fmt::format("the count's name '{}' is no plain name", count.name));
      trial.expect(std::isfinite(count.value) && count.value >= 0, fmt::format("the count {} is {}", count.name, count.value));
      bytes += count.name == "bytes";
    }
    trial.expect(bytes == 1, fmt::format("{} counts are named bytes, not 1", bytes));
  });
}

// Weights of the taps of a pixel sum to 1, and explain changes nothing.
void explanations(Trial& trial) {
  trial.under_each_light("sphere_over_plane:segments=24", [&](const World& w, const GBuffer& gbuffer, const Light& light) {
    const auto technique = trial.set_up();
    const std::vector<float> mask = trial.answer(*technique, w.scene, light, gbuffer);
    for (std::size_t i = 0; i < gbuffer.size(); i += 7) {
      const auto why = technique->explain(i);
      if (!why) continue;
      const auto add = [](double sum, const Tap& tap) { return sum + tap.weight; };
      const double sum = std::accumulate(why->taps.begin(), why->taps.end(), 0.0, add);
      if (!why->taps.empty() && !(std::abs(sum - 1) <= 1e-6))
        trial.found(fmt::format("the weights of its taps sum to {}, not 1", sum), i, gbuffer);
      for (const Tap& tap : why->taps)
        if (!(std::abs(glm::length(tap.direction) - 1) <= 1e-6))
          trial.found(fmt::format("a tap's direction is {} long, not 1", glm::length(tap.direction)), i, gbuffer);
      if (!(std::isfinite(why->bias) && why->texel_width >= 0))
        trial.found(fmt::format("its bias is {}, its texel width {}", why->bias, why->texel_width), i, gbuffer);
    }
    trial.expect_same(mask, trial.resolve(*technique, gbuffer), "resolve after explain", &gbuffer);
  });
}

/// Calls check(technique, gbuffer) with a technique that has just answered, in a scene with curved shapes, under each light
/// that it supports and either truth, whatever it sees. `check` must not change its answer.
template <class Check>
void ask_answered(Trial& trial, const char* asked, const Check& check) {
  const char* const reference = "sphere_over_plane:segments=24";
  for (const Truth truth : {Truth::mesh, Truth::shape}) {
    trial.at(reference);
    auto world = std::make_unique<World>(generated_scene(reference), truth);
    trial.under_each_light(std::move(world), [&](const World& w, const GBuffer& gbuffer, const Light& light) {
      const auto technique = trial.set_up();
      const std::vector<float> mask = trial.answer(*technique, w.scene, light, gbuffer);
      check(*technique, gbuffer);
      trial.expect_same(mask, trial.resolve(*technique, gbuffer), fmt::format("resolve after {}", asked), &gbuffer);
    });
  }
}

void check_unknown_layers(Trial& trial, const Technique& technique) {
  for (const char* const unknown : {"no_such_layer", ""}) {
    try {
      technique.draw_debug(unknown);
      trial.found(fmt::format("it drew a layer named '{}'", unknown));
    } catch (const Error& error) {
      trial.expect(std::string_view(error.what()).find(trial.entry().id) != std::string_view::npos,
                   fmt::format("a layer that is not there is refused without the technique's name: {}", error.what()));
    }
  }
}

// Pictures are of the G-buffer's size and linear RGB, and the same when drawn twice. A layer that is not there is refused by
// name.
void debug_layers(Trial& trial) {
  ask_answered(trial, "draw_debug", [&](const Technique& technique, const GBuffer& gbuffer) {
    for (const DebugLayer& layer : technique.debug_layers()) {
      const std::vector<float> picture = technique.draw_debug(layer.name);
      trial.expect(picture.size() == 3 * gbuffer.size(),
                   fmt::format("layer {} has {} floats, not {}", layer.name, picture.size(), 3 * gbuffer.size()));
      trial.expect(std::ranges::all_of(picture, [](float v) { return v >= 0 && v <= 1; }),
                   fmt::format("layer {} has colors outside 0 .. 1", layer.name));
      trial.expect_same(picture, technique.draw_debug(layer.name), fmt::format("layer {} drawn again", layer.name));
    }
    check_unknown_layers(trial, technique);
  });
}

// A technique that has the picture under one supported light has it under every one.
void global_pictures(Trial& trial) {
  int with = 0, without = 0;
  ask_answered(trial, "global_picture", [&](const Technique& technique, const GBuffer& gbuffer) {
    const auto picture = technique.global_picture();
    ++(picture ? with : without);
    if (!picture) return;
    trial.expect(picture->size() == 3 * gbuffer.size(),
                 fmt::format("the global picture has {} floats, not {}", picture->size(), 3 * gbuffer.size()));
    const auto wrong = std::ranges::find_if_not(*picture, [](float v) { return v >= 0 && std::isfinite(v); });
    if (wrong != picture->end()) trial.found(fmt::format("the global picture has a radiance of {}", *wrong));
    for (std::size_t k = 0; k < std::min(picture->size(), 3 * gbuffer.size()); ++k)
      if (gbuffer.is_background(k / 3) && (*picture)[k] != 0)
        trial.found(fmt::format("the background sends a radiance of {}", (*picture)[k]), k / 3, gbuffer);
    trial.expect_same(*picture, technique.global_picture().value_or(std::vector<float>()), "the global picture again");
  });
  if (with == 0) return trial.does_not_apply("it gives no global picture");
  trial.expect(without == 0, fmt::format("it gives a global picture under {} of {} lights", with, with + without));
}

}  // namespace

std::vector<Rule> answer_rules() {
  return {Rule("same_mask", same_mask, {.has_small_pictures = true},
               "Under every supported light it writes every pixel of the mask: a number from 0 to 1, and 1 where nothing faces "
               "the light. Repeating a stage, update where nothing moved, repeating all stages, and another object give the "
               "same mask bit for bit.",
               "Write every pixel, 1 where faces_light() says no. What differs from call to call comes from memory that is not "
               "set, from work that an earlier call left half done, or from the order of threads. Random numbers come from a "
               "seed parameter.",
               "Write every pixel, 1 where it does not face the light. What differs from request to request comes from "
               "memory that is not set, from work that an earlier request left half done, or from the order of threads. "
               "Random numbers come from a [[parameter]] named seed."),
          Rule("lit_where_nothing_receives", lit_where_nothing_receives, {.has_small_pictures = true},
               "It writes a valid mask where some meshes do not receive shadows.",
               "Leave meshes with receives = false lit and keep looking at the others."),
          Rule("lit_without_casters", lit_without_casters, {.has_small_pictures = true},
               "Where no mesh casts, every pixel is exactly 1.",
               "Leave meshes with casts = false out of build and relight, and see that empty lists and buffers are no special "
               "case."),
          Rule("lit_below_no_caster", lit_below_no_caster, {.sanitized = Sanitized::nothing},
               "A mesh that does not cast throws no shadow: no tested pixel behind it is dark if the technique promises to be "
               "exact, at most one of a hundred otherwise.",
               "Look for acne on the ground, and for casts = false that is forgotten."),
          Rule("counts", counts, {.has_small_pictures = true},
               "Counts have plain names and values from 0 on, and exactly one is named bytes.",
               "Return {\"bytes\", N, \"byte\"} from counts(), with all that the object holds after resolve.",
               "Look at counts in the answers to stages. Without bytes among them, bytes is the growth of the process."),
          Rule("explanations", explanations, {.has_small_pictures = true},
               "The explanation of a pixel is well formed: weights of taps sum to 1, directions have length 1, the bias is "
               "finite. Asking for it changes no answer.",
               "Look at explain(): divide the weights by their sum, normalize directions, and let it only read.",
               "Look at the answer to explain: divide the weights by their sum, normalize directions, and change nothing "
               "that a later request reads."),
          Rule("debug_layers", debug_layers, {.has_small_pictures = true},
               "Every debug layer is a picture of three numbers from 0 to 1 for each pixel, the same when drawn twice, under "
               "both truths. Drawing it changes no answer. A layer that does not exist is refused with the technique's name.",
               "Size the picture by the last G-buffer, clamp what is a color, and end draw_debug with "
               "Technique::draw_debug(layer), which words the refusal.",
               "A program has no debug layers: what is found comes from a stage before."),
          Rule("global_picture", global_pictures, {.has_small_pictures = true},
               "A global picture has three finite numbers >= 0 for each pixel, and 0 at background. It is the same when made "
               "twice, under both truths and every supported light, and changes no answer.",
               "Size the picture by the last G-buffer, and let global_picture() only read what resolve has found.",
               "A program gives no global picture: what is found comes from a stage before.")};
}

}  // namespace gnomon::conformance
