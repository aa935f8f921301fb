// Crow's counting of shadow volumes: on the way from the eye to a point, volumes entered minus volumes left, front to back.
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/pictures/lines.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

#include "crow_counting/ways.h"

namespace {
using namespace gnomon;
using namespace gnomon::crow_counting;

constexpr About about{
    .title = "Crow's counting of shadow volumes",
    .summary =
        "Shadow volumes entered and left on the way from the eye to each visible point, sorted and counted front to back.",
    .source =
        "Crow 1977; the front-to-back count of the lecture notes, with the rule put right: a point is in shadow if and "
        "only if eye + entered - left > 0, where eye is the number of volumes that hold the eye (>= 0 would shadow "
        "everything).",
    .error =
        "None on the float32 points that it is given: a crossing that double cannot decide is decided by exact signs. A way "
        "through the border of a side quad is counted anew from a start beside the eye. A point on such a border, whose way "
        "to the light goes exactly through an edge, is dark. Of a closed body only the half that faces the light counts, and "
        "the other half is asked about points close to an edge alone: a point that rounding put through its own triangle and "
        "out of the body behind it may be lit where it is 64 times as far from the edges of that triangle as it is behind "
        "it. Tessellation on curved shapes.",
    .fails =
        "Nothing it supports; the work grows with the length of the silhouette's shadow on the screen. A closed body that "
        "passes through itself inside out may be taken for empty.",
    .promise = Promise::exact};

// Side quads are infinite and weigh what their edges count, so that open and inconsistently wound meshes and layers are right;
// light caps are the triangles that face the light. A dark cap at infinity is never on the way.
class CrowCounting final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    return hard_lights_only(light, "a shadow volume has one apex: it cannot see part of an area light");
  }
  void setup() override {}
  void build(const Scene& scene) override {
    *scene_ = &scene;
    volumes_.build(scene);
    own_->build(scene);
  }
  void relight(const Light& light) override {
    light_ = light;
    volumes_.relight(light);
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::optional<Explanation> explain(std::size_t index) const override;
  std::vector<DebugLayer> debug_layers() const override {
    return {{"crossings", "Faces crossed on the way to each point: gray none, else colors as in the legend.", heat_legend()},
            {"depth", "Shadow volumes around each point: gray none, else colors as in the legend.", heat_legend()},
            silhouette_layer()};
  }
  std::unique_ptr<Technique> for_another_light() const override {
    return another(*this, &CrowCounting::scene_, &CrowCounting::volumes_, &CrowCounting::own_);
  }
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  Shared<const Scene*> scene_;
  const GBuffer* gbuffer_ = nullptr;
  Light light_;
  Volumes volumes_;
  Shared<OwnVolumes> own_;
  WayCounter counter_;
  std::int64_t volumes_at_eye_ = 0;
};

void CrowCounting::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  gbuffer_ = &gbuffer;
  const double size = (*scene_)->bounds().extent();
  counter_.begin(**scene_, size, gbuffer, light_, volumes_, *own_, mask.pixels());

  // The count at a point does not depend on where it is begun, so where a start is in line with the border of a volume, another
  // one beside it will do. A point for which none of many starts will do lies on a border itself.
  const glm::vec3 eye = gbuffer.view.eye;
  const auto beside = static_cast<float>(0x1p-12 * std::max(size, extent(eye)));
  Random random(1977);
  std::size_t left = 1;
  for (int attempt = 0; attempt < 16 && left > 0; ++attempt) {
    glm::vec3 start = eye;
    if (attempt > 0) start += beside * glm::vec3(random.uniform(glm::dvec3(-1), glm::dvec3(1)));
    const EdgeAdjacency::Depth depth = volumes_.adjacency().depth_at(start, volumes_.silhouette());
    if (attempt == 0) volumes_at_eye_ = depth.volumes;
    if (!depth.degenerate) left = counter_.count_from(Frame(gbuffer.view, start), depth.volumes);
  }
  counter_.darken_rest();
}

Counts CrowCounting::counts() const {
  const CountingWork& work = counter_.work();
  const auto count = [](const char* name, auto value) { return Count{name, static_cast<double>(value), ""}; };
  const double rays = static_cast<double>(std::max<std::uint64_t>(work.rays, 1));
  return {count("silhouette_edges", volumes_.silhouette().edges.size()),
          count("polygons", volumes_.count()),
          count("volumes_at_eye", volumes_at_eye_),
          count("rays", work.rays),
          count("crossings", work.crossings),
          count("crossings_per_ray", static_cast<double>(work.crossings) / rays),
          count("longest_list", work.longest),
          count("deepest", work.deepest),
          count("crossing_tests", work.tests),
          count("exact_tests", work.exact),
          count("restarts", work.again),
          count("degenerate_rays", work.touching),
          {"bytes", static_cast<double>(volumes_.bytes() + counter_.bytes()) + own_.own(static_cast<double>(own_->bytes())),
           "byte"}};
}

// A volume is named by what it was entered through: a triangle of the scene or, from the number of triangles on, an edge of the
// silhouette.
std::optional<Explanation> CrowCounting::explain(std::size_t index) const {
  if (!faces_light(**scene_, *gbuffer_, light_, index)) return std::nullopt;
  Explanation why;
  const std::uint32_t entered = counter_.found()[index].entered;
  if (entered != no_polygon)
    why.element = volumes_.is_side(entered) ? (*scene_)->triangle_count() + entered : volumes_.cap(entered);
  return why;
}

std::vector<float> CrowCounting::draw_debug(std::string_view layer) const {
  if (layer != "crossings" && layer != "depth" && layer != "silhouette") return Technique::draw_debug(layer);
  std::vector<float> values;
  values.reserve(counter_.found().size());
  if (layer == "silhouette") {
    for (const PixelCount& pixel : counter_.found()) values.push_back(pixel.depth > 0 ? 0.0f : 1.0f);
    std::vector<float> picture = shaded_layer(**scene_, *gbuffer_, light_, values);
    draw_lines(silhouette_lines(volumes_.adjacency(), volumes_.silhouette()), *gbuffer_, picture);
    return picture;
  }
  for (const PixelCount& pixel : counter_.found())
    values.push_back(static_cast<float>(layer == "depth" ? pixel.depth : pixel.crossings));
  return heat_layer(*gbuffer_, values);
}

}  // namespace

GNOMON_TECHNIQUE(crow_counting, CrowCounting, about)
