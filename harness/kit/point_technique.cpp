#include <gnomon/kit/hard_light.h>
#include <gnomon/kit/point_technique.h>

namespace gnomon {

Support PointTechnique::supports(const Scene&, const Light& light, const View&) const {
  return hard_lights_only(light, why_no_area());
}

std::optional<Explanation> PointTechnique::explain(std::size_t index) const {
  if (!faces_light(*gbuffer_, index)) return std::nullopt;
  Explanation why;
  if (const std::uint32_t triangle = shading_triangle(index); triangle != nothing) why.element = triangle;
  return why;
}

void PointTechnique::remember(const Scene& scene) {
  scene_ = &scene;
  numbers_ = TriangleNumbers(scene);
}

DebugLayer heat_debug_layer(std::string name, const std::string& what) {
  return {std::move(name), what + ": none where the picture is left gray, else colors as in the legend.", heat_legend()};
}

}  // namespace gnomon
