// The stochastic map: unbiased for the product of its texels' rays, with less noise than independent samples.
#include <gnomon/kit/gl/gl.h>

#include "glass_stack.h"
#include "techniques/stochastic_map/cover.h"

namespace stochastic_map_test {
using namespace glass_maps_rig;
using namespace glass_stack;
using small_world::value;

constexpr const char* id = "stochastic_map";

struct Spread {
  int count = 0;
  double sum = 0, squares = 0;
  void add(double share) {
    ++count;
    sum += share;
    squares += share * share;
  }
  double mean() const { return sum / count; }
  double deviation() const { return std::sqrt(std::max(0.0, squares / count - mean() * mean())); }
};
double binomial(double share, double samples) { return std::sqrt(share * (1 - share) / samples); }

class StochasticMap : public TestRig {
 protected:
  /// Of the answers on each receiver of the stack.
  static std::array<Spread, 3> spreads(const std::vector<float>& mask, const GBuffer& gbuffer) {
    std::array<Spread, 3> found;
    for_receivers(gbuffer, [&](std::size_t i, std::size_t k) { found[k].add(mask[i]); });
    return found;
  }
};

// Pixels, 45 mm apart, look up texels of their own, 12 mm wide: a mean over N of them is off by more than 4 sd / sqrt(N) once
// in 16,000 times. Were the numbers of triangles those of their mesh, cards would cover the same samples: .5 in place of .375,
// .2 in place of .075.
TEST_F(StochasticMap, is_unbiased_for_the_product_of_cards) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  for (const Light& light : scene.lights)
    for (const int samples : {16, 64}) {
      const auto map = run(id, fmt::format("resolution=256,samples={}", samples), scene, light, gbuffer);
      const std::array<Spread, 3> found = spreads(map.mask, gbuffer);
      for (int k = 0; k < 3; ++k) {
        ASSERT_GT(found[k].count, 300);
        const double most = binomial(left[k], samples);
        EXPECT_NEAR(found[k].mean(), left[k], 4 * most / std::sqrt(found[k].count)) << light.name << ' ' << samples << ' ' << k;
        EXPECT_LT(found[k].deviation(), most) << light.name << ' ' << samples << ' ' << k;
      }
      // One card of 1/2 covers half of the samples of each texel; two and three leave whole numbers of them.
      EXPECT_EQ(found[0].deviation(), 0);
      for_receivers(gbuffer, [&](std::size_t i, std::size_t) {
        EXPECT_EQ(map.mask[i] * static_cast<float>(samples), std::round(map.mask[i] * static_cast<float>(samples)));
      });
    }
}

// Two cards of 1/2, both in one mesh, and each in one of its own: 1/4 behind both.
TEST_F(StochasticMap, tells_triangles_of_a_mesh_and_of_meshes_apart) {
  Scene apart = stack();
  apart.meshes.resize(3);
  Scene together = apart;
  for (const float height : {heights[0], heights[1]}) apart.meshes.push_back(unseen(glass::glass_card(4, height, 0.5f)));
  const Mesh lower = hand_made::square(4, heights[1]);
  Mesh both = hand_made::square(4, heights[0]);
  for (const glm::uvec3& t : lower.triangles) both.triangles.push_back(t + std::uint32_t(both.positions.size()));
  both.positions.insert(both.positions.end(), lower.positions.begin(), lower.positions.end());
  finish(both);
  together.meshes.push_back(unseen(glass::with_transmission(both, glm::vec3(0.5f))));
  for (const Scene& scene : {apart, together}) {
    const GBuffer gbuffer = picture(scene);
    const Spread found = spreads(run(id, "resolution=256", scene, steep_sun, gbuffer).mask, gbuffer)[1];
    EXPECT_NEAR(found.mean(), 0.25, 4 * binomial(0.25, 16) / std::sqrt(found.count)) << scene.meshes.size();
  }
}

TEST_F(StochasticMap, has_the_same_noise_from_run_to_run_and_other_noise_from_another_seed) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  auto map = run(id, "resolution=256", scene, high_point, gbuffer);
  const std::vector<float> first = map.mask;
  answer(map, steep_sun, gbuffer);
  answer(map, high_point, gbuffer);
  EXPECT_EQ(map.mask, first);
  EXPECT_EQ(run(id, "resolution=256", scene, high_point, gbuffer).mask, first);
  EXPECT_NE(run(id, "resolution=256,seed=2", scene, high_point, gbuffer).mask, first);
}

// An edge, a hole or a texel of an opaque card is off by half a texel of some 4 mm, and noise of 64 samples is .06 at most
// where glass is.
TEST_F(StochasticMap, answers_for_holes_textures_and_opaque_cards) {
  const Scene scene = glass_over_ground();
  const GBuffer gbuffer = picture(scene);
  for (const Light& light : {sun, point}) {
    const std::vector<float> truth = decided(scene, light, gbuffer),
                             mask = run(id, "resolution=1024,samples=32", scene, light, gbuffer).mask;
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (!faces_light(scene, gbuffer, light, i)) continue;
      sum += std::abs(mask[i] - truth[i]);
      ++count;
    }
    EXPECT_LT(sum / count, 0.02) << light.name;
  }
}

// Tenths: the nearest one to .375 is right, and so is .1 in place of .075; all others are off by more than 1/20.
TEST_F(StochasticMap, names_noise_where_the_product_would_be_right) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  const auto map = run(id, "resolution=256,samples=10", scene, steep_sun, gbuffer);
  int noisy = 0, misnamed = 0;
  for_receivers(gbuffer, [&](std::size_t i, std::size_t k) {
    const bool is_wrong = std::abs(map.mask[i] - left[k]) > 1.0 / 20;
    noisy += is_wrong;
    misnamed += cause(*map.technique, i) != (is_wrong ? "sample_noise" : "");
  });
  EXPECT_GT(noisy, 100);
  EXPECT_EQ(misnamed, 0);
}

TEST_F(StochasticMap, refuses_samples_that_take_more_than_a_gibibyte) {
  const Scene scene = stack();
  EXPECT_TRUE(support(id, "resolution=4096,samples=16", scene, steep_sun));
  const Support none = support(id, "resolution=4096,samples=17", scene, steep_sun);
  EXPECT_FALSE(none);
  EXPECT_NE(none.why().find("1088 MiB; at most 1024"), std::string::npos) << none.why();
  EXPECT_FALSE(support(id, "resolution=2048,samples=16", scene, high_point));
  EXPECT_TRUE(support(id, "", scene, high_point));
}

TEST_F(StochasticMap, draws_how_many_samples_are_covered) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  const auto map = run(id, "resolution=256", scene, steep_sun, gbuffer);
  ASSERT_EQ(map.technique->debug_layers().back().name, "covered");
  const std::vector<float> picture = map.technique->draw_debug("covered");
  // All three cards, whichever receiver is there: 16 but the one or two that are free, which is the class 9-16.
  const glm::dvec3 color = map.technique->debug_layers().back().legend[5].color;
  int others = 0;
  for_receivers(gbuffer, [&](std::size_t i, std::size_t) { others += picture[3 * i] != static_cast<float>(color.x); });
  EXPECT_EQ(others, 0);
}

// The shader and the processor: the same numbers in, the same samples out.
TEST_F(StochasticMap, covers_in_a_shader_what_the_tests_of_the_cover_check) {
  struct Case {
    std::uint32_t triangle, column, row, image, seed, count;
    float transmission;
    std::uint32_t low, high;  // of the samples that are covered, by the shader
  };
  static_assert(sizeof(Case) == 36);
  constexpr std::uint32_t case_count = 4096;
  Random random(4);
  std::vector<Case> cases(case_count);
  for (Case& one : cases) {
    one = {
        .triangle = random.below(1 << 20), .column = random.below(4096), .row = random.below(4096), .image = random.below(6)};
    one.seed = random.below(1000);
    one.count = 4 + random.below(stochastic_map::most_samples - 3);
    one.transmission =
        random.below(4) == 0 ? static_cast<float>(random.below(5)) / 4 : static_cast<float>(random.uniform(0, 1));
  }
  const StateGuard guard;
  const Program program = Program::compute("cover", std::string(stochastic_map::cover_snippet) + R"(
layout(local_size_x = 64) in;
struct Case { uint triangle, column, row, image, seed, count; float transmission; uint low, high; };
layout(std430, binding = 0) buffer Cases { Case cases[]; };
void main() {
  Case one = cases[gl_GlobalInvocationID.x];
  uint hash = cover_hash(one.triangle, uvec2(one.column, one.row), one.image, one.seed);
  uint low = 0u, high = 0u;
  for (uint item = 0u; item < one.count; ++item) {
    uint bit = covers(hash, one.transmission, item, one.count) ? 1u : 0u;
    if (item < 32u) low |= bit << item; else high |= bit << (item - 32u);
  }
  cases[gl_GlobalInvocationID.x].low = low;
  cases[gl_GlobalInvocationID.x].high = high;
}
)");
  const Buffer buffer(cases.data(), cases.size() * sizeof(Case));
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer.name());
  glUseProgram(program.name());
  glDispatchCompute(case_count / 64, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glGetNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(buffer.bytes), cases.data());
  int different = 0;
  for (const Case& one : cases) {
    const std::uint32_t hash = stochastic_map::hash_of(one.triangle, one.column, one.row, one.image, one.seed);
    std::uint64_t expected = 0;
    for (std::uint32_t s = 0; s < one.count; ++s)
      expected |= std::uint64_t{stochastic_map::covers(hash, one.transmission, s, one.count)} << s;
    different += expected != (std::uint64_t{one.high} << 32 | one.low);
  }
  EXPECT_EQ(different, 0);
}

}  // namespace stochastic_map_test
