#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/gl/gl.h>

namespace gnomon {

namespace {

/// A triangle and one of each curved shape over a floor, under a light of each kind: every stage has something to do. All have
/// exact shapes, for techniques that see nothing else.
struct TinyScene {
  Scene scene;
  std::vector<float> x, z, zero, one;
  std::vector<std::uint32_t> first;  // mesh and triangle
  GBuffer gbuffer;

  explicit TinyScene(bool with_glass) {
    // The floor first: it is what the picture shows.
    for (const Shape& shape : {Shape(ground_plane(2)), Shape(Triangle{{{-1, 1, -1}, {-1, 1, 1}, {1, 1, 0}}}),
                               Shape(Sphere{{0, 1, 0}, 0.3f}), Shape(Cone{{0, 2, 0}}), Shape(Disc{{0, 1.5f, 0}})})
      scene.meshes.push_back(tessellate(shape, 8, "shape"));
    if (with_glass) scene.meshes[1].transmission = std::make_shared<const Transmission>(glm::vec3(0.5f));
    scene.lights = {{.name = "sun", .kind = DirectionalLight{}},
                    {.name = "spot", .kind = SpotLight{.position = {0, 5, 0}}},
                    {.name = "point", .kind = PointLight{{0, 5, 0}}},
                    {.name = "rect", .kind = RectLight{.center = {0, 5, 0}}},
                    {.name = "disc", .kind = DiscLight{.center = {0, 5, 0}}},
                    {.name = "sphere", .kind = SphereLight{.center = {0, 5, 0}}}};
    scene.views = {View{.eye = {0, 5, 5}}};
    constexpr int side = 8;
    for (int i = 0; i < side * side; ++i) {
      x.push_back(i % side * 0.25f - 1);
      z.push_back(i / side * 0.25f - 1);
    }
    zero.assign(x.size(), 0);
    one.assign(x.size(), 1);
    first.assign(x.size(), 0);
    gbuffer = {scene.views[0], Truth::mesh, side, side, x, zero, z, zero, one, zero, first, first, nullptr};
  }
};

}  // namespace

void warm_up(Technique& technique, bool with_glass) {
  static const TinyScene opaque(false), glass(true);  // outlive the technique, as the contract requires
  // A device without room for glass will draw none.
  const bool has_room = static_cast<bool>(within_limits(inputs_need(glass.scene, glass.gbuffer.width, glass.gbuffer.height)));
  const TinyScene& tiny = with_glass && has_room ? glass : opaque;
  technique.build(tiny.scene);
  VisibilityMask mask(tiny.gbuffer.width, tiny.gbuffer.height);
  for (const Light& light : tiny.scene.lights) {
    if (!technique.supports(tiny.scene, light, tiny.scene.views[0])) continue;
    technique.relight(light);
    technique.resolve(tiny.gbuffer, mask);
  }
}

}  // namespace gnomon
