#pragma once
// A technique of shadow rays that keeps every rule, and what becomes of it with one fault in it.
#include <gnomon/kit/gl/gl.h>
#include <gnomon/kit/rays/rays.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace gnomon::faulty {

enum class Fault {
  none,
  is_nan,           ///< one pixel of the mask is no number
  writes_half,      ///< the lower half of the mask is not written
  differs,          ///< the second resolve answers otherwise
  casts_all,        ///< meshes that do not cast do
  keeps_light,      ///< the second relight is not heard
  keeps_scene,      ///< nor is the second build
  shares_light,     ///< all objects of the process are lit by the light of the last relight
  says_no_bytes,    ///< no count is named bytes
  says_many_bytes,  ///< a GiB that is not there
  gives_no_reason,  ///< why it does not support a light
  refuses_all,      ///< every light
  throws,           ///< from build
  writes_inputs,    ///< moves a point of the scene
  leaves_state,     ///< blending is on after resolve
  weighs_half,      ///< the weights of its taps sum to one half
  draws_beyond,     ///< a debug layer is brighter than 1
  sends_no_number,  ///< of light at pixel 3
  spoils_later,     ///< the parameter says that it spoils resolve, and is read in build
  is_lit,           ///< everywhere
  is_inverted,      ///< dark where it is lit
  promises_half,    ///< lit everywhere, with at most half of all wrong
  promises_little,  ///< the same, with a thousandth
  has_near_plane,   ///< a pixel nearer than a millimeter is lit
};

inline Light light_of_all;  ///< for shares_light

template <Fault fault>
class Faulty final : public Technique {
 public:
  Flag is_open{this, "is_open", false, fault == Fault::spoils_later ? Stage::resolve : Stage::build, "Whether nothing casts."};

  Support supports(const Scene&, const Light& light, const View&) const override {
    if (fault == Fault::refuses_all) return Support::unsupported("it refuses everything");
    if (!has_area(light) && fault == Fault::promises_half) return Support::approximate("lit", {.most_wrong = 0.5});
    if (!has_area(light) && fault == Fault::promises_little) return Support::approximate("lit", {.most_wrong = 0.001});
    return hard_lights_only(light, fault == Fault::gives_no_reason ? "" : "it has no penumbra");
  }
  void setup() override {}
  void build(const Scene& scene) override {
    if (fault == Fault::throws) throw Error("the tree has no root");
    if (fault == Fault::keeps_scene && casters_) return;
    if (fault == Fault::writes_inputs) const_cast<Scene&>(scene).meshes[0].positions[0].x += 1;
    scene_ = &scene;
    is_open_ = is_open;
    casters_.emplace(scene, Truth::mesh, fault == Fault::casts_all ? RayScene::Which::seen : RayScene::Which::casters);
  }
  void relight(const Light& light) override {
    if (fault == Fault::keeps_light && is_relit_) return;
    is_relit_ = true;
    light_ = light_of_all = light;
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const std::span<float> pixels = mask.pixels();
    std::vector<float> answer(pixels.size(), 1.0f);
    if (!is_open_ && fault != Fault::is_lit && fault != Fault::promises_half && fault != Fault::promises_little)
      trace_shadows(*casters_, *scene_, gbuffer, fault == Fault::shares_light ? light_of_all : light_, answer);
    const std::size_t written = fault == Fault::writes_half ? pixels.size() / 2 : pixels.size();
    std::copy_n(answer.begin(), written, pixels.begin());
    if (fault == Fault::is_nan) pixels[7] = std::numeric_limits<float>::quiet_NaN();
    if (fault == Fault::differs && resolve_count_++ % 2 == 1) pixels[96 * 2 + 5] = 0.5f;
    if (fault == Fault::leaves_state) glEnable(GL_BLEND);
    if (fault == Fault::is_inverted)
      for (std::size_t i = 0; i < pixels.size(); ++i)
        if (faces_light(*scene_, gbuffer, light_, i)) pixels[i] = 1 - pixels[i];
    if (fault == Fault::has_near_plane)
      for (std::size_t i = 0; i < pixels.size(); ++i)
        if (glm::distance(gbuffer.position(i), gbuffer.view.eye) < 1e-3f) pixels[i] = 1;
    picture_size_ = 3 * pixels.size();
  }
  Counts counts() const override {
    if (fault == Fault::says_no_bytes) return {};
    const double bytes = fault == Fault::says_many_bytes ? 1 << 30 : static_cast<double>(casters_ ? casters_->bytes() : 0);
    return {{.name = "bytes", .value = bytes, .unit = "byte"}};
  }
  std::optional<Explanation> explain(std::size_t) const override {
    Explanation why;
    if (fault == Fault::weighs_half) why.taps = {{.direction = {0, 0, 1}, .weight = 0.5}};
    // A texel as fine as a hair in which nothing is stored: that explains no dark pixel.
    if (fault == Fault::is_inverted) {
      why.taps = {{.origin = glm::vec3(homogeneous(light_)), .direction = {0, -1, 0}, .stored = INFINITY}};
      why.texel_width = 1e-6;
    }
    return why;
  }
  std::vector<DebugLayer> debug_layers() const override { return {{.name = "gray", .sentence = "Gray, everywhere."}}; }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer != "gray") return Technique::draw_debug(layer);
    return std::vector<float>(picture_size_, fault == Fault::draws_beyond ? 1.5f : 0.5f);
  }
  std::optional<std::vector<float>> global_picture() const override {
    std::vector<float> dark(picture_size_, 0.0f);
    if (fault == Fault::sends_no_number) dark[9] = NAN;
    return dark;
  }

 private:
  const Scene* scene_ = nullptr;
  std::optional<RayScene> casters_;
  Light light_;
  bool is_open_ = false, is_relit_ = false;
  int resolve_count_ = 0;
  std::size_t picture_size_ = 0;
};

inline constexpr About exact{.title = "Faulty",
                             .summary = "One shadow ray for every pixel, and a fault.",
                             .source = "none",
                             .error = "That of its fault.",
                             .fails = "Where its fault shows.",
                             .promise = Promise::exact};

inline About sampled() {
  About about = exact;
  about.promise = Promise::sampled;
  return about;
}
inline About drawing() {
  About about = exact;
  about.device = Device::opengl;
  return about;
}

template <Fault fault>
TechniqueEntry entry(const About& about = exact) {
  TechniqueEntry result;
  result.id = "faulty";
  result.about = about;
  result.make = [] { return made<Technique, Faulty<fault>>("faulty"); };
  return result;
}

}  // namespace gnomon::faulty
