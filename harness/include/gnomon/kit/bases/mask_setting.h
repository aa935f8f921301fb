#pragma once
#include <gnomon/kit/geometry/cut_masks.h>
#include <gnomon/technique.h>

#include <algorithm>

namespace gnomon {

/// The parameters `mask` and `mask_limit` of techniques that see casters with holes as polygons, and what they mean. A member
/// of the technique:
///
///   MaskSetting masks{this};
///   Support supports(...) const override { return masks.limit(scene, Support::full()); }
///   void build(const Scene& scene) override { built_->cut = masks.cut(scene); }
class MaskSetting {
 public:
  explicit MaskSetting(Parametrized* owner)
      : mask_(
            owner, "mask", "cut", {"cut", "filled"}, Stage::build,
            "Casters with holes: cut takes the solid parts of their alpha masks, as polygons; filled takes whole triangles, as "
            "if they had no holes."),
        most_(owner, "mask_limit", 200'000, {.unit = "polygons", .min = 1, .max = 10'000'000, .log = true}, Stage::build,
              "Casters with holes: the most polygons that the alpha masks of a scene may be cut into; with more it is not "
              "supported.") {}

  /// What is left of `support`, the answer of a scene without holes: cut corners are within what pixels of class U allow for,
  /// and change nothing.
  Support limit(const Scene& scene, Support support) const {
    if (!support || std::ranges::none_of(scene.meshes, casts_with_holes)) return support;
    if (mask_.is("filled"))
      return Support::approximate(support.why().empty() ? "holes are filled" : "holes are filled, and " + support.why());
    const auto most = static_cast<std::size_t>(most_.value());
    const CutCount count = cut_count(scene, most);
    if (!count.is_more && count.pieces <= most) return support;
    return Support::unsupported(fmt::format("alpha masks make {}{} polygons; mask_limit allows {}",
                                            count.is_more ? "more than " : "", count.pieces, most));
  }
  CutMasks cut(const Scene& scene, CutMasks::Drawn drawn = CutMasks::Drawn::triangles) const {
    return mask_.is("cut") ? CutMasks(scene, static_cast<std::size_t>(most_.value()), drawn) : CutMasks(scene);
  }

 private:
  Choice mask_;
  Number<int> most_;
};

}  // namespace gnomon
