// Shadow rays that keep their tree where no caster moved: a plugin with an update of its own. Where the variable UPDATED_RAYS
// names a file, each build adds the line "build" to it, each update "update" and how many meshes moved.
#include <gnomon/kit/rays/rays.h>
#include <gnomon/registry.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>

namespace {
using namespace gnomon;

void tell(const std::string& line) {
  if (const char* const file = std::getenv("UPDATED_RAYS")) std::ofstream(file, std::ios::app) << line << '\n';
}

class UpdatedRays final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    return has_area(light) ? Support::unsupported("it has no penumbra") : Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override {
    tell("build");
    take(scene);
    casters_.emplace(scene, Truth::mesh, RayScene::Which::casters);
  }
  void update(const Scene& scene, const Changes& changes) override {
    int moved = 0;
    bool caster_moved = false;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
      if (changes.meshes[m].kind == MeshChange::Kind::still) continue;
      ++moved;
      caster_moved |= scene.meshes[m].casts;
    }
    tell("update " + std::to_string(moved));
    take(scene);
    if (caster_moved) casters_.emplace(scene, Truth::mesh, RayScene::Which::casters);
  }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const std::span<float> pixels = mask.pixels();
    for (std::size_t i = 0; i < pixels.size(); ++i)
      pixels[i] = faces_light(*scene_, gbuffer, light_, i) && !is_lit(gbuffer, i) ? 0.0f : 1.0f;
  }
  Counts counts() const override { return {{"bytes", static_cast<double>(casters_->bytes()), "byte"}}; }

 private:
  void take(const Scene& scene) {
    scene_ = &scene;
    offset_ = 1e-6 * scene.bounds().extent();  // no length is special
  }
  bool is_lit(const GBuffer& gbuffer, std::size_t i) const {
    const glm::dvec3 point = gbuffer.position(i), normal = gbuffer.normal(i);
    const glm::dvec3 start = point + offset_ * normal;  // off its own surface
    const glm::dvec4 light = homogeneous(light_);
    const double end = light.w != 0 ? 1 : INFINITY;  // a point light is an end of the segment
    return casters_->closest(start, to_light(light, start)).t >= end;
  }

  const Scene* scene_ = nullptr;
  std::optional<RayScene> casters_;
  Light light_;
  double offset_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(updated_rays, UpdatedRays,
                 {.title = "Updated rays",
                  .summary = "A shadow ray for each pixel, whose tree is kept where no caster moved.",
                  .source = "none",
                  .error = "That of its offset.",
                  .fails = "Nowhere that its test looks."})
