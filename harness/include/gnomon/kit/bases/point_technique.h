#pragma once
#include <gnomon/kit/counts.h>
#include <gnomon/kit/geometry/receiver.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/shared.h>

#include <concepts>

namespace gnomon {

/// What the techniques share that decide the visible points one by one, on the processor, by the scene's triangles, for a light
/// without area: the element that `explain` names is the triangle that shades a point, counted over the scene mesh after mesh.
class PointTechnique : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    return hard_lights_only(light, why_no_area());
  }
  void setup() override {}
  std::optional<Explanation> explain(std::size_t index) const override {
    if (!faces_light(*gbuffer_, index)) return std::nullopt;
    Explanation why;
    if (const std::uint32_t triangle = shading_triangle(index); triangle != nothing) why.element = triangle;
    return why;
  }

 protected:
  static constexpr std::uint32_t nothing = 0xffffffffu;

  /// Why a light with area is refused.
  virtual const char* why_no_area() const = 0;
  /// The triangle that shades pixel `index` of the last resolve, which faces the light, or `nothing`; behind transmission alone
  /// the first of those that let least through.
  virtual std::uint32_t shading_triangle(std::size_t index) const = 0;

  void remember(const Scene& scene) {
    remembered_->scene = &scene;
    remembered_->numbers = TriangleNumbers(scene);
  }
  bool faces_light(const GBuffer& gbuffer, std::size_t i) const {
    return gnomon::faces_light(*remembered_->scene, gbuffer, light_, i);
  }
  NumberedReceiver receiver(const GBuffer& gbuffer, std::size_t i) const {
    return remembered_->numbers.numbered(receiver_at(*remembered_->scene, gbuffer, i));
  }
  /// Calls decide(pixel, work) for every pixel that faces the light, in tiles of 16 x 16 on all threads: neighbors take much
  /// the same ways. Each thread has copies of `start` to work with; returns their sum.
  template <class Work, std::invocable<std::size_t, Work&> Decide>
  Work for_facing_pixels(const GBuffer& gbuffer, const Work& start, const Decide& decide) const;
  /// A debug layer of `heat_layer`: values of the pixels that face the light, 0 elsewhere.
  template <std::invocable<std::size_t> Value>
  std::vector<float> heat_of(const Value& value) const;

  struct Remembered {
    const Scene* scene = nullptr;
    TriangleNumbers numbers;
  };
  Shared<Remembered> remembered_;
  const GBuffer* gbuffer_ = nullptr;  // of the last resolve
  Light light_;
};

/// Calls visit(a, b, c, mesh, number) with the corners of each triangle of a scene, counted mesh after mesh.
template <std::invocable<const glm::vec3&, const glm::vec3&, const glm::vec3&, std::uint32_t, std::uint32_t> Visit>
void for_triangles(const Scene& scene, const Visit& visit) {
  std::uint32_t number = 0;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const glm::vec3* const p = scene.meshes[m].positions.data();
    for (const glm::uvec3& t : scene.meshes[m].triangles) visit(p[t.x], p[t.y], p[t.z], m, number++);
  }
}

/// Into `signs`: orient3d_sign of each triangle's corners and a homogeneous light, on all threads; 0: edge-on.
template <class Of>
void find_facing(const std::vector<Of>& triangles, const glm::dvec4& light, std::vector<std::int8_t>& signs) {
  signs.resize(triangles.size());
  for_blocks(triangles.size(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::vec3* const p = triangles[i].points;
      signs[i] = static_cast<std::int8_t>(orient3d_sign(p[0], p[1], p[2], light));
    }
  });
}

template <class Work, std::invocable<std::size_t, Work&> Decide>
Work PointTechnique::for_facing_pixels(const GBuffer& gbuffer, const Work& start, const Decide& decide) const {
  constexpr int side = 16;
  constexpr std::size_t block = 8;  // of tiles
  const std::size_t columns = (gbuffer.width + side - 1) / side, rows = (gbuffer.height + side - 1) / side;
  std::vector<Work> works((columns * rows + block - 1) / block, start);
  for_blocks(columns * rows, block, [&](std::size_t begin, std::size_t end) {
    Work& work = works[begin / block];
    for (std::size_t tile = begin; tile < end; ++tile) {
      const int left = static_cast<int>(tile % columns) * side, top = static_cast<int>(tile / columns) * side;
      for (int y = top; y < std::min(top + side, gbuffer.height); ++y)
        for (int x = left; x < std::min(left + side, gbuffer.width); ++x)
          if (const std::size_t i = static_cast<std::size_t>(y) * gbuffer.width + x; faces_light(gbuffer, i)) decide(i, work);
    }
  });
  Work sum = start;
  for (const Work& work : works) sum += work;
  return sum;
}

template <std::invocable<std::size_t> Value>
std::vector<float> PointTechnique::heat_of(const Value& value) const {
  std::vector<float> values(gbuffer_->size(), 0);
  for_blocks(values.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (faces_light(*gbuffer_, i)) values[i] = static_cast<float>(value(i));
  });
  return heat_layer(*gbuffer_, values);
}

}  // namespace gnomon
