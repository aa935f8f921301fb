// My rays: a ray from each pixel, tried against every triangle that casts.
#include <gnomon/kit/bases/point_technique.h>
#include <gnomon/kit/bytes.h>
#include <gnomon/registry.h>

#include <cmath>

namespace {
using namespace gnomon;

constexpr About about{.title = "My rays",
                      .summary = "A shadow ray for each pixel, tried against every triangle that casts.",
                      .source = "Möller and Trumbore 1997.",
                      .error = "None beyond the rounding of doubles with an offset of a millionth.",
                      .fails = "Many triangles: each pixel tries all of them."};

class MyRays final : public Technique {
  Number<double> offset{
      this,           "offset",
      1e-6,           {.min = 0, .max = 1},
      Stage::resolve, "How far above its surface a ray begins, as a share of the casters' largest coordinate."};

 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    if (has_area(light)) return Support::unsupported("it has no penumbra");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override {
    scene_ = &scene;
    triangles_.clear();
    extent_ = 0;
    for_triangles(scene, [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, std::uint32_t mesh, std::uint32_t) {
      if (!scene.meshes[mesh].casts) return;
      triangles_.push_back({a, b - a, c - a});
      for (const glm::dvec3& corner : {a, b, c}) extent_ = std::max(extent_, extent(corner));
    });
  }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const std::span<float> pixels = mask.pixels();
    const glm::dvec4 light = homogeneous(light_);
    tests_ = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      pixels[i] = 1;
      if (!faces_light(*scene_, gbuffer, light_, i)) continue;
      const glm::dvec3 point = glm::dvec3(gbuffer.position(i)) + offset * extent_ * glm::dvec3(gbuffer.normal(i));
      if (is_blocked(point, to_light(light, point), light.w != 0 ? 1 : INFINITY)) pixels[i] = 0;
    }
  }
  Counts counts() const override {
    return {{"tests", static_cast<double>(tests_), ""}, {"bytes", static_cast<double>(bytes_of(triangles_)), "byte"}};
  }

 private:
  struct Sides {
    glm::dvec3 a, u, v;
  };
  /// Whether point + t way = a + x u + y v of a triangle with 0 < t < end (Möller and Trumbore 1997).
  bool is_blocked(const glm::dvec3& point, const glm::dvec3& way, double end) {
    for (const auto& [a, u, v] : triangles_) {
      ++tests_;
      const glm::dvec3 from = point - a, across = glm::cross(way, v), side = glm::cross(from, u);
      const double scale = 1 / glm::dot(across, u), x = glm::dot(from, across) * scale, y = glm::dot(way, side) * scale;
      const double t = glm::dot(side, v) * scale;
      if (t > 0 && t < end && x >= 0 && y >= 0 && x + y <= 1) return true;
    }
    return false;
  }

  const Scene* scene_ = nullptr;
  std::vector<Sides> triangles_;
  Light light_;
  double extent_ = 0;
  std::size_t tests_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(my_rays, MyRays, about)
