#include "hemicube.h"

#include <gnomon/kit/geometry/across.h>

#include <array>
#include <numbers>

namespace gnomon::radiosity {

namespace {

constexpr const char* vertex_shader = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in uint id;
uniform mat4 clip_from_world;
flat out uint id_here;
void main() {
  id_here = id;
  gl_Position = clip_from_world * vec4(position, 1);
}
)";
constexpr const char* fragment_shader = R"(
flat in uint id_here;
layout(location = 0) out uint id;
void main() { id = id_here; }
)";

struct Vertex {
  glm::vec3 position;
  std::uint32_t id;
};

/// Clip space of a face: `right`, `up` and `forward` at a right angle, 90 degrees wide; of a side the upper half alone.
glm::mat4 clip_of_face(const glm::dvec3& from, const glm::dvec3& right, const glm::dvec3& up, const glm::dvec3& forward,
                       bool is_upper_half, double near_plane) {
  const glm::dvec3 y = is_upper_half ? 2.0 * up - forward : up;
  const auto row = [&](const glm::dvec3& along) { return glm::dvec4(along, -glm::dot(along, from)); };
  return glm::mat4(glm::transpose(glm::dmat4(row(right), row(y), glm::dvec4(0, 0, 0, near_plane), row(forward))));
}

}  // namespace

std::vector<float> delta_factors(int resolution) {
  const double width = 2.0 / resolution, area = width * width / std::numbers::pi;
  std::vector<float> result;
  const auto add_row = [&](double along, double cosine) {
    for (int column = 0; column < resolution; ++column) {
      const double across = (column + 0.5) * width - 1, square = across * across + along * along + 1;
      result.push_back(static_cast<float>(area * cosine / (square * square)));
    }
  };
  for (int row = 0; row < resolution; ++row) add_row((row + 0.5) * width - 1, 1);
  for (int side = 0; side < 4; ++side)
    for (int row = 0; row < resolution / 2; ++row) add_row(1 - (row + 0.5) * width, 1 - (row + 0.5) * width);
  return result;
}

void Hemicube::setup() {
  program_ = Program("radiosity hemicube", vertex_shader, fragment_shader);
  framebuffer_ = make_framebuffer();
  vertex_array_ = make_vertex_array();
  const GLuint array = vertex_array_.name();
  glVertexArrayAttribFormat(array, 0, 3, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribIFormat(array, 1, 1, GL_UNSIGNED_INT, offsetof(Vertex, id));
  for (const GLuint attribute : {0u, 1u}) {
    glEnableVertexArrayAttrib(array, attribute);
    glVertexArrayAttribBinding(array, attribute, 0);
  }
}

void Hemicube::show(const Division& division, std::span<const std::uint32_t> elements) {
  std::vector<Vertex> vertices;
  Bounds bounds;
  for (std::uint32_t k = 0; k < elements.size(); ++k) {
    const Element& element = division.elements()[elements[k]];
    const std::array outline = division.outline(element);
    for (const glm::dvec3& corner : outline) bounds.add(glm::vec3(corner));
    const auto add = [&](int a, int b, int c) {
      for (const int corner : {a, b, c}) vertices.push_back({glm::vec3(outline[corner]), k + 1});
    };
    add(0, 1, 2);
    if (division.corner_count(element) == 4) add(0, 2, 3);
  }
  vertex_count_ = vertices.size();
  const double size = bounds.empty() ? 0 : extent(bounds.max - bounds.min);
  near_plane_ = size > 0 ? std::ldexp(1.0, std::ilogb(size) - 20) : 1;
  vertices_ = Buffer(vertices.data(), vertices.size() * sizeof(Vertex));
  glVertexArrayVertexBuffer(vertex_array_.name(), 0, vertices_.name(), 0, sizeof(Vertex));
}

void Hemicube::fit(int resolution) {
  if (resolution == resolution_) return;
  resolution_ = resolution;
  ids_texture_.fit(GL_R32UI, resolution, 3 * resolution);
  depth_.fit(GL_DEPTH_COMPONENT32F, resolution, 3 * resolution);
  glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, ids_texture_.name(), 0);
  glNamedFramebufferTexture(framebuffer_.name(), GL_DEPTH_ATTACHMENT, depth_.name(), 0);
  deltas_ = radiosity::delta_factors(resolution);
  ids_.resize(deltas_.size());
}

double Hemicube::look(const glm::dvec3& from, const glm::dvec3& normal, int resolution, std::span<double> shares) {
  const StateGuard guard;
  fit(resolution);
  const GLuint none[4] = {};
  const float far = 0;
  glClearNamedFramebufferuiv(framebuffer_.name(), GL_COLOR, 0, none);
  glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &far);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glUseProgram(program_.name());
  glBindVertexArray(vertex_array_.name());
  const Across across(normal);
  const auto draw = [&](int top, int rows, const glm::mat4& clip) {
    glViewport(0, top, resolution, rows);
    program_.set("clip_from_world", clip);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertex_count_));
  };
  draw(0, resolution, clip_of_face(from, across.u, across.v, normal, false, near_plane_));
  int top = resolution;
  for (const glm::dvec3& forward : {across.u, -across.u, across.v, -across.v}) {
    draw(top, resolution / 2, clip_of_face(from, glm::cross(forward, normal), normal, forward, true, near_plane_));
    top += resolution / 2;
  }
  glGetTextureImage(ids_texture_.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, static_cast<GLsizei>(4 * ids_.size()),
                    ids_.data());
  double nothing = 0;
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    if (ids_[i])
      shares[ids_[i] - 1] += deltas_[i];
    else
      nothing += deltas_[i];
  }
  return nothing;
}

}  // namespace gnomon::radiosity
