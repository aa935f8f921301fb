#pragma once
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/technique.h>

namespace gnomon {

/// What a technique that cannot multiply takes casters with transmission for.
enum class GlassAs { opaque, none };

/// Causes of techniques with a GlassSetting, for their About.
inline constexpr OwnCause glass_causes[] = {
    {"no_product",
     "Casters on the way let a part of the light through, which the technique takes for all or none.",
     {56, 136, 96}},
};

/// The parameter `glass` of techniques that hold one depth, or one polygon, where several surfaces each let a part of the light
/// through, and what it means. A member of the technique, which then handles Feature::transmission:
///
///   GlassSetting glass{this};
///   Support supports(...) const override { return glass.limit(scene, Support::full()); }
class GlassSetting {
 public:
  explicit GlassSetting(Parametrized* owner)
      : as_(owner, "glass", "opaque", {"opaque", "none"}, Stage::build,
            "Casters that let a part of the light through: opaque takes their solid parts for opaque; none leaves them out.") {}

  GlassAs as() const { return GlassAs(as_.index()); }
  /// What is left of `support`, the answer of a scene without such casters.
  Support limit(const Scene& scene, const Support& support) const {
    if (!support || !scene.has_transmission()) return support;
    const std::string why = as() == GlassAs::opaque ? "glass is taken for opaque" : "glass is left out";
    return Support::approximate(support.why().empty() ? why : why + ", and " + support.why());
  }

 private:
  Choice as_;
};

/// At which points that changes the answer. Made by a technique's build, at no cost: the first question prepares the rest. It
/// answers about one scene, which must outlive it, and one question at a time.
class GlassDifference {
 public:
  GlassDifference() = default;  ///< nowhere
  GlassDifference(const Scene& scene, GlassAs as) : scene_(scene.has_transmission() ? &scene : nullptr), as_(as) {}

  bool has_glass() const { return scene_ != nullptr; }
  /// One of `glass_causes` where the light that arrives at a point from a homogeneous light differs by more than 1/20 from what
  /// the rule makes of it, else nothing.
  std::string_view cause(const Receiver& receiver, const glm::dvec4& light) const;
  /// The same of a pixel that faces the light. Under a light with area the means over sixteen of its points count.
  std::string_view cause(const GBuffer& gbuffer, const Light& light, std::size_t pixel) const;
  /// Names that cause, if there is one, in place of any other. Where glass is left out, what is drawn may end before its shadow
  /// does: the pixel then counts as covered.
  void explain(Explanation& why, const GBuffer& gbuffer, const Light& light, std::size_t pixel) const;

 private:
  struct Exact;
  /// What the rule makes of the light, less what arrives: -1 .. 1.
  float error(const Receiver& receiver, const glm::dvec4& light) const;

  const Scene* scene_ = nullptr;  ///< null: it has no glass
  GlassAs as_ = GlassAs::opaque;
  mutable std::shared_ptr<const Exact> exact_;  ///< from the first question on
};

}  // namespace gnomon
