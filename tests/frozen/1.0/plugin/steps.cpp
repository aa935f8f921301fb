// Steps: a generated scene with something of each kind that a scene can hold: a shape, a masked card, a pane of glass, a box
// that moves, lights of every kind, a path. Frozen at version 1.0: it must compile, unchanged, with every 1.x.
#include <gnomon/registry.h>

#include <memory>

namespace {
using namespace gnomon;

constexpr SceneKey keys[] = {{.letter = 'H', .parameter = "height", .value = "2", .sentence = "Higher steps."}};

class Steps final : public SceneGenerator {
  Number<double> height{this, "height", 1, {.unit = "m", .min = 0.25, .max = 4}, Stage::build, "Height of the box."};
  Flag glass{this, "glass", false, Stage::build, "Adds a pane of glass."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    scene.ambient = 0.2f;
    scene.meshes.push_back(quad("floor", {-4, 0, 4}, {8, 0, 0}, {0, 0, -8}));
    scene.meshes.back().shape = Plane{.center = {0, 0, 0}, .half_u = {4, 0, 0}, .half_v = {0, 0, -4}};
    scene.meshes.push_back(box({-0.5f, 0, -0.5f}, {0.5f, static_cast<float>(height), 0.5f}));

    Mesh card = quad("card", {-2, 0, -1}, {1, 0, 0}, {0, 1, 0});
    const std::uint8_t alpha[] = {255, 0, 0, 255};
    card.alpha_mask =
        std::make_shared<const AlphaMask>(2, 2, alpha, 1.0f, 0.5f, AlphaMask::Wrap::repeat, AlphaMask::Wrap::clamp);
    card.uv = {{0, 0}, {2, 0}, {2, 1}, {0, 1}};
    scene.meshes.push_back(std::move(card));
    if (glass) {
      Mesh pane = quad("pane", {1, 0, 0.5f}, {1, 0, 0}, {0, 1, 0});
      pane.transmission = std::make_shared<const Transmission>(glm::vec3(0.5f));
      pane.seen = false;
      scene.meshes.push_back(std::move(pane));
    }
    for (Mesh& mesh : scene.meshes) finish(mesh);

    scene.lights = {
        Light{.name = "point", .kind = PointLight{.position = {2, 4, 2}}, .intensity = 20},
        Light{.name = "sun", .kind = DirectionalLight{.direction = {-1, -2, -1}}, .intensity = 1},
        Light{.name = "spot",
              .kind = SpotLight{.position = {0, 5, 3}, .direction = {0, -5, -3}, .inner_degrees = 15, .outer_degrees = 25}},
        Light{
            .name = "panel",
            .kind =
                RectLight{.center = {1, 4, 1}, .half_u = {0.5f, 0, 0}, .half_v = {0, 0, 0.5f}, .emits = Emits::on_both_sides}},
        Light{.name = "lamp",
              .kind = DiscLight{.center = {-1, 4, 1}, .normal = {0, -1, 0}, .radius = 0.5f, .emits = Emits::in_front}},
        Light{.name = "ball", .kind = SphereLight{.center = {0, 5, 2}, .radius = 0.4f}}};
    scene.views = {View{.name = "view", .eye = {3, 3, 6}, .target = {0, 0.5f, 0}, .up = {0, 1, 0}, .fov_y_degrees = 40}};
    scene.paths = {
        Path{.name = "aside", .moves = Path::Moves::camera, .positions = {{3, 3, 6}, {3.25f, 3, 6}}, .frame_count = 4}};
    scene.motion = sliding(scene.meshes[1]);
    scene.notes.push_back("made by hand");
    return scene;
  }

 private:
  static Mesh quad(const char* name, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v) {
    Mesh mesh;
    mesh.name = name;
    mesh.positions = {corner, corner + u, corner + u + v, corner + v};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.albedo = {0.6f, 0.6f, 0.6f};
    return mesh;
  }
  static Mesh box(const glm::vec3& low, const glm::vec3& high) {
    Mesh mesh;
    mesh.name = "box";
    for (int k = 0; k < 8; ++k)
      mesh.positions.push_back({k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z});
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    mesh.shape = Box{.min = low, .max = high};
    return mesh;
  }
  /// The box goes a meter aside in a second.
  static std::shared_ptr<const Motion> sliding(const Mesh& box) {
    auto motion = std::make_shared<Motion>();
    motion->nodes = {MotionNode{}};
    motion->animations = {Animation{.name = "slide",
                                    .tracks = {Track{.node = 0,
                                                     .property = Track::Property::translation,
                                                     .interpolation = Track::Interpolation::linear,
                                                     .times = {0, 1},
                                                     .values = {0, 0, 0, 1, 0, 0}}}}};
    Rig rig;
    rig.mesh = 1;
    rig.node = 0;
    for (const glm::vec3& place : box.positions) rig.base.emplace_back(place);
    motion->rigs.push_back(std::move(rig));
    return motion;
  }
};

}  // namespace

GNOMON_SCENE(steps, Steps,
             {.title = "Steps",
              .summary = "A box that slides, a card with holes, a pane of glass.",
              .is_default = false,
              .keys = {keys[0]}})
