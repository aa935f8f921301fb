// Stochastic map: several depths a texel, each of which a surface of glass covers by chance, the denser the more often.
#include <gnomon/kit/maps/glass_map.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/registry.h>

#include "stochastic_map/cover.h"

namespace {
using namespace gnomon;

constexpr OwnCause causes[] = {
    {"sample_noise",
     "The share of a texel's samples that glass left free is another than the product of what lets the light through.",
     {120, 80, 208}},
};

constexpr About about{
    .title = "Stochastic map",
    .summary = "Several depths for each texel of an image from the light; a surface covers each of them with the chance 1 - t.",
    .source = "Enderton, Sintorn, Shirley and Luebke 2010 (stochastic transparency); Kensler 2013 (shuffle)",
    .error =
        "Noise from texel to texel: the mean of the share of samples that are free is the product of all t, its standard "
        "deviation at most sqrt(T (1 - T) / samples): 0.125 at T = 1/2 with 16. One surface alone is off by less than "
        "1 / samples. Edges as of a shadow map.",
    .fails =
        "Few samples and a large picture, which shows each texel's noise; smoke that takes little light, of which 1 / samples "
        "is the least step.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = causes,
    .named_only = true};

constexpr std::string_view draw_snippet = R"(
uniform int cover_image, cover_item, cover_count, cover_seed, cover_first_triangle;
void draw_glass(float t, float transmission) {
  uint triangle = uint(cover_first_triangle) + uint(gl_PrimitiveID);  // of the scene, not of the mesh
  uint hash = cover_hash(triangle, uvec2(gl_FragCoord.xy), uint(cover_image), uint(cover_seed));
  if (!covers(hash, transmission, uint(cover_item), uint(cover_count))) discard;
  gl_FragDepth = t;
}
)";

constexpr std::string_view share_snippet = R"(
layout(binding = 4) uniform sampler2DArray glass_samples;
float glass_at(ivec3 texel, float t) {
  int count = int(sample_count), covered = 0;
  for (int k = 0; k < count; ++k)
    covered += int(texelFetch(glass_samples, ivec3(texel.xy, texel.z * count + k), 0).r < t);
  return 1 - float(covered) / sample_count;
}
)";

class StochasticMap final : public GlassMap {
  Number<int> samples =
      Number<int>(this, "samples", 16, {.unit = "", .min = 4, .max = stochastic_map::most_samples, .log = true}, Stage::relight,
                  "Depths that each texel holds.");
  Number<int> seed = Number<int>(this, "seed", 1, {.unit = "", .min = 0, .max = 1 << 30}, Stage::relight,
                                 "Of the random numbers: others, other noise.");

 public:
  Support supports(const Scene& scene, const Light& light, const View& view) const override {
    const Support support = GlassMap::supports(scene, light, view);
    if (!support || !scene.has_transmission()) return support;
    const std::int64_t side = image_resolution(), images = looks_through_cube(light) ? 6 : 1, layers = images * samples;
    if (const std::int64_t bytes = side * side * layers * 4; bytes > most_bytes)
      return Support::unsupported(fmt::format("{} samples of {} x {} texels in {} images take {} MiB; at most {}",
                                              samples.value(), side, side, images, bytes >> 20, most_bytes >> 20));
    const Support enough = within_limits({.texture_layers = layers});
    return enough ? support : enough;
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &StochasticMap::made_); }

  std::vector<DebugLayer> debug_layers() const override {
    std::vector<DebugLayer> layers = GlassMap::debug_layers();
    layers.push_back(
        heat_debug_layer("covered", "How many samples of the texel that holds the point glass covers, at any depth"));
    return layers;
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer != "covered") return GlassMap::draw_debug(layer);
    if (!depths_) return heat_of_texels([](const glm::ivec3&) { return 0.0f; });
    const std::vector<float> depths = read_texels<float>(depths_, GL_DEPTH_COMPONENT);
    return heat_of_texels([&](const glm::ivec3& texel) {
      const auto side = static_cast<std::size_t>(depths_.width);
      int covered = 0;
      for (int k = 0; k < samples; ++k)
        covered += depths[((texel.z * samples + k) * side + texel.y) * side + texel.x] < nothing;
      return static_cast<float>(covered);
    });
  }

 private:
  static constexpr float nothing = 1;                                ///< depth of a sample that glass leaves free
  static constexpr std::int64_t most_bytes = std::int64_t{1} << 30;  ///< of the images of a light

  Method method() const override {
    return {.draw = std::string(stochastic_map::cover_snippet) + std::string(draw_snippet),
            .share = std::string(share_snippet) + std::string(filtered_shares),
            .constants = "float sample_count;",
            .constant_count = 1};
  }

  /// A layer for each sample, drawn one by one; those of an image follow each other. The number of a triangle within a draw
  /// begins with each mesh, so each mesh is drawn by itself.
  void draw_glass(const GlassDrawing& glass) override {
    depths_.fit(GL_DEPTH_COMPONENT32F, glass.resolution(), glass.resolution(), glass.layer_count() * samples);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glass.set("cover_count", samples.value());
    glass.set("cover_seed", seed.value());
    const SceneBuffers& buffers = scene_buffers(*made_->scene);
    glass.each_image([&](const LightImage& image) {
      LightImage mesh = image;
      glass.set("cover_image", image.layer);
      for (int k = 0; k < samples; ++k) {
        glNamedFramebufferTextureLayer(glass.framebuffer, GL_DEPTH_ATTACHMENT, depths_.name(), 0, image.layer * samples + k);
        glClearNamedFramebufferfv(glass.framebuffer, GL_DEPTH, 0, &nothing);
        glass.set("cover_item", k);
        for (const std::uint32_t m : image.casters) {
          if (!made_->is_glass[m]) continue;
          mesh.casters.assign(1, m);
          glass.set("cover_first_triangle", static_cast<int>(buffers.meshes[m].first_triangle));
          glass.draw(mesh);
        }
      }
    });
  }
  void bind_glass(const Program& look_up) const override {
    glBindTextureUnit(4, depths_.name());
    look_up.set_if_used("sample_count", static_cast<float>(samples));
  }
  void release_glass() override { depths_ = {}; }
  std::size_t glass_bytes() const override { return depths_.bytes; }
  Counts more_counts() const override {
    return {{"samples", depths_ ? double(depths_.width) * depths_.height * depths_.layers : 0.0, ""}};
  }
  std::string_view glass_cause(const Reading& reading) const override {
    return reading.is_right(reading.exact_share()) ? causes[0].id : "";
  }

  Texture depths_;
};

}  // namespace

GNOMON_TECHNIQUE(stochastic_map, StochasticMap, about)
