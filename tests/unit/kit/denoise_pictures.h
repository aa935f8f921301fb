#pragma once
// G-buffers made by hand, for tests of filters: a wall that faces the eye, from which pictures differ where they say so.
#include <gnomon/kit/denoise/filters.h>

#include <cmath>
#include <vector>

namespace gnomon::denoise_pictures {

struct Wall {
  int width, height;
  std::vector<float> px, py, pz, nx, ny, nz;
  std::vector<std::uint32_t> mesh, triangle;
  std::vector<std::uint8_t> faces;

  /// Mesh 0 in the plane z = 0, seen from 5 meters by a camera of 45 degrees.
  Wall(int w, int h) : width(w), height(h) {
    const std::size_t size = static_cast<std::size_t>(w) * h;
    for (std::vector<float>* plane : {&px, &py, &pz, &nx, &ny, &nz}) plane->assign(size, 0);
    mesh.assign(size, 0);
    triangle.assign(size, 0);
    faces.assign(size, 1);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        px[at(x, y)] = pixel() * (static_cast<float>(x) + 0.5f - static_cast<float>(w) / 2);
        py[at(x, y)] = -pixel() * (static_cast<float>(y) + 0.5f - static_cast<float>(h) / 2);
        nz[at(x, y)] = 1;
      }
  }
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * width + x; }
  std::size_t size() const { return px.size(); }
  float pixel() const { return 10 * std::tan(3.14159265f / 8) / static_cast<float>(height); }
  GBuffer gbuffer() const {
    GBuffer result;
    result.width = width;
    result.height = height;
    result.px = px;
    result.py = py;
    result.pz = pz;
    result.nx = nx;
    result.ny = ny;
    result.nz = nz;
    result.mesh = mesh;
    result.triangle = triangle;
    return result;
  }
  FilterGuides guides() const {
    FilterGuides result;
    result.make(gbuffer(), faces);
    return result;
  }
};

/// Numerators and denominators of 1.
struct Shares {
  std::vector<float> numerators, denominators, variance;
  explicit Shares(std::size_t size, float value = 0) : numerators(size, value), denominators(size, 1), variance(size, 0.25f) {}

  void run(GuidedFilter& filter, const FilterGuides& guides, const FilterRule& rule, int first, int last,
           std::span<const float> strength = {}) {
    const std::span<float> planes[] = {numerators};
    filter.run(guides, rule, first, last, {.denominators = denominators, .numerators = planes, .variance = variance}, strength);
  }
  void run_by_sigma(GuidedFilter& filter, const FilterGuides& guides, std::span<const float> sigma) {
    const std::span<float> planes[] = {numerators};
    filter.run_by_sigma(guides, sigma, {.denominators = denominators, .numerators = planes});
  }
};

}  // namespace gnomon::denoise_pictures
