// Radiosity: surfaces in patches, which hand light on to each other by form factors; shadows fall out where a patch does not
// see the lamp.
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/pictures/exposure.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include <cmath>
#include <memory>

#include "radiosity/explaining.h"
#include "radiosity/layers.h"
#include "radiosity/lighting.h"

namespace {
using namespace gnomon;
using namespace radiosity;

constexpr About about{
    .title = "Radiosity",
    .summary = "Every surface in patches that hand light on by form factors; direct light is what they get from the lamp's.",
    .source =
        "Goral, Torrance, Greenberg and Battaile 1984; Cohen and Greenberg 1985 (hemicube); Cohen, Greenberg, Immel and Brock "
        "1986 (elements); Cohen, Chen, Wallace and Greenberg 1988 (progressive refinement); Wallace, Elmquist and Haines 1989 "
        "(rays from receivers).",
    .error =
        "Between the points where light is found it is interpolated: a penumbra narrower than an element is as wide as the "
        "element, and light and shadow leak where a surface crosses one. Few rays, or a coarse hemicube, err at these points. "
        "Rays go through the holes of alpha masks, but what a patch with holes hands on comes from all of it evenly. It "
        "estimates the share of the irradiance.",
    .fails = "A small thing on a large floor: what casts a shadow between the corners of a patch casts none.",
    .promise = Promise::sampled,
    .estimates = LightShareKind::irradiance,
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_alpha_masks,
    .causes = own_causes};

class Radiosity final : public Technique {
  static constexpr double most_patches = 400000, most_patches_with_bounces = 40000;

  Number<double> patch_size = Number<double>(this, "patch_size", 0.05, {.min = 0.002, .max = 1, .log = true}, Stage::build,
                                             "Longest side of a patch, as a share of the longest side of the scene's box.");
  Number<int> levels =
      Number<int>(this, "levels", 4, {.min = 0, .max = static_cast<int>(Division::most_levels)}, Stage::relight,
                  "How often a patch may be divided in two each way where shadow edges cross it.");
  Number<double> contrast =
      Number<double>(this, "contrast", 0.05, {.min = 0.001, .max = 1, .log = true}, Stage::relight,
                     "Difference of the shares of the lamp that are seen within an element beyond which it is divided.");
  Choice form_factor =
      Choice(this, "form_factor", "contour", {"hemicube", "rays", "contour"}, Stage::relight,
             "How they are found: drawn on a hemicube around the sender; as the mean over rays from the receiver; or in "
             "closed form times the share of such rays that arrive, as is done with rays, too, to what is near.");
  Number<int> hemicube = Number<int>(this, "hemicube", 256, {.unit = "texel", .min = 32, .max = 1024, .log = true},
                                     Stage::relight, "Side of a hemicube's top; an odd number becomes the next even one.");
  Number<int> samples =
      Number<int>(this, "samples", 16, {.unit = "ray", .min = 1, .max = 1024, .log = true}, Stage::relight,
                  "Rays from a receiver to a sender that fills a hundredth of what it sees or more; to smaller ones fewer.");
  Number<int> seed{this, "seed", 1, {"", 0, 1000000}, Stage::relight, "Other random numbers."};
  Choice bounces =
      Choice(this, "bounces", "0", {"0", "1", "all"}, Stage::relight,
             "How often light goes on from surface to surface: never (shadows need no more), once, or until little is left.");
  Number<double> unshot = Number<double>(this, "unshot", 0.01, {.min = 0.0001, .max = 1, .log = true}, Stage::relight,
                                         "Share of the lamp's light that may be left when patches stop to hand it on.");
  Choice interpolate = Choice(this, "interpolate", "vertices", {"constant", "vertices"}, Stage::resolve,
                              "What a point of an element gets: as its center, or between its corners.");
  Flag ambient{this, "ambient", true, Stage::resolve, "Pictures of all light get what is unshot, spread over all surfaces."};
  Number<double> pick_x =
      Number<double>(this, "pick_x", 0.5, {.min = 0, .max = 1}, Stage::resolve,
                     "Place in the picture, from its left border, of the patch that debug layers are about.");
  Number<double> pick_y{this, "pick_y", 0.6, {.min = 0, .max = 1}, Stage::resolve, "The same from the upper border."};

 public:
  Support supports(const Scene& scene, const Light& light, const View&) const override {
    if (!has_area(light))
      return Support::unsupported(
          fmt::format("patches of the lamp send the light, and a {} light has no area: it needs a rect, disc or sphere light",
                      kind_name(light)));
    for (const Mesh& mesh : scene.meshes)
      if (const float most = std::max({mesh.albedo.x, mesh.albedo.y, mesh.albedo.z}); !bounces.is("0") && !(most < 1))
        return Support::unsupported(fmt::format(
            "mesh {} reflects {} of the light: it must be below 1, or light would never be used up", mesh.name, most));
    const double count = 2 * Division::patch_count(Faces(scene), patch_size * longest_side(scene));
    const double most = bounces.is("0") ? most_patches : most_patches_with_bounces;
    if (count > most)
      return Support::unsupported(fmt::format("patch_size {} makes {} sides of patches; at most {}{}", patch_size.text(), count,
                                              most, bounces.is("0") ? "" : " when they hand light on"));
    if (form_factor.is("hemicube")) {
      for (const Mesh& mesh : scene.meshes)
        if (mesh.alpha_mask)
          return Support::unsupported(fmt::format(
              "a hemicube shows whole patches, without the holes of mesh {}: it needs form_factor=rays or contour", mesh.name));
      if (const Support enough = within_limits(Hemicube::needs(resolution())); !enough) return enough;
      for (const Mesh& mesh : scene.meshes)
        if (!mesh.casts)
          return Support::approximate(
              fmt::format("on a hemicube mesh {} hides the lamp, although it casts no shadows", mesh.name));
    }
    return Support::full();
  }
  void setup() override {
    made_->hemicube.setup();
    // The shader's one draw: nothing else needs warmth, and few patches are enough.
    const std::string chosen = settings();
    for (Parameter* parameter : parameters()) parameter->set(parameter->default_text());
    apply("patch_size=1,levels=0,form_factor=hemicube,hemicube=32");
    warm_up(*this);
    for (Parameter* parameter : parameters()) parameter->set(parameter->default_text());
    apply(chosen);
    lighting_.reset();
  }
  void build(const Scene& scene) override { made_->surfaces.build(scene, patch_size); }
  void relight(const Light& light) override {
    light_ = light;
    lighting_ = std::make_unique<Lighting>(made_->surfaces, light, settings_now(), &made_->hemicube);
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    const std::span<float> pixels = mask.pixels();
    for_blocks(gbuffer.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) pixels[i] = visibility(i);
    });
  }
  Counts counts() const override {
    const Surfaces& surfaces = made_->surfaces;
    double bytes = 0;
    if (surfaces.all)
      bytes =
          made_.own(static_cast<double>(surfaces.all->bytes() + surfaces.casters->bytes() + surfaces.faces->bytes() +
                                        surfaces.patches->bytes() + bytes_of(surfaces.solid_shares) + made_->hemicube.bytes()));
    if (!lighting_) return {{"bytes", bytes, "byte"}};
    const Ledger& ledger = lighting_->ledger();
    const auto sum = [](const glm::dvec3& color) { return color.x + color.y + color.z; };
    const auto share = [&](const glm::dvec3& part) { return sum(ledger.emitted) > 0 ? sum(part) / sum(ledger.emitted) : 0; };
    using Together = Count::Together;
    return {{"patches", 2.0 * static_cast<double>(lighting_->division().patch_count()), "", Together::mean},
            {"elements", 2.0 * static_cast<double>(lighting_->element_count()), "", Together::mean},
            {"factors", double(lighting_->factor_count()), ""},
            {"rays", double(lighting_->ray_count()), ""},
            {"shots", double(lighting_->shot_count()), ""},
            {"unshot_share", share(ledger.unshot), "", Together::mean},
            {"escaped_share", share(ledger.escaped), "", Together::mean},
            {"defect_share", std::abs(share(ledger.defect)), "", Together::mean},
            {"bytes", bytes + static_cast<double>(lighting_->bytes()), "byte"}};
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &Radiosity::made_); }
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    const std::optional<Found> found = look(index);
    if (!found || !faces_light(*made_->surfaces.scene, *gbuffer_, light_, index)) return why;
    why.element = found->element;
    why.cause = explainer().cause(gbuffer_->position(index), *found, visibility(index));
    return why;
  }
  std::optional<std::vector<float>> global_picture() const override {
    std::vector<float> picture(3 * gbuffer_->size());
    const glm::dvec3 rest = ambient && bounces.is("all") ? lighting_->ambient() : glm::dvec3(0);
    for_blocks(gbuffer_->size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::optional<Found> found = look(i);
        if (!found) continue;
        const double direct = received(*found).seen * lighting_->exitance();
        const glm::dvec3 albedo(made_->surfaces.scene->meshes[gbuffer_->mesh[i]].albedo);
        const glm::dvec3 radiance = albedo * (direct + handed_on(*found) + rest) / std::numbers::pi;
        for (int c = 0; c < 3; ++c) picture[3 * i + c] = static_cast<float>(radiance[c]);
      }
    });
    return picture;
  }
  std::vector<DebugLayer> debug_layers() const override { return radiosity::layers(); }
  std::vector<float> draw_debug(std::string_view layer) const override {
    const Look look_at = [this](std::size_t i) { return look(i); };
    if (layer == "radiosity") return exposed(*global_picture());
    if (layer == "patches") return paint_patches(*gbuffer_, *lighting_, look_at);
    if (layer == "subdivision") return paint_subdivision(*gbuffer_, *lighting_, look_at);
    if (layer == "unshot") return paint_unshot(*gbuffer_, *lighting_, look_at);
    if (layer != "form_factors" && layer != "hemicube") return Technique::draw_debug(layer);
    const std::optional<Found> patch = picked();
    if (!patch) return std::vector<float>(3 * gbuffer_->size());
    if (layer == "form_factors") return paint_form_factors(*gbuffer_, *lighting_, look_at, *patch, made_->surfaces);
    return paint_hemicube(*gbuffer_, *lighting_, *patch, *made_->surfaces.scene, made_->hemicube, resolution());
  }

 private:
  Settings settings_now() const {
    return {.form_factor = static_cast<FormFactor>(form_factor.index()),
            .patch_size = patch_size * made_->surfaces.size,
            .resolution = resolution(),
            .samples = samples,
            .levels = levels,
            .contrast = contrast,
            .bounces = static_cast<Bounces>(bounces.index()),
            .rest = unshot,
            .seed = static_cast<std::uint64_t>(seed)};
  }
  /// A hemicube's sides are half as high as they are wide.
  int resolution() const { return hemicube + hemicube % 2; }
  std::optional<Found> look(std::size_t i) const {
    const GBuffer& gbuffer = *gbuffer_;
    if (gbuffer.is_background(i)) return std::nullopt;
    const Surfaces& surfaces = made_->surfaces;
    std::uint32_t mesh = gbuffer.mesh[i], triangle = gbuffer.triangle[i];
    const glm::dvec3 point(gbuffer.position(i)), normal(gbuffer.normal(i));
    if (gbuffer.truth == Truth::shape && surfaces.scene->meshes[mesh].has_curved_shape()) {
      // On an exact shape: the triangle of its mesh that the eye sees through the same pixel, or the nearest below the surface.
      const glm::dvec3 eye(gbuffer.view.eye);
      RayScene::Hit hit = surfaces.all->closest(eye, point - eye);
      if (hit.mesh != mesh) hit = surfaces.all->closest(point + 0.01 * surfaces.size * normal, -normal);
      if (hit.mesh != mesh) return std::nullopt;
      triangle = hit.triangle;
    }
    const std::uint32_t face_index = surfaces.faces->face_of(mesh, triangle);
    const Face& face = (*surfaces.faces)[face_index];
    const glm::dvec2 place = face.place_of(point);
    return Found{lighting_->division().element_at(face_index, place), glm::dot(normal, face.normal) < 0 ? 1 : 0, place};
  }
  std::optional<Found> picked() const {
    const auto at = [](double share, int size) { return std::min(static_cast<int>(share * size), size - 1); };
    return look(std::size_t(at(pick_y, gbuffer_->height)) * gbuffer_->width + at(pick_x, gbuffer_->width));
  }
  /// What nodes of an element have, at a place: that of its center, or between its corners.
  template <class Value, class Get>
  Value between(const Element& element, const Found& found, const Get& get) const {
    if (interpolate.is("constant")) return get(element.center);
    const Division& division = lighting_->division();
    const std::array weights = division.weights(element, found.place);
    Value sum{};
    for (std::size_t k = 0; k < division.corner_count(element); ++k) sum += get(element.corners[k]) * weights[k];
    return sum;
  }
  Received received(const Found& found) const {
    return between<Received>(lighting_->division().elements()[found.element], found,
                             [&](std::uint32_t node) { return lighting_->received(node, found.side); });
  }
  glm::dvec3 handed_on(const Found& found) const {
    const std::vector<Element>& elements = lighting_->division().elements();
    return between<glm::dvec3>(elements[elements[found.element].patch], found,
                               [&](std::uint32_t node) { return lighting_->handed_on(node, found.side); });
  }
  float visibility(std::size_t pixel) const {
    if (!faces_light(*made_->surfaces.scene, *gbuffer_, light_, pixel)) return 1;
    const std::optional<Found> found = look(pixel);
    if (!found) return 1;
    const Received here = received(*found);
    return here.whole > 0 ? static_cast<float>(std::clamp(here.seen / here.whole, 0.0, 1.0)) : 1;
  }
  Explainer explainer() const { return {made_->surfaces, *lighting_, interpolate.is("vertices"), form_factor.is("hemicube")}; }

  struct Made {
    Surfaces surfaces;
    Hemicube hemicube;
  };
  Shared<Made> made_;
  Light light_;
  const GBuffer* gbuffer_ = nullptr;
  std::unique_ptr<Lighting> lighting_;
};

}  // namespace

GNOMON_TECHNIQUE(radiosity, Radiosity, about)
