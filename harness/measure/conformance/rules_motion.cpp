// Scenes that move: after updates a technique answers as after a build.
#include <gnomon/kit/bases/light_objects.h>
#include <gnomon/kit/random.h>

#include <algorithm>
#include <cmath>

#include "measure/conformance/motion_world.h"
#include "measure/conformance/trial.h"

namespace gnomon::conformance {
namespace {

/// The largest About::update_error that a technique may state.
constexpr float most_update_error = 1e-5f;
constexpr std::uint64_t seed = 7;

/// Work that a stage counted, without times, which are never the same, memory, and what depends on the shape of a tree.
std::string work_of(const Technique& technique) {
  std::string text;
  for (const Count& c : technique.counts())
    if (c.unit != "ms" && c.unit != "byte" && !c.is_by_tree) text += fmt::format("{} {}; ", c.name, c.value);
  return text;
}

std::string updates_text(int count) { return fmt::format("{} update{}", count, count == 1 ? "" : "s"); }

/// One object that follows a world under one light from frame 0 on.
class Follower {
 public:
  Follower(Trial& trial, MovingWorld& world, const Light& light, const Light& other)
      : trial_(trial), world_(world), light_(light), other_(other), equality_(trial, world, light), used_(trial.set_up()) {
    world_.go_to(0);
    world_.take_changes();
    first_ = trial_.answer(*used_, world_.scene(), light_, world_.gbuffer());
  }

  /// Goes to a frame and updates; does nothing where the light is unsupported there. At first it is relit in most rounds, in
  /// some after having been under another light, then in every fourth.
  void go_to(int frame) {
    world_.go_to(frame);
    if (!trial_.support(world_.scene(), light_)) return;
    used_->update(world_.scene(), world_.take_changes());
    ++update_count_;
    is_relit_ = update_count_ < 8 ? update_count_ % 4 != 3 : update_count_ % 4 == 0;
    if (!is_relit_) return;
    if (update_count_ % 10 == 2 && trial_.support(world_.scene(), other_)) used_->relight(other_);
    used_->relight(light_);
    if (update_count_ % 8 == 0 || update_count_ == 2) trial_.resolve(*used_, world_.gbuffer());
  }

  /// Compares it with a fresh object at the present frame.
  void compare() {
    if (!trial_.support(world_.scene(), light_)) return;
    const GBuffer& gbuffer = world_.gbuffer();
    const std::string when = fmt::format("after {}, at frame {}", updates_text(update_count_), world_.frame());
    if (!is_relit_) used_->relight(light_);
    is_relit_ = true;
    const std::vector<float> mask = trial_.resolve(*used_, gbuffer);
    const auto fresh = trial_.set_up();
    const std::vector<float> built = trial_.answer(*fresh, world_.scene(), light_, gbuffer);
    trial_.expect_mask(mask, world_.scene(), gbuffer, light_);
    equality_.expect(mask, built, when + ", and built there");
    const double bytes = counted_bytes(used_->counts()), fewest = counted_bytes(fresh->counts());
    trial_.expect(bytes <= fewest, fmt::format("{}: it holds {} bytes, a fresh object {}", when, bytes, fewest));
    used_->relight(light_);
    equality_.expect(trial_.resolve(*used_, gbuffer), built, when + ", relit once more, and built there");
    const std::string work = work_of(*used_), whole = work_of(*fresh);
    trial_.expect(work == whole, fmt::format("{}: relit once more it counts {}a fresh object {}", when, work, whole));
  }

  /// Back where it was built.
  void end() {
    world_.go_to(0);
    used_->update(world_.scene(), world_.take_changes());
    used_->relight(light_);
    const std::string when = fmt::format("after {}, back at frame 0, and built there", updates_text(update_count_ + 1));
    equality_.expect(trial_.resolve(*used_, world_.gbuffer()), first_, when);
  }

 private:
  Trial& trial_;
  MovingWorld& world_;
  const Light &light_, &other_;
  Equality equality_;
  std::unique_ptr<Technique> used_;
  std::vector<float> first_;
  int update_count_ = 0;
  bool is_relit_ = true;
};

/// Frames in any order. Every fourth is one in which a light, a triangle or a mesh is where few techniques expect it, and every
/// tenth the one before again, in which nothing moved.
class Walk {
 public:
  int next() {
    static constexpr int hard[] = {MovingWorld::collapsed_frame, MovingWorld::inside_frame, MovingWorld::gone_frame,
                                   MovingWorld::touched_frame};
    ++count_;
    if (count_ % 10 == 0) return frame_;
    frame_ = count_ % 4 == 1 ? hard[count_ / 4 % 4] : static_cast<int>(random_.below(MovingWorld::frame_count));
    return frame_;
  }

 private:
  Random random_{seed};
  int count_ = 0, frame_ = 0;
};

// Under the first light 60 updates, under the second 7, under others one: what differs between lights differs at once.
void follow(Trial& trial, MovingWorld& world, const std::vector<Light>& lights) {
  for (std::size_t k = 0; k < lights.size(); ++k) {
    if (trial.is_short() && k > 0) break;
    trial.at(lights[k]);
    Follower follower(trial, world, lights[k], lights[(k + 1) % lights.size()]);
    Walk walk;
    const int last = k == 0 && !trial.is_short() ? 60 : k <= 1 ? 7 : 1;
    for (int n = 1; n <= last; ++n) {
      follower.go_to(walk.next());
      if (n == 1 || n == 7 || n == 60) follower.compare();
    }
    follower.end();
  }
}

// Objects that share what build makes: update is called on the first alone, each is relit.
void follow_together(Trial& trial, MovingWorld& world, const std::vector<Light>& lights) {
  const std::string settings = with_small_pictures(trial.entry(), "");  // these objects are not made by the trial
  LightObjects objects(trial.entry(), settings);
  objects.hold(lights.size());
  objects.each(Stage::setup, [](Technique& object, std::size_t) { object.setup(); });
  const auto relight = [&] {
    objects.each(Stage::relight, [&](Technique& object, std::size_t l) { object.relight(lights[l]); });
  };
  world.go_to(0);
  world.take_changes();
  objects.each(Stage::build, [&](Technique& object, std::size_t) { object.build(world.scene()); });
  relight();
  for (const int frame : {5, MovingWorld::collapsed_frame, 21}) {
    world.go_to(frame);
    if (!std::ranges::all_of(lights, [&](const Light& l) { return bool(trial.support(world.scene(), l)); })) continue;
    const Changes changes = world.take_changes();
    objects.each(Stage::update, [&](Technique& object, std::size_t) { object.update(world.scene(), changes); });
    relight();
    for (std::size_t l = 0; l < lights.size(); ++l) {
      trial.at(lights[l]);
      Equality(trial, world, lights[l])
          .expect(trial.resolve(objects[l], world.gbuffer()),
                  trial.fresh_answer(world.scene(), lights[l], world.gbuffer(), settings),
                  fmt::format("one of {} objects that follow together, at frame {}, and built there", lights.size(), frame));
    }
  }
}

void update_equals_build(Trial& trial) {
  const float stated = trial.entry().about.update_error;
  trial.expect(stated >= 0 && stated <= most_update_error,
               fmt::format("it states an update_error of {}, outside 0 .. {}", stated, most_update_error));
  const auto [world, lights] = supported_world(trial);
  if (lights.empty()) return trial.does_not_apply("it supports no light of the scenes that move");
  trial.at(world->scene().name);
  follow(trial, *world, lights);
  if (lights.size() > 1) follow_together(trial, *world, {lights[0], lights[1]});
}

}  // namespace

std::vector<Rule> motion_rules() {
  return {
      Rule("update_equals_build", update_equals_build, {.has_small_pictures = true, .sanitized = Sanitized::part},
           "After 1, 7 and 60 updates it answers as a fresh object that builds at the same pose does, bit for bit or within "
           "the update_error that it states, at most 1e-5; back at the first pose as it did there. It then holds no more "
           "bytes than the fresh object. A second relight after an update does its whole work.",
           "Look at what update keeps: it is spoiled by every mesh that moved, also by one that was a point or through "
           "which the light passed. Bring what belongs to one light up to date in relight. Leave update out: then it "
           "builds.")};
}

}  // namespace gnomon::conformance
