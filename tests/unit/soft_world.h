#pragma once
// Small scenes under a light with area, with a soft reference and a mask to be spoiled, for tests of the causes of soft errors.
#include "cause_world.h"
#include "measure/cause/own_causes.h"
#include "measure/frame/soft_reference.h"

namespace gnomon::soft_world {

/// Seen from straight above as in cause_world: a pixel is 0.129 m of ground.
struct World {
  World(Scene the_scene, Light the_light)
      : scene(std::move(the_scene)), light(std::move(the_light)), casters(scene, Truth::mesh, RayScene::Which::casters) {
    const RayScene everything(scene, Truth::mesh, RayScene::Which::seen);
    gbuffer = make_gbuffer(scene, everything, {.eye = {0, 10, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}}, 64, 64, Truth::mesh);
    truth = trace_soft(scene, casters, gbuffer, light, find_silhouettes(everything, gbuffer), target);
    mask = truth.area;
  }

  /// How much of another light is seen, where the light is.
  std::vector<float> seen_of(const Light& other, std::optional<Scene> among = {}) const {
    std::vector<float> visibility(gbuffer.size());
    if (among)
      trace_shares(RayScene(*among, Truth::mesh, RayScene::Which::casters), scene, gbuffer, other, target, visibility);
    else
      trace_shares(casters, scene, gbuffer, other, target, visibility);
    return visibility;
  }
  Reference reference() const {
    Reference all{truth.area, truth.classes, {}, nullptr};
    all.kind = AnswerKind::fraction;
    all.irradiance = truth.irradiance;
    all.error = truth.area_error;
    all.irradiance_error = truth.irradiance_error;
    return all;
  }
  using Account = std::function<std::optional<Explanation>(std::uint32_t)>;
  std::vector<Cause> causes(const Account& why = nullptr) const {
    const auto explain = [&](std::span<const std::uint32_t> pixels) {
      std::vector<std::optional<Explanation>> all;
      for (const std::uint32_t i : pixels) all.push_back(why(i));
      return all;
    };
    const Reference all = reference();
    Attribution attribution{scene, casters, gbuffer, light, all, mask, right_on_mesh, nullptr};
    if (why) attribution.explain = explain;
    attribution.own_causes = own_causes;
    return find_causes(attribution);
  }
  /// What each cause holds of the error that is more than the reference's own; causes that hold none left out.
  std::map<std::string, double> shares(const Account& why = nullptr) const {
    std::map<std::string, double> sums;
    double all = 0;
    const std::vector<Cause> found = causes(why);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const double error = std::abs(static_cast<double>(mask[i]) - truth.area[i]);
      EXPECT_EQ(found[i] != Cause::none, truth.classes[i] == PixelClass::T && error > 0) << i;
      if (found[i] == Cause::none || found[i] == Cause::reference_error) continue;
      sums[std::string(with_common(own_causes)[static_cast<std::size_t>(found[i]) - 1].name)] += error;
      all += error;
    }
    for (auto& [name, sum] : sums) sum /= all;
    return sums;
  }

  static constexpr AreaTarget target{.error = 0.002, .cap = 16384};
  Scene scene;
  Light light;
  RayScene casters;
  GBuffer gbuffer;
  SoftReference truth;
  std::vector<float> mask;
  std::vector<std::uint8_t> right_on_mesh;
  std::vector<CauseInfo> own_causes;
};

/// A square lamp of side 2 * half, 6 m above `center` of the ground, horizontal.
inline Light lamp(float half, const glm::vec2& center = {0, 0}) {
  return {.name = "lamp", .kind = RectLight{{center.x, 6, center.y}, {half, 0, 0}, {0, 0, half}}};
}

}  // namespace gnomon::soft_world
