// Radiosity as a technique: rooms whose light is known, direct light against rays and paths, what it refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "device/context.h"
#include "small_world.h"
#include "techniques/radiosity/lighting.h"

extern "C" void gnomon_technique_radiosity(gnomon::Registry&);
extern "C" void gnomon_technique_path_rays(gnomon::Registry&);
extern "C" void gnomon_technique_exact_area(gnomon::Registry&);

namespace {
using namespace gnomon;
using std::numbers::pi;

class Radiosity : public testing::Test {
 protected:
  Radiosity() { process_context(); }
};

const Light lamp{
    .name = "lamp",
    .kind = RectLight{.center = {0.1f, 1.9f, 0.2f}, .half_u = {0.3f, 0, 0}, .half_v = {0, 0, 0.3f}, .emits = Emits::in_front},
    .intensity = 2};

/// A closed box 2 m wide around the origin's upper side, seen from inside.
Scene room(float reflectance) {
  Scene scene;
  scene.meshes.push_back(small_world::box({-1, 0, -1}, {1, 2, 1}));
  scene.meshes[0].albedo = glm::vec3(reflectance);
  scene.lights = {lamp};
  scene.views = {{.eye = {0.8f, 1, 0.9f}, .target = {-1, 0.2f, -0.8f}, .fov_y_degrees = 70}};
  return scene;
}

struct Lit {
  radiosity::Surfaces surfaces;
  radiosity::Hemicube hemicube;
  std::unique_ptr<radiosity::Lighting> lighting;
  Lit(const Scene& scene, const Light& light, radiosity::Settings settings) {
    surfaces.scene = &scene;
    surfaces.faces.emplace(scene);
    surfaces.patches.emplace(*surfaces.faces, settings.patch_size);
    surfaces.casters.emplace(scene, Truth::mesh, RayScene::Which::casters);
    surfaces.all.emplace(scene, Truth::mesh, RayScene::Which::all);
    hemicube.setup();
    lighting = std::make_unique<radiosity::Lighting>(surfaces, light, settings, &hemicube);
  }
};

using radiosity::Bounces;
using radiosity::FormFactor;

TEST_F(Radiosity, of_a_closed_room_is_the_geometric_series) {
  for (const FormFactor way : {FormFactor::contour, FormFactor::rays, FormFactor::hemicube})
    for (const float reflectance : {0.3f, 0.7f}) {
      const Scene scene = room(reflectance);
      const Lit lit(scene, lamp,
                    {.form_factor = way,
                     .patch_size = 0.4,
                     .resolution = 128,
                     .samples = 64,
                     .levels = 0,
                     .contrast = 0.05,
                     .bounces = Bounces::all,
                     .rest = 2e-3});
      const radiosity::Ledger& ledger = lit.lighting->ledger();
      const double emitted = pi * 2 * 4 * 0.3f * 0.3f;
      EXPECT_NEAR(ledger.emitted.x, emitted, 1e-6);
      // All that arrives: what is absorbed is 1 - rho of it.
      EXPECT_NEAR(ledger.absorbed.x / (1 - reflectance) / (emitted / (1 - reflectance)), 1, 0.01) << static_cast<int>(way);
      EXPECT_EQ(ledger.escaped.x, 0);
      const double all = ledger.absorbed.x + ledger.unshot.x + ledger.escaped.x + ledger.defect.x;
      EXPECT_NEAR(all / emitted, 1, 1e-6);
    }
}

/// Form factors of each patch to all others sum to 1 in a closed room.
TEST_F(Radiosity, rows_of_a_closed_room_sum_to_one) {
  const Scene scene = room(0.5f);
  for (const FormFactor way : {FormFactor::contour, FormFactor::hemicube}) {
    Lit lit(scene, lamp,
            {.form_factor = way, .patch_size = 0.25, .resolution = 512, .samples = 16, .levels = 0, .contrast = 0.05});
    for (std::uint32_t side = 1; side < 2 * lit.lighting->division().patch_count(); side += 2)  // 1: the inside
      EXPECT_NEAR(lit.lighting->row_sum(side), 1, 1e-3) << static_cast<int>(way) << " side " << side;
  }
}

/// A node in the origin lies on the border of the floor's two triangles, and its coordinates say nothing of their rounding.
TEST_F(Radiosity, nothing_is_dark_where_nothing_casts) {
  const Scene scene = room(0.5f);
  const GBuffer gbuffer = small_world::make_gbuffer(scene, scene.views[0], 48, 36);
  for (const char* size : {"patch_size=1", "patch_size=0.5", "patch_size=0.25", "patch_size=0.1"})
    for (const float v : small_world::run(gnomon_technique_radiosity, size, scene, lamp, gbuffer).mask) EXPECT_EQ(v, 1);
}

TEST_F(Radiosity, light_that_escapes_is_counted) {
  Scene scene = room(0.5f);
  // Without its ceiling; the lamp shines upward through the hole.
  scene.meshes[0].triangles.erase(scene.meshes[0].triangles.begin() + 6, scene.meshes[0].triangles.begin() + 8);
  finish(scene.meshes[0]);
  Light up = lamp;
  std::get<RectLight>(up.kind).emits = Emits::on_both_sides;
  const Lit lit(scene, up,
                {.patch_size = 0.25, .samples = 16, .levels = 0, .contrast = 0.05, .bounces = Bounces::all, .rest = 1e-3});
  const radiosity::Ledger& ledger = lit.lighting->ledger();
  EXPECT_GT(ledger.escaped.x / ledger.emitted.x, 0.5);
  EXPECT_NEAR((ledger.absorbed.x + ledger.unshot.x + ledger.escaped.x + ledger.defect.x) / ledger.emitted.x, 1, 1e-6);
  EXPECT_LT(std::abs(ledger.defect.x) / ledger.emitted.x, 0.02);
}

double relative_rms(const std::vector<float>& a, const std::vector<float>& b) {
  double difference = 0, all = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += (a[i] - b[i]) * (a[i] - b[i]);
    all += b[i] * b[i];
  }
  return std::sqrt(difference / all);
}

/// A room with a box in it, whose pictures of all light, and of light that went on once, are those of random paths.
TEST_F(Radiosity, picture_of_all_light_is_that_of_light_paths) {
  Scene scene = room(0.6f);
  scene.meshes[0].albedo = {0.7f, 0.5f, 0.3f};
  scene.meshes.push_back(small_world::box({-0.6f, 0, -0.6f}, {0, 0.8f, 0}));
  scene.meshes[1].albedo = {0.2f, 0.6f, 0.8f};
  const GBuffer gbuffer = small_world::make_gbuffer(scene, scene.views[0], 48, 36);
  const auto picture = [&](auto* roll, const char* settings) {
    return *small_world::run(roll, settings, scene, lamp, gbuffer).technique->global_picture();
  };
  const auto paths = picture(gnomon_technique_path_rays, "samples=1024");
  EXPECT_LT(relative_rms(picture(gnomon_technique_radiosity, "bounces=all,patch_size=0.08,unshot=0.005"), paths), 0.03);
  EXPECT_LT(relative_rms(picture(gnomon_technique_radiosity, "bounces=all,patch_size=0.1,form_factor=rays,samples=64"), paths),
            0.08);
  EXPECT_LT(
      relative_rms(picture(gnomon_technique_radiosity, "bounces=all,patch_size=0.1,form_factor=hemicube,hemicube=128,levels=0"),
                   paths),
      0.08);
  const auto once = picture(gnomon_technique_path_rays, "samples=1024,ending=bounces,bounces=1");
  EXPECT_LT(relative_rms(picture(gnomon_technique_radiosity, "bounces=1,patch_size=0.08,unshot=0.002"), once), 0.03);
  const auto direct = picture(gnomon_technique_path_rays, "samples=1024,ending=bounces,bounces=0");
  EXPECT_LT(relative_rms(picture(gnomon_technique_radiosity, "patch_size=0.08"), direct), 0.03);
}

/// Mean difference from exact shares of the area: they differ little from those of the irradiance here, where the lamp is
/// small.
double mean_error(const Scene& scene, const Light& light, const GBuffer& gbuffer, const std::string& settings,
                  const std::vector<float>& truth) {
  const std::vector<float> mask = small_world::run(gnomon_technique_radiosity, settings, scene, light, gbuffer).mask;
  double sum = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) sum += std::abs(mask[i] - truth[i]);
  return sum / static_cast<double>(mask.size());
}

Scene table_scene() {
  Scene scene;
  scene.meshes.push_back(small_world::ground(2));
  scene.meshes.push_back(small_world::box({-0.5f, 0.3f, -0.4f}, {0.4f, 0.5f, 0.6f}));
  scene.lights = {{.name = "lamp", .kind = DiscLight{.center = {0.3f, 4, 0.2f}, .radius = 0.3f}}};
  scene.views = {{.eye = {0, 8, 0.1f}, .target = {0, 0, 0}, .fov_y_degrees = 26}};
  return scene;
}

TEST_F(Radiosity, error_falls_with_the_size_of_patches) {
  const Scene scene = table_scene();
  const GBuffer gbuffer = small_world::make_gbuffer(scene, scene.views[0], 80, 80);
  const Light& light = scene.lights[0];
  const std::vector<float> truth = small_world::run(gnomon_technique_exact_area, "", scene, light, gbuffer).mask;
  const double coarse = mean_error(scene, light, gbuffer, "patch_size=0.1,levels=0,samples=64", truth);
  const double fine = mean_error(scene, light, gbuffer, "patch_size=0.025,levels=0,samples=64", truth);
  EXPECT_GT(std::log(coarse / fine) / std::log(4), 0.8) << coarse << ' ' << fine;
  // Division where shadow edges are does as well as patches that are small everywhere, with fewer elements.
  const double divided = mean_error(scene, light, gbuffer, "patch_size=0.1,levels=2,samples=64", truth);
  EXPECT_LT(divided, 1.2 * fine);
}

TEST_F(Radiosity, says_what_it_cannot_do) {
  Registry registry;
  gnomon_technique_radiosity(registry);
  const auto technique = registry.techniques()[0].make();
  Scene scene = room(1);
  const auto why = [&](const Light& light) { return technique->supports(scene, light, scene.views[0]).why(); };
  EXPECT_EQ(why({.name = "sun", .kind = DirectionalLight{}}),
            "patches of the lamp send the light, and a directional light has no area: it needs a rect, disc or sphere light");
  EXPECT_EQ(why(lamp), "");
  technique->apply("bounces=all");
  EXPECT_EQ(why(lamp), "mesh  reflects 1 of the light: it must be below 1, or light would never be used up");
  scene.meshes[0].albedo = glm::vec3(0.999f);
  EXPECT_EQ(why(lamp), "");
  technique->apply("patch_size=0.002");
  EXPECT_EQ(why(lamp), "patch_size 0.002 makes 3000000 sides of patches; at most 40000 when they hand light on");
}

/// Slivers, needles and patches of all sizes on one another: every value is finite and within 0 .. 1, and nothing hangs.
TEST_F(Radiosity, survives_degenerate_patches) {
  std::mt19937 random(7);
  Scene scene = table_scene();
  scene.meshes.push_back(small_world::random_soup(random, 8, 1, 0, 1, 0.3f));
  scene.meshes.push_back(small_world::make_mesh(
      {{-1, 0.2f, 0}, {1, 0.2f, 0}, {1, 0.2000001f, 1e-6f}, {-1, 0, 0}, {1, 0, 0}, {0, 0, 1e-5f}}, {{0, 1, 2}, {3, 4, 5}}));
  scene.meshes.push_back(scene.meshes[1]);  // twice in the same place
  const GBuffer gbuffer = small_world::make_gbuffer(scene, scene.views[0], 40, 40);
  for (const Light& light : {scene.lights[0], Light{.name = "ball", .kind = SphereLight{{0, 0.4f, 0.1f}, 0.3f}}})
    for (const char* settings :
         {"bounces=all,patch_size=0.3,unshot=0.1", "bounces=all,patch_size=0.4,form_factor=hemicube,hemicube=33,unshot=0.1",
          "bounces=1,patch_size=0.3,form_factor=rays,interpolate=constant"}) {
      const auto run = small_world::run(gnomon_technique_radiosity, settings, scene, light, gbuffer);
      for (const float v : run.mask) EXPECT_TRUE(v >= 0 && v <= 1);
      const std::vector<float> picture = *run.technique->global_picture();
      const auto bad = std::ranges::find_if(picture, [](float v) { return !(std::isfinite(v) && v >= 0); });
      EXPECT_EQ(bad, picture.end()) << *bad << " under " << light.name << " with " << settings;
      for (const Count& count : run.technique->counts()) EXPECT_TRUE(std::isfinite(count.value)) << count.name;
    }
}

}  // namespace
