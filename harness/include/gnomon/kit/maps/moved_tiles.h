#pragma once
#include <gnomon/kit/gl/image_passes.h>
#include <gnomon/kit/maps/light_map.h>

#include <optional>

namespace gnomon {

/// A rectangle that holds all texels of an image at which what is drawn of a box's inside may be seen, with room for rounding.
/// All of a warped image.
PixelRectangle texels_around(const LightCamera& camera, const LightImage& image, const Bounds& box);

/// Tiles of the images of a camera, each as large as Blur's, some of which are marked.
class MarkedTiles {
 public:
  MarkedTiles(int resolution, int layers);
  /// Those that hold any of these texels, or of those up to `around` beside them.
  void mark(int layer, const PixelRectangle& texels, int around);
  /// Of the marked ones: runs along rows, joined with those below that are as wide. They begin and end at multiples of a tile
  /// or at the border, and have no texel in common.
  std::vector<LayerRectangle> rectangles() const;

 private:
  bool is_marked(int layer, int row, int column) const {
    return marks_[(std::size_t(layer) * rows_ + row) * columns_ + column];
  }
  void add_runs(int layer, int row, std::vector<LayerRectangle>& to) const;

  int resolution_, layers_, columns_, rows_;
  std::vector<bool> marks_;
};

/// What one light of a technique keeps beside an image that is filtered, to filter again only what changed: where the casters
/// were that it shows, and how it was made. Keep it with that image, its only one.
class MovedTiles {
 public:
  /// The depths are drawn, and what is made of them will be. The tiles that may differ from those of the drawing before, grown
  /// by the radius of a filter; nothing where all may: where the layer was not kept, or `settings`, all that the filter depends
  /// on beside the camera, are others. Not `drawn` yet.
  std::optional<std::vector<LayerRectangle>> start(const DepthImages& images, const DepthImages::StillLayer& still,
                                                   const LightCamera& camera, const std::string& settings, int radius);
  /// All of the image is as the filter would make it.
  void end() { is_drawn_ = true; }
  std::size_t bytes() const { return places_.size() * sizeof(Bounds) + settings_.size(); }

 private:
  std::vector<LayerRectangle> moved(const MovingMeshes& moving, const LightCamera& camera, int radius) const;

  std::vector<Bounds> places_;  // of meshes; none without layers
  MovingMeshes::Number drawn_at_;
  std::string settings_;
  bool is_drawn_ = false;
};

}  // namespace gnomon
