#pragma once
// What the tests of the viewer's picture share: a frame that is seen, made by hand.
#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "app/viewer/compose.h"
#include "hand_made.h"

namespace hand_made_frame {

using namespace gnomon;
using namespace gnomon::viewer;
using Rgb = std::array<int, 3>;

/// A frame of points on two meshes, with masks and a judged answer, all made by hand.
struct HandMadeFrame {
  std::shared_ptr<hand_made::Picture> picture;
  std::shared_ptr<Frame> frame = std::make_shared<Frame>();
  std::shared_ptr<SideAnswer> answer = std::make_shared<SideAnswer>();
  std::shared_ptr<ReferenceState> reference = std::make_shared<ReferenceState>();
  Verdict verdict;

  /// All points at the origin of a white ground that a sun shines on from above; all tested, lit and right.
  HandMadeFrame(int width, int height) : picture(std::make_shared<hand_made::Picture>(width, height)) {
    auto loaded = std::make_shared<LoadedScene>();
    loaded->scene.ambient = 0.25f;
    loaded->scene.meshes = {hand_made::square(5, 0), hand_made::square(1, 1)};
    loaded->scene.meshes[0].albedo = glm::vec3(1);
    for (std::size_t i = 0; i < picture->mesh.size(); ++i) picture->set(i, {0, 0, 0}, {0, 1, 0}, 0, 0);
    frame->loaded = loaded;
    frame->light = hand_made::sun({0, -1, 0});
    frame->light.intensity = 0.75f;
    frame->picture_width = width;
    frame->picture_height = height;
    answer->frame = reference->frame = frame;
    answer->mask.assign(picture->mesh.size(), 1);
    reference->width = width;
    reference->height = height;
    reference->mask = answer->mask;
    reference->classes.assign(picture->mesh.size(), PixelClass::T);
    verdict.answer = answer;
    verdict.reference = reference;
    verdict.causes.assign(picture->mesh.size(), Cause::none);
    finish();
  }
  /// After the points or the light were changed.
  void finish() {
    frame->gbuffer = picture->gbuffer;
    frame->gbuffer.storage = picture;
    frame->received = received_light(frame->gbuffer, frame->light);
    frame->exposure = exposure_of(scene(), frame->gbuffer, frame->received);
  }
  /// Another answer for a frame, with a reference of its own.
  explicit HandMadeFrame(const std::shared_ptr<Frame>& of) : HandMadeFrame(of->gbuffer.width, of->gbuffer.height) {
    frame = of;
    answer->frame = reference->frame = of;
  }
  Scene& scene() { return const_cast<Scene&>(frame->scene()); }
  ComposeSide side() const { return {frame, answer->mask, frame->gbuffer.width, frame->gbuffer.height, &verdict, nullptr}; }
};

/// One side alone, a picture pixel for a frame pixel.
inline Composition left_of(const HandMadeFrame& seen, Paint paint) {
  Composition c{.width = seen.frame->gbuffer.width, .height = seen.frame->gbuffer.height, .layout = Layout::left};
  c.paint = paint;
  c.sides[0] = seen.side();
  return c;
}

/// A layer of one color on all pixels.
inline LayerPicture layer_of(const HandMadeFrame& seen, const glm::vec3& color) {
  LayerPicture layer{
      .frame = seen.frame, .answer = seen.answer, .layer = {"layer", "What it shows.", {{"a color", color}}}, .rgb = {}};
  for (std::size_t i = 0; i < seen.frame->gbuffer.size(); ++i) layer.rgb.insert(layer.rgb.end(), {color.r, color.g, color.b});
  return layer;
}

inline Rgb rgb(const Color& color) { return {color[0], color[1], color[2]}; }
inline Rgb gray(int level) { return {level, level, level}; }
inline const Rgb false_dark = rgb(cause_infos()[static_cast<int>(Cause::acne) - 1].color),
                 false_lit = rgb(cause_infos()[static_cast<int>(Cause::peter_panning) - 1].color), nothing{24, 26, 30};
// A white lit surface is 255: 70 + 255 * 2 / 5 where tested, 20 + 255 / 5 elsewhere.
inline const Rgb right = gray(172), untested = gray(71);

}  // namespace hand_made_frame
