// Whether a technique's own account of a pixel explains every error that it makes.
#include "measure/cause/causes.h"

#include <unistd.h>

#include <filesystem>

#include "measure/frame/frame.h"
#include "stage.h"

namespace conformance {
namespace {

/// A frame cache that is there as long as the object.
struct Cache {
  std::filesystem::path path = std::filesystem::temp_directory_path() / fmt::format("gnomon_causes_{}", getpid());
  ~Cache() { std::filesystem::remove_all(path); }
};

class Causes : public Every {};
INSTANTIATE_TEST_SUITE_P(technique, Causes, testing::ValuesIn(technique_ids()), id_of);

/// Under a light with area every pixel that is off at all has a cause, and at most 1 % of the error none that has a name.
void expect_soft_causes(std::span<const Cause> causes, const Reference& truth, std::span<const float> mask,
                        LightShareKind estimates) {
  const std::span<const float> share = estimates == LightShareKind::area ? truth.mask : truth.irradiance;
  double all = 0, unexplained = 0;
  for (std::size_t i = 0; i < causes.size(); ++i) {
    const double error = std::abs(static_cast<double>(mask[i]) - share[i]);
    ASSERT_EQ(causes[i] != Cause::none, truth.classes[i] == PixelClass::T && error > 0) << "pixel " << i;
    if (causes[i] != Cause::none) all += error;
    if (causes[i] == Cause::unexplained) unexplained += error;
  }
  EXPECT_LE(unexplained, 0.01 * all);
}

TEST_P(Causes, every_wrong_pixel_has_a_named_cause) {
  const Cache cache;
  std::size_t tested = 0;
  for (const char* reference : {"box_city:count=30", "soup:count=200", "fence", "contact"}) {
    const Scene scene = load_scene(reference);
    FrameStore frames(scene, cache.path);
    const FrameKey key{scene.views[0], 192, 108, entry().about.sees};
    const GBuffer gbuffer = frames.gbuffer(key);
    for (const Light& light : scene.lights) {
      if (!support(scene, light)) continue;
      SCOPED_TRACE(fmt::format("{}, {}", reference, title(light)));
      const auto technique = set_up();
      const std::vector<float> mask = answer(*technique, scene, light, gbuffer);
      const Reference truth = frames.reference(key, light);
      const auto explain = [&](std::span<const std::uint32_t> pixels) {
        std::vector<std::optional<Explanation>> explanations;
        for (const std::uint32_t pixel : pixels) explanations.push_back(technique->explain(pixel));
        return explanations;
      };
      const LightShareKind estimates = entry().about.estimates;
      const auto causes = find_causes({scene, frames.casters(key.truth), gbuffer, light, truth, mask, {}, explain, estimates});
      ++tested;
      if (has_area(light)) {
        expect_soft_causes(causes, truth, mask, estimates);
        continue;
      }
      for (std::size_t i = 0; i < causes.size(); ++i) {
        const bool is_wrong = truth.classes[i] == PixelClass::T && std::abs(mask[i] - truth.mask[i]) > 0.5f;
        ASSERT_EQ(causes[i] != Cause::none, is_wrong) << "pixel " << i;
        ASSERT_NE(causes[i], Cause::unexplained) << "at x = " << i % 192 << ", y = " << i / 192;
      }
    }
  }
  if (tested == 0) GTEST_SKIP() << "supports no light of these scenes";
}

}  // namespace
}  // namespace conformance
