#pragma once
#include <gnomon/kit/area/light_figure.h>
#include <gnomon/kit/geometry/receiver.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/pixel_groups.h>
#include <gnomon/kit/scratch_pool.h>
#include <gnomon/kit/shared.h>

#include <algorithm>
#include <concepts>

namespace gnomon {

/// What the techniques share that decide the visible points on the processor, neighbors together, for lights with area: a query
/// gathers the casters that a group of pixels may need, and the group is halved while these are many.
///
/// `Casters` is made of a scene by `build`, once for all lights, and has scene() and numbers(). `Query` is what one thread
/// works with. `Tally` counts the work of a resolve; it has +=.
template <class Casters, class Query, class Tally>
class AreaPointTechnique : public Technique {
 public:
  void setup() override {}
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;

 protected:
  /// Finds what the points may need: at level 0 anew, at others in what the level above has found, of which they are a part.
  /// True where that is so much that halves of the points are worth a level of their own.
  virtual bool gather(Query& query, std::size_t level, const PixelGroup& points) const = 0;
  /// Before `share` of the points of the last level.
  virtual void begin_shares(Query&, const PixelGroup&) const {}
  /// The share of the light that a pixel sees. Some of the figure is above its horizon.
  virtual double share(Query& query, std::size_t pixel, const LightFigure& figure, Tally& tally) const = 0;

  NumberedReceiver receiver(std::size_t pixel) const {
    return built_->numbers().numbered(receiver_at(built_->scene(), *gbuffer_, pixel));
  }
  /// Decides one pixel of the last resolve by itself, then calls use(query, figure); not where no light can arrive.
  template <std::invocable<Query&, const LightFigure&> Use>
  void query_pixel(std::size_t pixel, const Use& use) const;
  /// A debug layer of `heat_layer`: value(query) of every such pixel.
  template <std::invocable<const Query&> Value>
  std::vector<float> heat_of(const Value& value) const;

  Shared<Casters> built_;
  Light light_;
  const GBuffer* gbuffer_ = nullptr;  // of the last resolve
  Tally tally_;                       // likewise

 private:
  bool receives(std::size_t pixel) const {
    return !gbuffer_->is_background(pixel) && built_->scene().meshes[gbuffer_->mesh[pixel]].receives;
  }
  LightFigure figure(std::size_t pixel) const { return {light_, gbuffer_->position(pixel), gbuffer_->normal(pixel)}; }

  mutable ScratchPool<Query> pool_;
};

template <class Casters, class Query, class Tally>
void AreaPointTechnique<Casters, Query, Tally>::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  gbuffer_ = &gbuffer;
  const std::span<float> out = mask.pixels();
  std::ranges::fill(out, 1.0f);
  std::vector<Tally> tallies(tile_count(gbuffer));
  for_pixel_groups(
      gbuffer, [&](std::size_t i) { return receives(i); }, [&] { return pool_.borrow(); },
      [&](std::span<std::uint32_t> pixels, std::size_t tile, Query& query) {
        for_narrow_groups(
            gbuffer, pixels, [&](std::size_t level, const PixelGroup& group) { return gather(query, level, group); },
            [&](const PixelGroup& group, std::span<const std::uint32_t> some) {
              begin_shares(query, group);
              for (const std::uint32_t i : some)
                if (const LightFigure light = figure(i); light.is_seen())
                  out[i] = static_cast<float>(share(query, i, light, tallies[tile]));
            });
      });
  tally_ = {};
  for (const Tally& tally : tallies) tally_ += tally;
}

template <class Casters, class Query, class Tally>
template <std::invocable<Query&, const LightFigure&> Use>
void AreaPointTechnique<Casters, Query, Tally>::query_pixel(std::size_t pixel, const Use& use) const {
  if (!receives(pixel)) return;
  const LightFigure light = figure(pixel);
  if (!light.is_seen()) return;
  const auto query = pool_.borrow();
  const auto index = static_cast<std::uint32_t>(pixel);
  const PixelGroup group = group_of(*gbuffer_, {&index, 1});
  gather(*query, 0, group);
  begin_shares(*query, group);
  Tally tally;
  share(*query, pixel, light, tally);
  use(*query, light);
}

template <class Casters, class Query, class Tally>
template <std::invocable<const Query&> Value>
std::vector<float> AreaPointTechnique<Casters, Query, Tally>::heat_of(const Value& value) const {
  std::vector<float> values(gbuffer_->size(), 0);
  for_blocks(values.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      query_pixel(i, [&](const Query& query, const LightFigure&) { values[i] = static_cast<float>(value(query)); });
  });
  return heat_layer(*gbuffer_, values);
}

}  // namespace gnomon
