// Sequences of frames: what a technique that remembers may take from the frames before, and that no other takes anything.
#include <gnomon/kit/bases/light_objects.h>

#include "measure/conformance/sequence.h"

namespace gnomon::conformance {
namespace {

using Masks = std::vector<std::vector<float>>;  ///< of each frame

/// A fresh object that has built where frame k is.
std::unique_ptr<Technique> built(const Trial& trial, Sequence& sequence, std::size_t k = 0) {
  sequence.go_to(k);
  auto technique = trial.set_up();
  technique->build(sequence.scene());
  return technique;
}

/// Its next frame, under any light.
std::vector<float> next_frame(const Trial& trial, const Sequence& sequence, Technique& technique, const Changes& changes,
                              const Light& light, std::size_t k) {
  if (!changes.empty()) technique.update(sequence.scene(), changes);
  technique.relight(light);
  return trial.resolve_next(technique, sequence.gbuffer(k));
}

std::vector<float> next_frame(const Trial& trial, Sequence& sequence, Technique& technique, std::size_t k) {
  const Changes changes = sequence.go_to(k);
  return next_frame(trial, sequence, technique, changes, sequence.light(k), k);
}

Masks all_frames(const Trial& trial, Sequence& sequence, Technique& technique) {
  Masks masks;
  for (std::size_t k = 0; k < Sequence::frame_count; ++k) masks.push_back(next_frame(trial, sequence, technique, k));
  return masks;
}

/// Calls check(sequence) under two lights.
template <class Check>
void in_each_sequence(Trial& trial, const Check& check) {
  const auto [world, lights] = supported_world(trial);
  std::size_t checked = 0;
  if (!lights.empty()) trial.at(world->scene().name);
  for (const Light& light : two_lights(trial, lights)) {
    Sequence sequence(trial, *world, light);
    if (!sequence.is_supported()) continue;
    trial.at(light);
    check(sequence);
    ++checked;
  }
  if (checked == 0) trial.does_not_apply("it supports no light of the scenes that move");
}

void forget_begins_anew(Trial& trial) {
  in_each_sequence(trial, [&](Sequence& sequence) {
    const Masks fresh = all_frames(trial, sequence, *built(trial, sequence));
    const auto used = built(trial, sequence);
    trial.begin(*used);
    for (const std::size_t k : {5u, 2u, 4u}) next_frame(trial, sequence, *used, k);
    trial.begin(*used);
    const Masks again = all_frames(trial, sequence, *used);
    for (std::size_t k = 0; k < Sequence::frame_count; ++k)
      trial.expect_same(again[k], fresh[k], fmt::format("frame {} after forget, and of a fresh object", k),
                        &sequence.gbuffer(k));
  });
}

/// Objects of two lights that share what build makes: each has the frames that a whole object has.
void sequences_that_share(Trial& trial) {
  const SupportedWorld found = supported_world(trial);
  const std::vector<Light>& lights = found.lights;
  if (lights.size() < 2) return;
  MovingWorld& world = *found.world;
  LightObjects objects(trial.entry(), with_small_pictures(trial.entry(), ""));  // these are not made by the trial
  objects.hold(2);
  if (!objects.shares().value_or(false)) return;
  Sequence sequences[] = {Sequence(trial, world, lights[0]), Sequence(trial, world, lights[1])};
  if (!sequences[0].is_supported() || !sequences[1].is_supported()) return;
  Masks alone[2];
  for (const std::size_t l : {0u, 1u}) alone[l] = all_frames(trial, sequences[l], *built(trial, sequences[l]));
  sequences[0].go_to(0);
  objects.each(Stage::setup, [](Technique& object, std::size_t) { object.setup(); });
  objects.each(Stage::build, [&](Technique& object, std::size_t) { object.build(world.scene()); });
  for (std::size_t k = 0; k < Sequence::frame_count; ++k) {
    const Changes changes = sequences[0].go_to(k);
    if (!changes.empty())
      objects.each(Stage::update, [&](Technique& object, std::size_t) { object.update(world.scene(), changes); });
    objects.each(Stage::relight, [&](Technique& object, std::size_t l) { object.relight(sequences[l].light(k)); });
    for (const std::size_t l : {1u, 0u}) {
      trial.at(lights[l]);
      trial.expect_same(trial.resolve_next(objects[l], sequences[0].gbuffer(k)), alone[l][k],
                        fmt::format("frame {} of an object that shares with another one, and of a whole one", k),
                        &sequences[0].gbuffer(k));
    }
  }
}

// Two objects go on in turn. From frame 3 on one is under another light; neither learns of the other.
void frames_before_decide(Trial& trial) {
  constexpr std::size_t parting = 3;
  in_each_sequence(trial, [&](Sequence& sequence) {
    const Masks alone = all_frames(trial, sequence, *built(trial, sequence));
    const auto same = built(trial, sequence), other = built(trial, sequence);
    for (std::size_t k = 0; k < Sequence::frame_count; ++k) {
      const Changes changes = sequence.go_to(k);
      const bool is_equal = k < parting;
      const std::vector<float> first = next_frame(trial, sequence, *other, changes, sequence.light(is_equal ? k : 0), k);
      if (is_equal)
        trial.expect_same(first, alone[k], fmt::format("frame {} of two sequences that are equal up to frame 2", k),
                          &sequence.gbuffer(k));
      trial.expect_same(next_frame(trial, sequence, *same, changes, sequence.light(k), k), alone[k],
                        fmt::format("frame {}, alone and beside another sequence", k), &sequence.gbuffer(k));
    }
  });
  sequences_that_share(trial);
}

// `same_mask`, `change_of_light`, `change_of_view` and `update_equals_build` compare answers that follow great changes. What
// an object keeps from frame to frame while it is still near, shows after small ones.
void no_memory_undeclared(Trial& trial) {
  in_each_sequence(trial, [&](Sequence& sequence) {
    const auto used = built(trial, sequence);
    std::vector<float> first;
    for (std::size_t k = 0; k < Sequence::frame_count; ++k) {
      const std::vector<float> mask = next_frame(trial, sequence, *used, k);
      if (k == 0) first = mask;
      if (k < 2) continue;  // nothing has changed, as in same_mask
      const auto fresh = built(trial, sequence, k);
      fresh->relight(sequence.light(k));
      trial.expect_same(mask, trial.resolve_next(*fresh, sequence.gbuffer(k)),
                        fmt::format("frame {} of a sequence, and alone", k), &sequence.gbuffer(k));
    }
    trial.expect_same(next_frame(trial, sequence, *used, 0), first, "back at frame 0, and there at first",
                      &sequence.gbuffer(0));
  });
}

// Frame 12 shows what frame 2 showed, and so do the frames before them.
void bytes_of_frames(Trial& trial) {
  constexpr std::size_t early = 2, late = 12, period = 5;
  in_each_sequence(trial, [&](Sequence& sequence) {
    const auto technique = built(trial, sequence);
    double before = 0;
    for (std::size_t n = 0; n <= late; ++n) {
      next_frame(trial, sequence, *technique, n % period);
      if (n == early) before = counted_bytes(technique->counts());
    }
    const double after = counted_bytes(technique->counts());
    trial.expect(after <= before, fmt::format("it holds {} bytes after frame {} and {} after frame {}, which shows the same",
                                              before, early, after, late));
  });
}

}  // namespace

std::vector<Rule> sequence_rules() {
  return {
      Rule(
          "forget_begins_anew", forget_begins_anew,
          {.applies_to = AppliesTo::remembering, .has_small_pictures = true, .sanitized = Sanitized::part},
          "After forget its frames are those of a fresh object, bit for bit, whatever came before, also where light, camera and "
          "vertices move.",
          "Let forget drop all that resolve keeps: masks, moments, lengths, the G-buffer and the view of the frame before, the "
          "number of the frame, the light that it compares with."),
      Rule(
          "frames_before_decide", frames_before_decide,
          {.applies_to = AppliesTo::remembering, .has_small_pictures = true, .sanitized = Sanitized::part},
          "Sequences that are equal up to a frame have the same masks up to it, bit for bit, whatever follows, and whatever "
          "sequences other objects have at the same time.",
          "Keep the number of the frame, the seed and the memory in the object of one light: look for static variables, and for "
          "what objects share by for_another_light.",
          "Keep the number of the frame, the seed and the memory in the process: look for files outside of the "
          "folder that hello names."),
      Rule("no_memory_undeclared", no_memory_undeclared,
           {.applies_to = AppliesTo::not_remembering, .has_small_pictures = true, .sanitized = Sanitized::part},
           "A technique that does not state that it remembers frames answers alike after any other frames, bit for bit, also "
           "where light, camera and vertices have moved a little.",
           "State .remembers = true and drop the memory in forget, or keep no answer from one resolve to the next.",
           "State remembers = true and drop the memory in forget, or keep no answer from one resolve to the next."),
      Rule("bytes_of_frames", bytes_of_frames,
           {.applies_to = AppliesTo::remembering, .has_small_pictures = true, .sanitized = Sanitized::part},
           "The count bytes does not grow with the number of the frame: after frame 12 it is at most that after frame 2.",
           "Hold one memory of the picture's size, or a fixed number of them from the first frame on.")};
}

}  // namespace gnomon::conformance
