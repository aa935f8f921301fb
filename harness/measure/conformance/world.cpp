#include "measure/conformance/world.h"

#include <dlfcn.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/registry.h>

#include <cstdlib>

#include "measure/conformance/rule.h"
#include "measure/paths.h"
#include "measure/scene/blob.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"

namespace gnomon::conformance {

Scene generated_scene(const std::string& reference) {
  const std::string id = reference.substr(0, reference.find_first_of(":@"));
  if (!registry().find_scene(id))
    throw CannotAsk("the generated scene {} is missing: this program was built without it, and rules are checked there", id);
  return load_scene(reference);
}

namespace {

constexpr int card_side = 8;  ///< texels

/// A card over the middle of the ground, with places from 0 to 1 on it.
Mesh card(const std::string& name) {
  Mesh card;
  card.name = name;
  card.positions = {{-1.875f, 1.5f, -1.75f}, {-1.625f, 1.75f, 1.75f}, {1.875f, 1.625f, 1.5f}, {1.625f, 1.375f, -2}};
  card.triangles = {{0, 1, 2}, {0, 2, 3}};
  card.uv = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  return card;
}

Scene over_ground(const std::string& name, std::vector<Mesh> casters) {
  Scene scene;
  scene.name = name;
  scene.meshes = std::move(casters);
  for (Mesh& mesh : scene.meshes) finish(mesh);
  scene.meshes.push_back(tessellate(ground_plane(6), 3, "ground"));
  scene.lights = {{.name = "point", .kind = PointLight{{0.7f, 8, 1.1f}}},
                  {.name = "sun", .kind = DirectionalLight{{-0.3f, -1, -0.2f}}}};
  scene.views = {{.name = "view", .eye = {1, 6, 7}, .target = {0, 0, 0}}};
  return scene;
}

}  // namespace

Scene checkered_card() {
  std::vector<std::uint8_t> alpha;
  for (int y = 0; y < card_side; ++y)
    for (int x = 0; x < card_side; ++x) alpha.push_back((x + y) % 2 == 0 ? 255 : 0);
  Mesh checkered = card("card");
  checkered.alpha_mask = std::make_shared<const AlphaMask>(card_side, card_side, alpha);
  return over_ground("checkered_card", {std::move(checkered)});
}

Scene glass_cards() {
  std::vector<float> checker;
  for (int y = 0; y < card_side; ++y)
    for (int x = 0; x < card_side; ++x) checker.push_back((x + y) % 2 == 0 ? 0.75f : 0.25f);
  Mesh textured = card("textured"), plain = card("plain"), opaque = card("opaque");
  textured.transmission = std::make_shared<const Transmission>(card_side, card_side, 1, checker);
  plain.transmission = std::make_shared<const Transmission>(glm::vec3(0.5f));
  textured.seen = plain.seen = false;
  for (glm::vec3& p : plain.positions) p += glm::vec3(0.5f, 0.75f, 0.25f);
  for (glm::vec3& p : opaque.positions) p = p * glm::vec3(0.25f, 1, 0.25f) + glm::vec3(0.25f, 0.375f, 0);
  plain.uv.clear();
  opaque.uv.clear();
  return over_ground("glass_cards", {std::move(textured), std::move(plain), std::move(opaque)});
}

namespace {

/// The hash of the code that runs: of the program and of the kit that it has loaded.
std::string code_hash() {
  Dl_info kit;
  if (dladdr(reinterpret_cast<const void*>(&registry), &kit) == 0) throw Error("the kit that is loaded has no file");
  std::string hashes;
  for (const std::filesystem::path& file : {program_path(), std::filesystem::path(kit.dli_fname)})
    hashes += content_hash(MappedFile::open(file)->bytes());
  return content_hash(hashes);
}

std::filesystem::path reference_folder() {
  if (const char* kept = std::getenv("GNOMON_CONFORMANCE_FRAMES")) return std::filesystem::path(kept) / code_hash();
  static const ScratchFolder own = ScratchFolder::temporary("gnomon_frames");
  return own.path();
}

}  // namespace

FrameStore frames_of(const Scene& scene) {
  static const std::filesystem::path folder = reference_folder();
  return FrameStore(scene, folder);
}

World::World(Scene the_scene, Truth the_truth, int part)
    : scene(std::move(the_scene)), truth(the_truth), part_(part), everything_(scene, truth, RayScene::Which::seen) {}

GBuffer World::gbuffer(const View& view, int width, int height) const {
  return make_gbuffer(scene, everything_, view, width / part_, height / part_, truth);
}

World::Truthful World::reference(const GBuffer& gbuffer, const Light& light, LightShareKind estimates) {
  if (!frames_) frames_.emplace(frames_of(scene));
  return truthful(frames_->reference({gbuffer.view, gbuffer.width, gbuffer.height, gbuffer.truth}, light), light, estimates);
}

World::Truthful truthful(const Reference& found, const Light& light, LightShareKind estimates) {
  const auto copy = [](const auto& part) { return std::vector(part.begin(), part.end()); };
  const bool is_area = estimates == LightShareKind::area || !has_area(light);
  return {copy(is_area ? found.mask : found.irradiance), copy(found.classes),
          copy(is_area ? found.error : found.irradiance_error)};
}

std::vector<Light> lights_of_all_kinds(const Scene& scene) {
  const glm::vec3 high(homogeneous(scene.lights[0])), down = -high;
  std::vector<Light> lights = scene.lights;
  lights.push_back({.name = "spot", .kind = SpotLight{high, down, 8, 16}});
  lights.push_back({.name = "rect", .kind = RectLight{high, {0.5f, 0, 0}, {0, 0, 0.4f}}});
  lights.push_back({.name = "disc", .kind = DiscLight{high, down, 0.5f}});
  lights.push_back({.name = "sphere", .kind = SphereLight{high, 0.5f}});
  return lights;
}

std::string title(const Light& light) { return fmt::format("{} ({})", light.name, kind_name(light)); }

}  // namespace gnomon::conformance
