#include <gnomon/kit/maps/moved_tiles.h>

namespace gnomon {

PixelRectangle texels_around(const LightCamera& camera, const LightImage& image, const Bounds& box) {
  const PixelRectangle whole{0, 0, camera.resolution, camera.resolution};
  if (box.empty()) return {};
  if (image.lean != 0) return whole;
  // What shaders round, once more than in `rounding`, for it counts lengths along the axis alone.
  const glm::vec3 room(static_cast<float>(2 * camera.rounding));
  const glm::dvec2 side(camera.resolution);
  const glm::dvec2 widest = glm::max(glm::abs(image.window_of({0, 0})), glm::abs(image.window_of(side)));
  const LightExtent seen = seen_of(image, {box.min - room, box.max + room}, std::max(widest.x, widest.y) * (1 + 0x1p-10));
  if (seen.empty()) return {};
  // Two texels: for the raster of subpixels, and for rounding here.
  const glm::dvec2 low = glm::floor(image.texel_of(seen.low)) - 2.0, high = glm::ceil(image.texel_of(seen.high)) + 2.0;
  if (!glm::all(glm::lessThanEqual(low, high))) return whole;  // they are no numbers
  const glm::ivec2 first(glm::clamp(low, glm::dvec2(0), side)), last(glm::clamp(high, glm::dvec2(0), side));
  return {first.x, first.y, last.x, last.y};
}

MarkedTiles::MarkedTiles(int resolution, int layers)
    : resolution_(resolution),
      layers_(layers),
      columns_((resolution + Blur::tile_width - 1) / Blur::tile_width),
      rows_((resolution + Blur::tile_height - 1) / Blur::tile_height),
      marks_(std::size_t(layers) * rows_ * columns_) {}

void MarkedTiles::mark(int layer, const PixelRectangle& texels, int around) {
  if (texels.left >= texels.right || texels.top >= texels.bottom) return;
  const auto first = [&](int from, int tile) { return std::max(from - around, 0) / tile; };
  const auto end = [&](int to, int tile) { return (std::min(to + around, resolution_) + tile - 1) / tile; };
  const int left = first(texels.left, Blur::tile_width), right = end(texels.right, Blur::tile_width);
  const int top = first(texels.top, Blur::tile_height), bottom = end(texels.bottom, Blur::tile_height);
  for (int row = top; row < bottom; ++row)
    for (int column = left; column < right; ++column) marks_[(std::size_t(layer) * rows_ + row) * columns_ + column] = true;
}

void MarkedTiles::add_runs(int layer, int row, std::vector<LayerRectangle>& to) const {
  for (int first = 0, end; first < columns_; first = end) {
    end = first + 1;
    if (!is_marked(layer, row, first)) continue;
    while (end < columns_ && is_marked(layer, row, end)) ++end;
    const int left = first * Blur::tile_width, right = std::min(end * Blur::tile_width, resolution_);
    const int top = row * Blur::tile_height, bottom = std::min(top + Blur::tile_height, resolution_);
    const auto ends_above = [&](const LayerRectangle& r) {
      return r.layer == layer && r.texels.bottom == top && r.texels.left == left && r.texels.right == right;
    };
    const auto above = std::ranges::find_if(to, ends_above);
    if (above != to.end())
      above->texels.bottom = bottom;
    else
      to.push_back({layer, {left, top, right, bottom}});
  }
}

std::vector<LayerRectangle> MarkedTiles::rectangles() const {
  std::vector<LayerRectangle> all;
  for (int layer = 0; layer < layers_; ++layer)
    for (int row = 0; row < rows_; ++row) add_runs(layer, row, all);
  return all;
}

std::vector<LayerRectangle> MovedTiles::moved(const MovingMeshes& moving, const LightCamera& camera, int radius) const {
  MarkedTiles tiles(camera.resolution, camera.layer_count);
  for (const LightImage& image : camera.images) {
    if (image.layer < 0) continue;
    for (const std::uint32_t m : image.casters) {
      if (!moving.moves(m) || !moving.moved_after(m, drawn_at_)) continue;
      tiles.mark(image.layer, texels_around(camera, image, places_[m]), radius);
      tiles.mark(image.layer, texels_around(camera, image, moving.place(m)), radius);
    }
  }
  return tiles.rectangles();
}

std::optional<std::vector<LayerRectangle>> MovedTiles::start(const DepthImages& images, const DepthImages::StillLayer& still,
                                                             const LightCamera& camera, const std::string& settings,
                                                             int radius) {
  const MovingMeshes& moving = images.moving();
  std::optional<std::vector<LayerRectangle>> found;
  if (is_drawn_ && still.was_kept() && settings == settings_) found = moved(moving, camera, radius);
  is_drawn_ = false;
  places_.clear();
  settings_.clear();
  if (!still.is_used()) return found;
  for (std::size_t m = 0; m < images.boxes().meshes.size(); ++m) places_.push_back(moving.place(m));
  settings_ = settings;
  drawn_at_ = moving.number();
  return found;
}

}  // namespace gnomon
