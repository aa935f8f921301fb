#include <gnomon/kit/gl/gl_pass.h>
#include <gtest/gtest.h>

#include <numeric>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"
#include "techniques/exponential_variance_map/answer.h"
#include "techniques/moment_map/answer.h"
#include "techniques/variance_map/answer.h"

extern "C" void gnomon_technique_variance_map(gnomon::Registry&);
extern "C" void gnomon_technique_exponential_map(gnomon::Registry&);
extern "C" void gnomon_technique_exponential_variance_map(gnomon::Registry&);
extern "C" void gnomon_technique_moment_map(gnomon::Registry&);

namespace filtered_maps_test {
using namespace gnomon;

class FilteredMaps : public testing::Test {
 protected:
  FilteredMaps() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
};

/// What a shader's answer() says, in float32, for means of a texel and a depth.
template <class Set>
float answer_of(std::string_view source, const std::string& constants, const glm::vec4& mean, float t, const Set& set) {
  const Program program = pass_program("answer", constants + "vec4 mean_here; float t_here;", std::string(source) + R"(
layout(location = 0) out float visibility;
void main() { visibility = answer(mean_here, t_here); })");
  set(program);
  program.set("mean_here", mean);
  program.set("t_here", t);
  VisibilityMask mask(1, 1);
  {
    const StateGuard guard;
    const Framebuffer framebuffer = make_framebuffer();
    glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT0, mask.texture(), 0);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    glViewport(0, 0, 1, 1);
    glUseProgram(program.name());
    draw_full_screen();
  }
  return mask.read()[0];
}

glm::vec4 mean_of_powers(const std::vector<double>& depths) {
  glm::dvec4 sum(0);
  for (const double t : depths) sum += glm::dvec4(t, t * t, t * t * t, t * t * t * t);
  return sum / double(depths.size());
}

float variance_answer(const std::vector<double>& depths, float t, float least_variance) {
  return answer_of(variance_map::answer, "float least_variance;", mean_of_powers(depths), t,
                   [&](const Program& p) { p.set("least_variance", least_variance); });
}

float moment_answer(const std::vector<double>& depths, float t, float moment_bias) {
  const std::string answer =
      std::string(moment_map::answer) + "float answer(vec4 mean, float t) { return least_lit(mean, t); }";
  return answer_of(answer, "float moment_bias;", mean_of_powers(depths), t,
                   [&](const Program& p) { p.set("moment_bias", moment_bias); });
}

// Casters at .1 and .5, half each, and a receiver at .55, in shadow. Mean .3, variance .04: .04 / (.04 + .25^2) = .390244 of
// the light by Chebyshev. Four moments leave .0060 where their share of alpha = 3e-5 is replaced; the matrix is singular but
// for that, and float32 holds it to 2e-4. With three casters at .1, .3, .5: .2991, and .1447, moments leak as well.
TEST_F(FilteredMaps, bounds_of_two_and_three_layers_are_the_known_ones_in_float32) {
  EXPECT_NEAR(variance_answer({0.1, 0.5}, 0.55f, 0), 0.390244, 1e-5);
  EXPECT_NEAR(variance_answer({0.1, 0.3, 0.5}, 0.55f, 0), 0.299065, 1e-5);
  EXPECT_NEAR(moment_answer({0.1, 0.5}, 0.55f, 3e-5f), 0.0060, 2e-4);
  EXPECT_NEAR(moment_answer({0.1, 0.3, 0.5}, 0.55f, 3e-5f), 0.1447, 5e-4);
}

float moment_answer_of_16_bits(const std::vector<double>& depths, float t, float moment_bias) {
  const std::string answer = moment_map::stored(true) + std::string(moment_map::answer) +
                             "float answer(vec4 mean, float t) { return least_lit(from_stored(mean), t); }";
  const glm::dvec4 stored = glm::dvec4(mean_of_powers(depths)) * moment_map::stored_of_moments + moment_map::stored_of_none;
  return answer_of(answer, "float moment_bias;", glm::round(stored * 65535.0) / 65535.0, t,
                   [&](const Program& p) { p.set("moment_bias", moment_bias); });
}

// Of two layers far apart, 0.1 and 0.9, the third point of the bound goes through infinity where t nears the second, and the
// last pivot of the matrix is lost in rounding. All the same the share of the second layer arrives before it, give or take
// what moment_bias moves, to where the bound falls to 0 behind it.
TEST_F(FilteredMaps, moments_of_two_layers_answer_without_a_jump_where_a_root_passes_infinity) {
  constexpr int count = 4096;
  for (const double share : {0.838198, 0.883845, 0.5, 0.1}) {
    const glm::dvec4 powers(0.1, 0.01, 0.001, 0.0001), others(0.9, 0.81, 0.729, 0.6561);
    const Program program = pass_program("answers", "float moment_bias; vec4 mean_here;", std::string(moment_map::answer) + R"(
layout(location = 0) out float visibility;
void main() { visibility = least_lit(mean_here, 0.85 + 0.0499 * gl_FragCoord.x / 4096); })");
    program.set("moment_bias", 3e-5f);
    program.set("mean_here", glm::vec4(share * others + (1 - share) * powers));
    VisibilityMask mask(count, 1);
    {
      const StateGuard guard;
      const Framebuffer framebuffer = make_framebuffer();
      glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT0, mask.texture(), 0);
      glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
      glViewport(0, 0, count, 1);
      glUseProgram(program.name());
      draw_full_screen();
    }
    for (int k = 0; k < count; ++k) {
      const double t = 0.85 + 0.0499 * (k + 0.5) / count;
      ASSERT_NEAR(mask.read()[k], share, 0.005) << t;
    }
  }
}

TEST_F(FilteredMaps, what_16_bits_store_of_moments_gives_them_back) {
  const glm::dmat4 one = moment_map::stored_of_moments * moment_map::moments_of_stored;
  for (int k = 0; k < 16; ++k) EXPECT_NEAR(one[k / 4][k % 4], k / 4 == k % 4 ? 1 : 0, 1e-6);
  // They fill 0 .. 1 for every depth there.
  glm::dvec4 low(1), high(0);
  for (int k = 0; k <= 1000; ++k) {
    const double t = k / 1000.0;
    const glm::dvec4 stored =
        glm::dvec4(t, t * t, t * t * t, t * t * t * t) * moment_map::stored_of_moments + moment_map::stored_of_none;
    low = glm::min(low, stored);
    high = glm::max(high, stored);
  }
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(low[k], 0, 1e-5);
    EXPECT_NEAR(high[k], 1, 1e-5);
    EXPECT_GE(low[k], -1e-7);
    EXPECT_LE(high[k], 1 + 1e-7);
  }
}

// The vectors above with what two and three stores of 16 bits need: moment_bias 1.5e-4, five times as much, leaves five times
// .0060 of the light under two casters. Rounding by 2^-17 moves the answer by less than .003 beside it.
TEST_F(FilteredMaps, sixteen_bits_with_the_bias_they_need_are_near_what_that_bias_leaves) {
  EXPECT_NEAR(moment_answer({0.1, 0.5}, 0.55f, 1.5e-4f), 0.0287, 1e-3);
  EXPECT_NEAR(moment_answer_of_16_bits({0.1, 0.5}, 0.55f, 1.5e-4f), 0.0287, 3e-3);
  EXPECT_NEAR(moment_answer_of_16_bits({0.1, 0.3, 0.5}, 0.55f, 1.5e-4f), moment_answer({0.1, 0.3, 0.5}, 0.55f, 1.5e-4f), 3e-3);
  const glm::vec4 mean(glm::round(mean_of_powers({0.1, 0.5}) * 65535.0f) / 65535.0f);
  const float variance = answer_of(variance_map::answer, "float least_variance;", mean, 0.55f,
                                   [](const Program& p) { p.set("least_variance", 0.0f); });
  EXPECT_NEAR(variance, 0.390244, 2e-4);
}

// A planar caster before a planar receiver: of depths that hold a share s of the receiver, s of the light arrives there,
// exactly.
TEST_F(FilteredMaps, one_caster_over_one_receiver_is_exact) {
  for (const double share : {0.1, 0.25, 0.5, 0.9}) {
    std::vector<double> depths(100, 0.2);
    std::fill_n(depths.begin(), std::size_t(std::lround(100 * share)), 0.7);
    EXPECT_NEAR(variance_answer(depths, 0.7f, 0), share, 1e-4);
    // A share alpha of the moments is other ones: by so much, over the caster's distance squared, may it be off.
    EXPECT_NEAR(moment_answer(depths, 0.7f, 3e-6f), share, 2e-3);
    glm::dvec2 warped(0);
    for (const double t : depths) warped += glm::dvec2(std::exp(20 * t), std::exp(40 * t)) / 100.0;
    const float exponential =
        answer_of("#define COMPONENTS 2\n" + std::string(exponential_variance_map::answer), "vec3 warps;",
                  glm::vec4(warped, 0, 0), 0.7f, [&](const Program& p) { p.set("warps", glm::vec3(20, 0, 0)); });
    EXPECT_NEAR(exponential, share, 1e-3);
  }
}

// Every bound says lit where nothing lies before the point.
TEST_F(FilteredMaps, what_nothing_lies_before_is_lit) {
  for (const float t : {0.0f, 0.3f, 0.5f}) {
    EXPECT_EQ(variance_answer({0.5, 0.9}, t, 1e-7f), 1);
    EXPECT_EQ(moment_answer({0.5, 0.9}, t, 3e-6f), t < 0.5f ? 1 : moment_answer({0.5, 0.9}, t, 3e-6f));
  }
  EXPECT_GT(moment_answer({0.5, 0.9}, 0.5f, 3e-6f), 0.99f);
}

struct Kind {
  std::string name;
  void (*enter)(Registry&);
};
const Kind kinds[] = {{"variance_map", gnomon_technique_variance_map},
                      {"exponential_map", gnomon_technique_exponential_map},
                      {"exponential_variance_map", gnomon_technique_exponential_variance_map},
                      {"moment_map", gnomon_technique_moment_map}};

// A square at height 1 over a ground at 0: one caster over one receiver. Farther from the shadow's edge than the blur reaches,
// pixels are dark or lit but for the exponential's tail exp(-80 d) of a depth step d = 1/4 .. 1/3, and rounding.
TEST_F(FilteredMaps, inside_and_outside_of_a_square_shadow_they_are_right) {
  Scene scene;
  scene.meshes = {small_world::ground(4), small_world::ground(1, 1)};
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {0, 3, 7}, .target = {0, 0, 0}}, 96, 72);
  const Light lights[] = {{.name = "point", .kind = PointLight{{0.5f, 4, 0.25f}}},
                          {.name = "sun", .kind = DirectionalLight{{0.2f, -1, 0.1f}}},
                          {.name = "spot", .kind = SpotLight{{0, 4, 0}, {0, -1, 0}, 30, 50}}};
  for (const Kind& kind : kinds)
    for (const std::string settings :
         {"resolution=512", "resolution=256,blur_weights=gaussian,blur_radius=3", "blur_radius=0", "resolution=512,fit=view"})
      for (const Light& light : lights) {
        const auto run = small_world::run(kind.enter, settings, scene, light, g);
        int dark = 0, wrong = 0, asked = 0;
        for (std::size_t i = 0; i < g.size(); ++i) {
          if (!faces_light(scene, g, light, i)) continue;
          const auto why = *run.technique->explain(i);
          double sum = 0, reach = 0;
          for (const Tap& tap : why.taps) sum += tap.weight;
          reach = 6 * std::sqrt(2.0) * why.texel_width;
          if (!why.taps.empty()) {
            EXPECT_NEAR(sum, 1, 1e-5) << kind.name;
          }
          // The nearest edge of the shadow, by asking around the point.
          bool is_near = false;
          const bool is_dark = small_world::caster_distance(scene, light, g.position(i)) < INFINITY;
          for (int k = 0; k < 16 && !is_near; ++k) {
            const glm::dvec3 aside(std::cos(k * 0.3927) * reach, 0, std::sin(k * 0.3927) * reach);
            if (g.mesh[i] == 0)
              is_near = (small_world::caster_distance(scene, light, glm::dvec3(g.position(i)) + aside) < INFINITY) != is_dark;
          }
          if (is_near || g.mesh[i] != 0) continue;
          ++asked;
          dark += is_dark;
          wrong += std::abs(run.mask[i] - (is_dark ? 0 : 1)) > 0.05;
        }
        EXPECT_GT(dark, 50) << kind.name << ' ' << light.name;
        EXPECT_GT(asked - dark, 300) << kind.name << ' ' << light.name;
        EXPECT_LE(wrong, asked / 200) << kind.name << ' ' << settings << ' ' << light.name;
      }
}

}  // namespace filtered_maps_test
