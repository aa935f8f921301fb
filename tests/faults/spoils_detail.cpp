// Spoils detail: every receiving triangle that is not edge-on to the light is cut in two, one half lit, one shadowed. What it
// hands out then may be spoilt.
#include <gnomon/kit/geometry/exact.h>

#include "faults/harmless.h"

namespace {
using namespace gnomon;

class SpoilsDetail final : public Harmless {
 public:
  Choice spoilt{
      this, "spoilt", "nothing", {"nothing", "mesh", "corner", "all", "order"}, Stage::relight, "What is wrong with it."};

  void build(const Scene& scene) override { scene_ = &scene; }
  void relight(const Light& light) override {
    detail_ = {};
    for (std::uint32_t m = 0; m < scene_->meshes.size(); ++m) {
      const Mesh& mesh = scene_->meshes[m];
      for (std::uint32_t t = 0; t < mesh.triangles.size() && mesh.receives; ++t) {
        const glm::uvec3& v = mesh.triangles[t];
        const glm::vec3 &a = mesh.positions[v.x], &b = mesh.positions[v.y], &c = mesh.positions[v.z];
        if (orient3d_sign(a, b, c, homogeneous(light)) == 0) continue;
        const glm::dvec3 middle = (glm::dvec3(b) + glm::dvec3(c)) / 2.0;
        add(m, t, true, {a, b, middle});
        add(m, t, false, {a, middle, c});
      }
    }
    if (spoilt.is("mesh")) detail_.polygons.back().mesh = 99;
    if (spoilt.is("corner")) detail_.corners.back().x = NAN;
    if (spoilt.is("order")) std::ranges::reverse(detail_.polygons);
    is_gone_ = spoilt.is("all");
  }
  std::optional<SurfaceDetail> surface_detail() const override {
    if (is_gone_) return std::nullopt;
    return detail_;
  }

 private:
  void add(std::uint32_t mesh, std::uint32_t triangle, bool is_lit, std::initializer_list<glm::dvec3> corners) {
    detail_.polygons.push_back({mesh, triangle, is_lit, static_cast<std::uint32_t>(detail_.corners.size()),
                                static_cast<std::uint32_t>(corners.size())});
    detail_.corners.insert(detail_.corners.end(), corners);
  }

  const Scene* scene_ = nullptr;
  SurfaceDetail detail_;
  bool is_gone_ = false;
};

}  // namespace

GNOMON_TECHNIQUE(spoils_detail, SpoilsDetail,
                 {.title = "Spoils detail",
                  .summary = "Cuts triangles in two and calls one half shadowed.",
                  .source = "none",
                  .error = "Half of it.",
                  .fails = "Where it is told to."})
