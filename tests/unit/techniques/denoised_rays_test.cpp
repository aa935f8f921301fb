// Denoised rays as a technique: sequences of frames, what memory does, and the terms of its errors.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "soft_world.h"
#include "walking_world.h"

namespace denoised_rays_test {
using namespace gnomon;

std::unique_ptr<Technique> made(const std::string& settings, const Scene& scene) {
  return walking_world::made("denoised_rays", settings, scene);
}

/// The next frame of a sequence.
std::vector<float> frame(Technique& technique, const Light& light, const GBuffer& gbuffer) {
  technique.relight(light);
  return small_world::mask_of(technique, gbuffer);
}

/// What the terms say at each pixel together, and apart over all pixels.
struct Terms {
  std::vector<double> sum;
  std::map<std::string, double, std::less<>> size;

  explicit Terms(const std::vector<ErrorTerm>& terms) {
    for (const ErrorTerm& term : terms) {
      sum.resize(term.values.size());
      double& all = size[std::string(term.cause)];
      for (std::size_t i = 0; i < sum.size(); ++i) {
        sum[i] += term.values[i];
        all += std::abs(term.values[i]);
      }
    }
  }
};

Light lamp(float x, float half = 0.5f) {
  return {.name = "lamp", .kind = RectLight{{x, 4, 0.5f}, {half, 0, 0}, {0, 0, half}, Emits::on_both_sides}};
}

/// A row that walks for four frames, while its camera and its lamp move, too.
struct MovingRow {
  walking_world::Row row{"walk", walking_world::walking_scene(), 40};
  Light light;
  GBuffer gbuffer;

  void go_to(int number, Technique& technique) {
    row.go_to(number);
    if (number > 0) technique.update(row.scene, row.posed.take_changes());
    light = lamp(0.25f * static_cast<float>(number));
    View view = row.scene.views[0];
    view.eye.x += 0.125f * static_cast<float>(number);
    gbuffer = small_world::make_gbuffer(row.scene, view, 40, 30);
  }
};

void expect_terms(const Technique& technique, const MovingRow& at, const std::vector<float>& mask,
                  const std::vector<float>& exact, const std::vector<ErrorTerm>& terms, const std::string& where) {
  const Terms all(terms);
  ASSERT_EQ(all.sum.size(), mask.size()) << where;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!faces_light(at.row.scene, at.gbuffer, at.light, i)) {
      EXPECT_EQ(all.sum[i], 0) << where << ", pixel " << i;
      continue;
    }
    const double difference = static_cast<double>(mask[i]) - exact[i];
    EXPECT_NEAR(all.sum[i], difference, 1e-6) << where << ", pixel " << i;
    if (i % 17 != 0 || std::abs(difference) < 1e-4) continue;
    const auto along = [&](const ErrorTerm& term) { return difference < 0 ? -term.values[i] : term.values[i]; };
    const auto largest = std::ranges::max_element(terms, {}, along);
    EXPECT_EQ(technique.explain(i)->cause, largest->cause) << where << ", pixel " << i;
  }
}

TEST(DenoisedRays, terms_add_up_to_the_error_whatever_moves) {
  for (const char* filter : {"width", "svgf", "tiles", "none"})
    for (const char* memory : {"off", "accumulate", "clamp", "accumulate,on_change=keep", "accumulate,on_change=drop"})
      for (const char* division : {"sums", "pixel"}) {
        MovingRow at;
        const std::string settings = fmt::format("filter={},division={},memory={},rays=2,alpha=0.25", filter, division, memory);
        const auto technique = made(settings, at.row.scene), truth = walking_world::made("exact_area", "", at.row.scene);
        for (int number = 0; number < 4; ++number) {
          at.go_to(number, *technique);
          truth->build(at.row.scene);
          const std::vector<float> exact = frame(*truth, at.light, at.gbuffer), mask = frame(*technique, at.light, at.gbuffer);
          const std::vector<ErrorTerm> terms = technique->error_terms(exact);
          const std::string where = fmt::format("{}, frame {}", settings, number);
          expect_terms(*technique, at, mask, exact, terms, where);
          Terms all(terms);
          EXPECT_EQ(all.sum, Terms(technique->error_terms(exact)).sum) << where << ", asked again";
          const bool remembers = std::string_view(memory) != "off";
          if (number == 0 || !remembers) {
            EXPECT_EQ(all.size["stale_history"], 0) << where;
            EXPECT_EQ(all.size["disocclusion"], 0) << where;
          }
          if (std::string_view(division) == "sums") {
            EXPECT_EQ(all.size["bias"], 0) << where;
          }
          if (std::string_view(filter) == "none") {
            EXPECT_NEAR(all.size["over_blur"], 0, 1e-4) << where;
          }
          if (std::string_view(memory) == "accumulate,on_change=drop") {
            EXPECT_LT(all.size["stale_history"], 1e-3) << where;
          }
        }
        at.row.posed.go_to(std::nullopt);
      }
}

TEST(DenoisedRays, whoever_did_not_see_the_frames_before_has_no_terms) {
  MovingRow at;
  const auto technique = made("memory=accumulate", at.row.scene);
  at.go_to(0, *technique);
  frame(*technique, at.light, at.gbuffer);
  const std::vector<float> mask = frame(*technique, at.light, at.gbuffer);
  EXPECT_TRUE(technique->error_terms(mask).empty());
  technique->forget();
  frame(*technique, at.light, at.gbuffer);
  EXPECT_EQ(technique->error_terms(mask).size(), 5u);
}

TEST(DenoisedRays, a_sequence_after_forget_is_that_of_a_fresh_object) {
  for (const char* settings : {"memory=off", "memory=off,pattern=r2", "memory=accumulate,filter=svgf,pattern=sobol,rays=3",
                               "memory=clamp,filter=tiles,pattern=white", "memory=accumulate,division=pixel"}) {
    MovingRow at;
    const auto used = made(settings, at.row.scene), fresh = made(settings, at.row.scene);
    at.go_to(0, *used);
    for (int number = 0; number < 3; ++number) frame(*used, lamp(-1), at.gbuffer);
    used->forget();
    for (int number = 0; number < 3; ++number) {
      const Light light = lamp(0.25f * static_cast<float>(number));
      EXPECT_EQ(frame(*used, light, at.gbuffer), frame(*fresh, light, at.gbuffer)) << settings << ", frame " << number;
    }
  }
}

TEST(DenoisedRays, an_object_for_another_light_answers_as_one_of_its_own) {
  MovingRow at;
  const auto first = made("memory=clamp,rays=2", at.row.scene), own = made("memory=clamp,rays=2", at.row.scene);
  const auto guest = first->for_another_light();
  ASSERT_TRUE(guest);
  at.go_to(0, *first);
  for (int number = 0; number < 3; ++number) {
    frame(*first, lamp(-1), at.gbuffer);
    EXPECT_EQ(frame(*guest, lamp(1), at.gbuffer), frame(*own, lamp(1), at.gbuffer)) << number;
  }
}

TEST(DenoisedRays, frames_ask_other_places) {
  MovingRow at;
  const auto technique = made("filter=none", at.row.scene);
  at.go_to(0, *technique);
  const std::vector<float> first = frame(*technique, at.light, at.gbuffer);
  EXPECT_NE(first, frame(*technique, at.light, at.gbuffer));
}

/// A ground and a box on it under a lamp, with the exact shares of irradiance.
const soft_world::World& soft() {
  static const soft_world::World world = [] {
    Scene scene;
    scene.meshes = {small_world::ground(4), small_world::box({-0.8f, 0, -0.5f}, {0.6f, 1.5f, 0.4f})};
    return soft_world::World(scene, soft_world::lamp(2));
  }();
  return world;
}

struct Errors {
  double mean = 0, rms = 0;
};
Errors errors(const std::vector<float>& mask, const soft_world::World& world) {
  Errors all;
  int count = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (world.truth.classes[i] != PixelClass::T) continue;
    const double off = mask[i] - world.truth.irradiance[i];
    all.mean += std::abs(off);
    all.rms += off * off;
    ++count;
  }
  return {all.mean / count, std::sqrt(all.rms / count)};
}

// An exponential mean of 0.05 leaves 1 / 6.24 of independent noise, and evenly spread places leave less: 0.085 of it in a
// straight penumbra.
TEST(DenoisedRays, memory_of_still_frames_leaves_a_seventh_of_the_noise) {
  const soft_world::World& world = soft();
  const auto technique = made("filter=none,memory=accumulate,alpha=0.05", world.scene);
  const double at_first = errors(frame(*technique, world.light, world.gbuffer), world).rms;
  std::vector<float> mask;
  for (int number = 1; number < 64; ++number) mask = frame(*technique, world.light, world.gbuffer);
  EXPECT_GT(at_first, 0.05);
  EXPECT_LT(errors(mask, world).rms, 0.15 * at_first);
}

TEST(DenoisedRays, still_frames_never_get_worse) {
  const soft_world::World& world = soft();
  for (const char* filter : {"width", "svgf", "tiles", "none"})
    for (const char* memory : {"accumulate", "clamp"}) {
      const auto technique = made(fmt::format("filter={},memory={}", filter, memory), world.scene);
      const double at_first = errors(frame(*technique, world.light, world.gbuffer), world).mean;
      std::vector<float> mask;
      for (int number = 1; number < 64; ++number) mask = frame(*technique, world.light, world.gbuffer);
      EXPECT_LE(errors(mask, world).mean, 1.05 * at_first) << filter << ' ' << memory;
    }
}

// Noise of one ray has a deviation of 1/2 in the middle of a penumbra; a mean over a Gaussian of sigma pixels leaves 1 / (2
// sqrt(pi) sigma) of it, 0.16 at the 1.8 pixels of a penumbra of 12 and 0.36 at the 0.8 pixels of one of 3.4.
TEST(DenoisedRays, the_filter_by_width_takes_noise_off) {
  const soft_world::World& world = soft();
  const auto error_of = [&](const char* settings) {
    return errors(frame(*made(settings, world.scene), world.light, world.gbuffer), world);
  };
  EXPECT_LT(error_of("filter=width").rms, 0.6 * error_of("filter=none").rms);
}

// A square lamp of half side 1, one meter above the ground; at 2 m to the side its nearer half is hidden by a plate right below
// it. Half of its area is seen, and 0.17388 of its irradiance: of f = 1 / r^4, summed over its places. One ray divided by
// itself is a share of the area.
TEST(DenoisedRays, the_ratio_of_sums_is_the_share_of_irradiance) {
  Scene scene;
  scene.meshes = {
      small_world::ground(4),
      small_world::make_mesh({{0, 0.9995f, -1}, {0, 0.9995f, 1}, {1, 0.9995f, 1}, {1, 0.9995f, -1}}, {{0, 1, 2}, {0, 2, 3}})};
  const Light light{.name = "lamp", .kind = RectLight{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, Emits::on_both_sides}};
  const View view{.name = "view", .eye = {2, 0.5f, 0}, .target = {2, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 4};
  const GBuffer gbuffer = small_world::make_gbuffer(scene, view, 64, 64);
  const auto mean_of = [&](const char* settings) {
    double sum = 0;
    for (const float share : frame(*made(settings, scene), light, gbuffer)) sum += share;
    return sum / static_cast<double>(gbuffer.size());
  };
  EXPECT_NEAR(mean_of("filter=width,division=sums"), 0.17388, 0.01);
  EXPECT_NEAR(mean_of("filter=width,division=pixel"), 0.5, 0.02);
  EXPECT_NEAR(mean_of("filter=none"), 0.5, 0.02) << "one ray alone";
}

TEST(DenoisedRays, what_a_jump_of_the_lamp_leaves_is_stale_history) {
  const soft_world::World& world = soft();
  Light moved = world.light;
  std::get<RectLight>(moved.kind).center.x += 2;
  const std::vector<float> before(world.truth.irradiance.begin(), world.truth.irradiance.end()), after = world.seen_of(moved);
  const auto size_after_jump = [&](const char* on_change) {
    const auto technique = made(fmt::format("memory=accumulate,on_change={}", on_change), world.scene);
    for (int number = 0; number < 16; ++number) {
      frame(*technique, world.light, world.gbuffer);
      technique->error_terms(before);
    }
    frame(*technique, moved, world.gbuffer);
    return Terms(technique->error_terms(after)).size;
  };
  auto kept = size_after_jump("keep"), held = size_after_jump("clamp"), dropped = size_after_jump("drop");
  EXPECT_GT(kept["stale_history"], 2 * kept["residual_noise"]);
  EXPECT_LT(held["stale_history"], kept["stale_history"]);
  EXPECT_LT(dropped["stale_history"], 1e-3);
}

TEST(DenoisedRays, bytes_do_not_grow_with_the_number_of_frames) {
  for (const char* memory : {"off", "accumulate", "clamp"})
    for (const char* filter : {"width", "svgf", "tiles", "none"}) {
      MovingRow at;
      const auto technique = made(fmt::format("memory={},filter={}", memory, filter), at.row.scene);
      at.go_to(0, *technique);
      frame(*technique, at.light, at.gbuffer);
      const double first = small_world::value(technique->counts(), "bytes");
      for (int number = 1; number < 6; ++number) frame(*technique, lamp(0.25f * static_cast<float>(number)), at.gbuffer);
      EXPECT_EQ(small_world::value(technique->counts(), "bytes"), first) << memory << ' ' << filter;
    }
}

TEST(DenoisedRays, settings_beyond_their_ranges_are_refused) {
  const auto technique = registry().technique("denoised_rays").make();
  for (const char* settings : {"rays=0", "rays=5", "alpha=0.001", "alpha=1.5", "longest=0", "filter=oidn"})
    EXPECT_THROW(technique->apply(settings), Error) << settings;
  const Light point{.name = "point", .kind = PointLight{{0, 4, 0}}};
  EXPECT_FALSE(technique->supports({}, point, {}));
}

TEST(DenoisedRays, every_layer_is_a_picture) {
  MovingRow at;
  const auto technique = made("memory=accumulate,filter=svgf", at.row.scene);
  for (int number = 0; number < 2; ++number) {
    at.go_to(number, *technique);
    const std::vector<float> mask = frame(*technique, at.light, at.gbuffer);
    technique->error_terms(std::vector<float>(mask.size(), 1.0f));
  }
  for (const DebugLayer& layer : technique->debug_layers()) {
    const std::vector<float> picture = technique->draw_debug(layer.name);
    EXPECT_EQ(picture.size(), 3 * at.gbuffer.size()) << layer.name;
    EXPECT_TRUE(std::ranges::all_of(picture, [](float v) { return v >= 0 && v <= 1; })) << layer.name;
  }
  at.row.posed.go_to(std::nullopt);
}

}  // namespace denoised_rays_test
