#include <gnomon/kit/maps/glass_sums.h>

namespace gnomon {

namespace {

int texture_count(int sums) { return (sums + 3) / 4; }

/// Of the texture that begins with sum 4 k.
GLenum sums_format(int sums, int k) {
  const int left = sums - 4 * k;
  return left == 1 ? GL_R32F : left == 2 ? GL_RG32F : GL_RGBA32F;
}

/// "sums[4]" and so on for what texture k holds, "0" behind the last one.
std::string sum_names(int sums, int k) {
  std::string all;
  for (int i = 4 * k; i < 4 * k + 4; ++i) all += (i > 4 * k ? ", " : "") + (i < sums ? fmt::format("sums[{}]", i) : "0");
  return all;
}

/// The mean of one texture over the filter's texels.
constexpr std::string_view mean_body = R"(
vec4 mean_sums(sampler2DArray texels, vec2 place, int layer) {
#if GLASS_FILTER == 0
  return texelFetch(texels, ivec3(place, layer), 0);
#else
  ivec2 last = textureSize(texels, 0).xy - 1;
  vec2 low = floor(place - 0.5), weight = place - 0.5 - low;
  ivec2 a = clamp(ivec2(low), ivec2(0), last), b = clamp(ivec2(low) + 1, ivec2(0), last);
  vec4 upper = mix(texelFetch(texels, ivec3(a, layer), 0), texelFetch(texels, ivec3(b.x, a.y, layer), 0), weight.x);
  vec4 lower = mix(texelFetch(texels, ivec3(a.x, b.y, layer), 0), texelFetch(texels, ivec3(b, layer), 0), weight.x);
  return mix(upper, lower, weight.y);
#endif
}
)";

}  // namespace

GlassMap::Method GlassSums::method() const {
  const Sums what = sums();
  const std::string head = fmt::format("#define SUM_COUNT {}\n", what.count);
  std::string outputs, writes, samplers, reads;
  for (int k = 0; k < texture_count(what.count); ++k) {
    outputs += fmt::format("layout(location = {0}) out vec4 glass_sums_{0};\n", k);
    writes += fmt::format("  glass_sums_{} = vec4({});\n", k, sum_names(what.count, k));
    samplers += fmt::format("layout(binding = {}) uniform sampler2DArray glass_sums_{};\n", 4 + k, k);
    reads += fmt::format("  mean = mean_sums(glass_sums_{}, place, int(layer));\n", k);
    for (int i = 4 * k; i < std::min(4 * k + 4, what.count); ++i) reads += fmt::format("  sums[{}] = mean[{}];\n", i, i % 4);
  }
  const std::string sums_declared = "  float sums[SUM_COUNT];\n";
  return {.draw = head + outputs + what.add + "void draw_glass(float t, float transmission) {\n" + sums_declared +
                  "  sums_of(t, -log(transmission), sums);\n" + writes + "}\n",
          .share = head + samplers + what.share + std::string(mean_body) +
                   "float glass_share(vec2 place, float layer, float t) {\n  vec4 mean;\n" + sums_declared + reads +
                   "  return sums[0] > 0 ? share_of(sums, t) : 1;\n}\n",
          .constants = what.constants,
          .constant_count = what.constant_count};
}

void GlassSums::draw_glass(const GlassDrawing& glass) {
  const int sums = this->sums().count, count = texture_count(sums);
  textures_.resize(static_cast<std::size_t>(count));
  std::vector<GLenum> targets;
  for (int k = 0; k < count; ++k) {
    textures_[k].fit(sums_format(sums, k), glass.resolution(), glass.resolution(), glass.layer_count());
    targets.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(k));
  }
  glNamedFramebufferDrawBuffers(glass.framebuffer, count, targets.data());
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glass.each_image([&](const LightImage& image) {
    for (int k = 0; k < count; ++k) {
      glNamedFramebufferTextureLayer(glass.framebuffer, targets[k], textures_[k].name(), 0, image.layer);
      const float nothing[4] = {};
      glClearNamedFramebufferfv(glass.framebuffer, GL_COLOR, k, nothing);
    }
    glass.draw(image);
  });
}

void GlassSums::bind_glass(const Program& look_up) const {
  for (std::size_t k = 0; k < textures_.size(); ++k) glBindTextureUnit(static_cast<GLuint>(4 + k), textures_[k].name());
  set_constants(look_up);
}

std::size_t GlassSums::glass_bytes() const {
  std::size_t bytes = 0;
  for (const Texture& texture : textures_) bytes += texture.bytes;
  return bytes;
}

}  // namespace gnomon
