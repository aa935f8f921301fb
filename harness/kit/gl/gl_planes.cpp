#include <gnomon/kit/bytes.h>
#include <gnomon/kit/geometry/plane_projection.h>
#include <gnomon/kit/gl/gl_planes.h>

namespace gnomon {

const std::string projection_vertex = std::string(position_snippet) + R"(
uniform vec4 plane;
uniform float tolerance, per_light_height, least_share;
out float gl_ClipDistance[2];
void main() {
  float height = dot(plane.xyz, position) + plane.w;
  gl_ClipDistance[0] = height - tolerance;
  gl_ClipDistance[1] = (1 - height * per_light_height) - least_share;
  gl_Position = place(vec4(position, 1));
#ifdef MASKED
  hand_on_mask();
#endif
}
)";

const std::string_view plane_lookup_snippet = R"(
layout(std430, binding = 0) readonly buffer PlaneOf { uint plane_of[]; };
layout(std430, binding = 1) readonly buffer FirstTriangle { uint first_triangle[]; };
uint receiver_plane(uvec2 ids) { return plane_of[first_triangle[ids.x - 1] + ids.y]; }
)";

void PlaneLookup::build(const Scene& scene, double min_share) {
  planes_ = find_receiver_planes(scene, min_share);
  bounds_.assign(planes_.planes.size(), {});
  is_off_.clear();
  // Under shape truth a pixel on a curved shape says triangle 0: a plane only where the whole mesh lies on one (a disc).
  std::vector<std::uint32_t> of_shapes = planes_.plane_of;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    const std::span planes = std::span(planes_.plane_of).subspan(planes_.first_triangle[m], mesh.triangles.size());
    for (std::size_t t = 0; t < planes.size(); ++t)
      if (planes[t] != no_plane) bounds_[planes[t]].add(mesh.corners(t).points);
    const bool is_flat = std::ranges::all_of(planes, [&](std::uint32_t p) { return p == planes[0]; });
    is_off_.push_back(mesh.has_curved_shape() && !is_flat);
    if (is_off_[m]) std::fill_n(of_shapes.begin() + planes_.first_triangle[m], mesh.triangles.size(), no_plane);
  }
  const auto upload = [](const std::vector<std::uint32_t>& values) { return Buffer(values.data(), values.size() * 4); };
  plane_of_ = upload(planes_.plane_of);
  plane_of_shapes_ = upload(of_shapes);
  first_triangle_ = upload(planes_.first_triangle);
}

std::uint32_t PlaneLookup::plane_of(const GBuffer& gbuffer, std::size_t pixel) const {
  const std::uint32_t mesh = gbuffer.mesh[pixel];
  if (gbuffer.truth == Truth::shape && is_off_[mesh]) return no_plane;
  return planes_.plane_of[planes_.first_triangle[mesh] + gbuffer.triangle[pixel]];
}

void PlaneLookup::bind(Truth truth) const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, (truth == Truth::shape ? plane_of_shapes_ : plane_of_).name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, first_triangle_.name());
}

GlLimits PlaneLookup::needs(const Scene& scene) {
  const std::size_t most = std::max(scene.triangle_count(), scene.meshes.size());
  return {.fragment_storage_blocks = 2, .storage_bindings = 2, .storage_block_bytes = static_cast<std::int64_t>(4 * most)};
}

std::size_t PlaneLookup::bytes() const {
  return plane_of_.bytes + plane_of_shapes_.bytes + first_triangle_.bytes +
         bytes_of(planes_.plane_of, planes_.first_triangle, planes_.planes, bounds_, is_off_);
}

}  // namespace gnomon
