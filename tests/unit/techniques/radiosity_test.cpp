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
extern "C" void gnomon_scene_closed_room(gnomon::Registry&);
extern "C" void gnomon_scene_facing_plates(gnomon::Registry&);

namespace radiosity_test {
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
    surfaces.build(scene, settings.patch_size / radiosity::longest_side(scene));
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
      EXPECT_NEAR(ledger.absorbed.x / emitted, 1, 0.01) << static_cast<int>(way);
      EXPECT_EQ(ledger.escaped.x, 0);
      EXPECT_LT(std::abs(ledger.defect.x) / emitted, 0.005) << static_cast<int>(way);
      // All that arrives inside, as pictures have it: of it rho goes on, and so on.
      double arrived = 0;
      for (std::size_t p = 0; p < lit.lighting->division().patch_count(); ++p) {
        const radiosity::Element& patch = lit.lighting->division().elements()[p];
        const double irradiance = lit.lighting->received(patch.center, 1).seen * lit.lighting->exitance() +
                                  lit.lighting->handed_on(patch.center, 1).x + lit.lighting->ambient().x;
        arrived += irradiance * lit.lighting->division().area(patch);
      }
      EXPECT_NEAR(arrived * (1 - reflectance) / emitted, 1, 0.01) << static_cast<int>(way);
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

/// The same a kilometer away, where float32 tells points apart by 60 micrometers: a patch must not hide itself.
TEST_F(Radiosity, rows_sum_to_one_far_from_the_origin) {
  Scene scene = room(0.5f);
  for (glm::vec3& position : scene.meshes[0].positions) position += glm::vec3(1000, 0, -1000);
  Light moved = lamp;
  std::get<RectLight>(moved.kind).center += glm::vec3(1000, 0, -1000);
  Lit lit(scene, moved, {.patch_size = 0.25, .samples = 16, .levels = 0, .contrast = 0.05});
  for (std::uint32_t side = 1; side < 2 * lit.lighting->division().patch_count(); side += 2)
    EXPECT_NEAR(lit.lighting->row_sum(side), 1, 0.01) << " side " << side;
}

/// Two boxes in one mesh, one of them turned inside out: what is seen of both is lit.
TEST_F(Radiosity, winding_takes_no_light_from_a_part) {
  Scene scene;
  Mesh boxes = small_world::box({-1, 0, -0.4f}, {-0.2f, 0.8f, 0.4f});
  const Mesh other = small_world::box({0.2f, 0, -0.4f}, {1, 0.8f, 0.4f});
  const auto first = static_cast<std::uint32_t>(boxes.positions.size());
  boxes.positions.insert(boxes.positions.end(), other.positions.begin(), other.positions.end());
  for (const glm::uvec3& t : other.triangles) boxes.triangles.push_back(first + glm::uvec3(t.x, t.z, t.y));
  finish(boxes);
  EXPECT_TRUE(boxes.facts.closed());
  scene.meshes.push_back(boxes);
  Light above = lamp;
  std::get<RectLight>(above.kind).center = {0, 1.9f, 0};
  scene.views = {{.eye = {0, 4, 0.1f}, .target = {0, 0, 0}, .fov_y_degrees = 40}};
  const GBuffer gbuffer = small_world::make_gbuffer(scene, scene.views[0], 40, 20);
  const auto picture =
      *small_world::run(gnomon_technique_radiosity, "patch_size=0.2", scene, above, gbuffer).technique->global_picture();
  int tops[2] = {};
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (gbuffer.is_background(i) || gbuffer.position(i).y < 0.79f) continue;
    ++tops[gbuffer.position(i).x > 0];
    EXPECT_GT(picture[3 * i], 0) << "pixel " << i;
  }
  EXPECT_GT(std::min(tops[0], tops[1]), 10);
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

/// Where nothing casts a shadow, light is off only by what patches leave out, and falls with them: in a closed room, and
/// between plates that let most of it escape.
TEST_F(Radiosity, error_of_all_light_falls_with_the_size_of_patches) {
  Registry scenes;
  gnomon_scene_closed_room(scenes);
  gnomon_scene_facing_plates(scenes);
  for (const SceneEntry& entry : scenes.scenes()) {
    const Scene scene = entry.make()->make();
    const auto light = std::ranges::find_if(scene.lights, has_area);
    const GBuffer gbuffer = small_world::make_gbuffer(scene, scene.views[0], 32, 18);
    const auto picture = [&](auto* roll, const char* settings) {
      return *small_world::run(roll, settings, scene, *light, gbuffer).technique->global_picture();
    };
    const auto paths = picture(gnomon_technique_path_rays, "samples=4096");
    const double coarse = relative_rms(picture(gnomon_technique_radiosity, "bounces=all,levels=0,patch_size=0.2"), paths);
    const double fine = relative_rms(picture(gnomon_technique_radiosity, "bounces=all,levels=0,patch_size=0.1"), paths);
    EXPECT_LT(coarse, 0.05) << entry.id;
    EXPECT_GT(std::log2(coarse / fine), 0.8) << entry.id << ": " << coarse << ' ' << fine;
  }
}

/// Plates that reflect nearly all, close to each other: what few rays say of the light that escapes takes none away.
TEST_F(Radiosity, light_between_close_plates_is_kept) {
  Registry scenes;
  gnomon_scene_facing_plates(scenes);
  const auto generator = scenes.scenes()[0].make();
  generator->apply("reflectance=0.95,distance=0.25");
  const Scene scene = generator->make();
  const auto light = std::ranges::find_if(scene.lights, has_area);
  const Lit lit(scene, *light,
                {.patch_size = 0.2, .samples = 16, .levels = 0, .contrast = 0.05, .bounces = Bounces::all, .rest = 0.02});
  const radiosity::Ledger& ledger = lit.lighting->ledger();
  EXPECT_LT(std::abs(ledger.defect.x) / ledger.emitted.x, 0.03);
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

/// What does not come to an end, or becomes too much, ends with a reason.
TEST_F(Radiosity, ends_with_a_reason) {
  const auto why = [](const Scene& scene, const radiosity::Settings& settings) -> std::string {
    try {
      const Lit lit(scene, lamp, settings);
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  };
  const std::string endless =
      why(room(0.9999f), {.patch_size = 1, .samples = 1, .contrast = 0.05, .bounces = Bounces::all, .rest = 0.001});
  EXPECT_TRUE(endless.starts_with("unshot = 0.001 is not reached: after 2400 shots, 100 for each patch, ")) << endless;
  // Every difference counts, and one ray to each part of the lamp sees it or not.
  Scene scene = table_scene();
  scene.lights[0] = lamp;
  const std::string many = why(scene, {.patch_size = 0.2,
                                       .samples = 1,
                                       .levels = radiosity::Division::most_levels,
                                       .contrast = 1e-9,
                                       .rest = 0.01,
                                       .most_elements = 5000});
  EXPECT_TRUE(many.starts_with("levels = 8 divides the patches into ")) << many;
  EXPECT_NE(many.find("; at most 5000: "), std::string::npos) << many;
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

}  // namespace radiosity_test
