// Adds the shadows of a sphere and a cone to a drawing of the ground, y = 0.
//   planar_shadow [HEIGHT]       the outlines as points of the plane, one homogeneous point (x y z w) a line
//   planar_shadow svg [HEIGHT]   the ground seen from above: the shadows, and the circle and triangle that the paper draws
// HEIGHT is the light's, 5 unless told otherwise; with 1.5 it is below the sphere's top, and the shadow has no end.
// To build it, CMake needs find_package(gnomon) and target_link_libraries(planar_shadow gnomon::gnomon).
#include <fmt/format.h>
#include <gnomon/kit/geometry/planar_shadow.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

using namespace gnomon;
using Loop = std::vector<glm::dvec4>;

// What a program with a drawing loop does with a loop: it goes to the vertex buffer as it is, four floats a point, is drawn as
// a GL_TRIANGLE_FAN, and the vertex shader says
//     layout(location = 0) in vec4 point;  uniform mat4 clip_from_world;
//     void main() { gl_Position = clip_from_world * point; }
// Nobody divides by w. The pipeline clips, so points at infinity (w = 0) need no care. Loops overlap where shadows do: to
// darken once, draw the ground with stencil 1, all else with 0, and then the loops with glStencilFunc(GL_EQUAL, 1, 0xff),
// glStencilOp(GL_KEEP, GL_KEEP, GL_INCR) and no depth test, since they lie in the ground.

/// Of a picture from above; a point at infinity becomes one a kilometer away in its direction.
std::string path_of(const Loop& loop) {
  std::string path;
  for (const glm::dvec4& p : loop) {
    const double w = std::max(p.w, 1e-3 * glm::length(glm::dvec3(p)));
    path += fmt::format("{}{:.4f},{:.4f} ", path.empty() ? "M" : "L", p.x / w, p.z / w);
  }
  return path + "Z ";
}

void append(std::vector<Loop>& loops, const PlanarShadow& shadow) {
  for (const Loop& loop : shadow.outlines(48)) loops.push_back(loop);
}

int main(int argc, char** argv) {
  const bool is_picture = argc > 1 && argv[1] == std::string_view("svg");
  const double height = argc > (is_picture ? 2 : 1) ? std::atof(argv[argc - 1]) : 5;
  const glm::dvec4 ground(0, 1, 0, 0), light(4, height, 2, 1);
  const Shape shapes[] = {Sphere{.center = {-0.5f, 1, -1.2f}, .radius = 0.8f},
                          Cone{.base = {0, 0, 1.5f}, .axis = {0, 1, 0}, .radius = 0.8f, .height = 1.2f}};
  std::vector<Loop> exact, paper;
  for (const Shape& shape : shapes) {
    if (const std::string why = PlanarShadow::objection(shape, light, ground, ShadowForm::exact); !why.empty()) {
      fmt::print(stderr, "no shadow: {}\n", why);
      return 2;
    }
    append(exact, PlanarShadow(shape, light, ground));
    if (PlanarShadow::objection(shape, light, ground, ShadowForm::paper).empty())
      append(paper, PlanarShadow(shape, light, ground, ShadowForm::paper));
  }
  if (!is_picture) {
    for (const Loop& loop : exact)
      for (const glm::dvec4& p : loop) fmt::print("{} {:.9g} {:.9g} {:.9g} {:.9g}\n", &loop - exact.data(), p.x, p.y, p.z, p.w);
    return 0;
  }
  // All loops turn the same way, so that one path filled by the rule `nonzero` is their union.
  std::string dark, drawn;
  for (const Loop& loop : exact) dark += path_of(loop);
  for (const Loop& loop : paper) drawn += path_of(loop);
  fmt::print(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-6 -4 9 7\" width=\"900\" height=\"700\">\n"
      "<rect x=\"-6\" y=\"-4\" width=\"9\" height=\"7\" fill=\"#e8e4d8\"/>\n"
      "<path d=\"{}\" fill=\"#5a5a66\" fill-rule=\"nonzero\"/>\n"
      "<path d=\"{}\" fill=\"none\" stroke=\"#c03020\" stroke-width=\"0.03\"/>\n",
      dark, drawn);
  fmt::print(
      "<circle cx=\"-0.5\" cy=\"-1.2\" r=\"0.8\" fill=\"#7090c0\"/>\n<circle cx=\"0\" cy=\"1.5\" r=\"0.8\" fill=\"#c0a060\"/>\n"
      "</svg>\n");
}
