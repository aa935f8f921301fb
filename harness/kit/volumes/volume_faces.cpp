#include <gnomon/kit/volumes/volume_faces.h>

namespace gnomon {

namespace {

constexpr std::string_view fetch_snippet = R"(
layout(std430, binding = 0) readonly buffer Positions { float positions[]; };
layout(std430, binding = 1) readonly buffer Sides { uvec4 sides[]; };          // low, high, part, 1 when high comes first
layout(std430, binding = 2) readonly buffer Triangles { uint triangles[]; };  // three a triangle, turned to the light
layout(std430, binding = 3) readonly buffer Hubs { vec4 hubs[]; };        // of each part; w = 0: it has none
uniform vec4 light;  // homogeneous
uniform vec4 far_planes[6], far_heights[6];  // the light's height over each plane in x
vec3 fetch(uint v) { return vec3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]); }
// The way of light through p meets plane P, with H = P.p and the light's height P.L, in (P.L) p - H L. Equal points must have
// equal ends in every draw.
vec4 end_of(vec3 p, float end) {
  if (end < 2) return vec4(light.w * p - light.xyz, 0);
  int which = max(int(end) - 2, 0);  // a compiler that computes `end` refuses -2, also where it has returned
  vec4 plane = far_planes[which];
  precise float height = (plane.x * p.x + plane.y * p.y) + (plane.z * p.z + plane.w);
  precise vec4 meets = far_heights[which].x * vec4(p, 1) - height * light;
  return meets;
}
)";

/// Both copies of a quad that two volumes share are cut along the same diagonal and begin at the same vertex: they differ in
/// their turn only, and so cover the very same pixels. A pointed quad is a triangle. A quad for `high_first` runs high, low,
/// the end of low, the end of high.
constexpr std::string_view quad_snippet = R"(
uniform bool pointed;
vec4 quad_corner(uint low, uint high, bool high_first, float end, int corner) {
  if (pointed) {
    const int places[6] = int[](0, 2, 1, 0, 1, 2);
    int which = places[corner + (high_first ? 0 : 3)];
    return which == 0 ? vec4(fetch(low), 1) : which == 1 ? vec4(fetch(high), 1) : vec4(-light.xyz, 0);
  }
  const int places[12] = int[](0, 2, 3, 0, 3, 1, 0, 3, 2, 0, 1, 3);
  int which = places[corner + (high_first ? 0 : 6)];
  vec3 p = fetch((which & 1) == 0 ? low : high);
  return which < 2 ? vec4(p, 1) : end_of(p, end);
}
)";

/// Six vertices an edge, three where volumes are pointed.
constexpr std::string_view sides_body = R"(
void main() {
  int corners = pointed ? 3 : 6;
  uvec4 side = sides[gl_VertexID / corners];
  gl_Position = place(quad_corner(side.x, side.y, side.w != 0, hubs[side.z].w, gl_VertexID % corners));
}
)";

/// The dark cap of a whole part as a fan over its outline: at its end a volume is flat, so only its outline counts.
constexpr std::string_view fan_body = R"(
void main() {
  uvec4 side = sides[gl_VertexID / 3];
  vec4 hub = hubs[side.z];
  int corner = gl_VertexID % 3;
  uint v = (corner == 1) == (side.w != 0) ? side.y : side.x;
  gl_Position = place(hub.w == 0 ? vec4(0) : end_of(corner == 0 ? hub.xyz : fetch(v), hub.w));
}
)";

/// Dark caps triangle by triangle, turned away from the light.
constexpr std::string_view far_triangles_body = R"(
void main() {
  int corner = gl_VertexID % 3;
  gl_Position = place(end_of(fetch(triangles[gl_VertexID - corner + (3 - corner) % 3]), 0));
}
)";

/// Light caps: the triangles of the scene as the depth of the view was drawn, so that they tie with it.
constexpr std::string_view caps_body = "void main() { gl_Position = place(vec4(position, 1)); }";

/// Points may lie on the exact shape, outside what it is tessellated to.
void add_shape(Bounds& box, const Shape& shape) {
  const auto add_ball = [&](const glm::vec3& center, float radius) {
    box.add(center - radius);
    box.add(center + radius);
  };
  if (const auto* sphere = std::get_if<Sphere>(&shape)) add_ball(sphere->center, sphere->radius);
  if (const auto* disc = std::get_if<Disc>(&shape)) add_ball(disc->center, disc->radius);
  if (const auto* cone = std::get_if<Cone>(&shape)) {
    add_ball(cone->base, cone->radius);
    box.add(cone->base + cone->height * glm::normalize(cone->axis));
  }
}

const void* at(std::size_t offset) { return reinterpret_cast<const void*>(offset); }

}  // namespace

bool has_hub(const EdgeAdjacency::Part& part, const glm::dvec4& light) {
  return light.w == 0 || !part.bounds.holds(glm::dvec3(light) / light.w);
}

FarPlanes::FarPlanes(const Scene& scene) {
  Bounds box;
  for (const Mesh& mesh : scene.meshes) {
    if (!mesh.receives) continue;
    box.add(mesh.positions);
    if (mesh.shape) add_shape(box, *mesh.shape);
  }
  is_empty_ = box.empty();
  if (is_empty_) return;
  const glm::dvec3 low = box.min, high = box.max;
  const double apart = extent(high - low) * 0x1p-8 + 0x1p-16 * box.extent();
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec4 &below = planes_[2 * axis], &above = planes_[2 * axis + 1];
    below[axis] = 1;
    below.w = apart - low[axis];
    above[axis] = -1;
    above.w = high[axis] + apart;
  }
}

std::optional<int> FarPlanes::end_of(const EdgeAdjacency::Part& part, const glm::dvec4& light) const {
  if (is_empty_ || !has_hub(part, light)) return std::nullopt;
  std::optional<int> best;
  double least = light.w != 0 ? 0.9 : INFINITY;  // a part as high as the light has its end at infinity
  for (int k = 0; k < 6; ++k) {
    const double light_height = glm::dot(planes_[k], light);
    const int axis = k / 2;
    const double top = planes_[k][axis] * (k % 2 == 0 ? part.bounds.max : part.bounds.min)[axis] + planes_[k].w;
    if (!(light_height > 0) || !(top / light_height < least)) continue;
    least = top / light_height;
    best = k;
  }
  return best;
}

VolumeProgram FaceDrawer::program(std::string_view title, std::string_view body) {
  return VolumeProgram(title, fmt::format("{}{}{}{}", position_snippet, fetch_snippet, quad_snippet, body));
}

GlLimits FaceDrawer::needs(const Scene& scene) {
  std::size_t most = scene.triangle_count();  // a fan reads three buffers: positions, sides, hubs
  for (std::size_t vertices = 0; const Mesh& mesh : scene.meshes) most = std::max(most, vertices += mesh.positions.size());
  return {.vertex_storage_blocks = 3, .storage_bindings = 4, .storage_block_bytes = static_cast<std::int64_t>(12 * most)};
}

void FaceDrawer::setup(std::string_view title) {
  const auto titled = [&](const char* faces) { return fmt::format("{} {}", title, faces); };
  sides_ = program(titled("sides"), sides_body);
  fan_ = program(titled("fan"), fan_body);
  far_triangles_ = program(titled("far triangles"), far_triangles_body);
  caps_ = VolumeProgram(titled("caps"), std::string(position_snippet) + std::string(caps_body));
  vertex_array_ = make_vertex_array();
  glVertexArrayAttribFormat(vertex_array_.name(), 0, 3, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(vertex_array_.name(), 0, 0);
  glEnableVertexArrayAttrib(vertex_array_.name(), 0);
}

void FaceDrawer::bind(const Buffer& positions, const FaceBuffers& faces, const glm::mat4& clip_from_world,
                      const glm::dvec4& light, const FarPlanes* ends, bool by_position) {
  require_storage_block(std::max(faces.sides.bytes(), faces.hubs.bytes()));
  clip_from_world_ = clip_from_world;
  light_ = glm::vec4(light);
  by_position_ = by_position;
  is_pointed_ = WantedFaces{.ends = ends}.are_pointed(light);
  for (int k = 0; ends && k < 6; ++k) {
    far_planes_[k] = glm::vec4((*ends)[k]);
    far_heights_[k] = glm::vec4(glm::dot((*ends)[k], light));
  }
  glVertexArrayVertexBuffer(vertex_array_.name(), 0, positions.name(), 0, sizeof(glm::vec3));
  if (faces.caps.name()) glVertexArrayElementBuffer(vertex_array_.name(), faces.caps.name());
  glBindVertexArray(vertex_array_.name());
  const GLuint storage[] = {positions.name(), faces.sides.name(), faces.triangles.name(), faces.hubs.name()};
  glBindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, 4, storage);
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, faces.commands.name());
}

void FaceDrawer::draw_arrays(const VolumeCounter& counter, const VolumeProgram& program, VolumeFace face,
                             std::size_t offset) const {
  program.each([&](const Program& p) {
    p.set("clip_from_world", clip_from_world_);
    p.set_if_used("light", light_);
    p.set_if_used("pointed", is_pointed_ ? 1 : 0);
    p.set_if_used("by_position", by_position_ ? 1 : 0);
    p.set_if_used("far_planes", std::span<const glm::vec4>(far_planes_));
    p.set_if_used("far_heights", std::span<const glm::vec4>(far_heights_));
  });
  counter.use(program, face);
  glDrawArraysIndirect(GL_TRIANGLES, at(offset));
}

void FaceDrawer::draw_light_caps(const VolumeCounter& counter, const VolumeProgram& program, bool reversed) const {
  counter.use(program, VolumeFace::light_cap, reversed);
  glDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, at(offsetof(FaceCommands, caps)));
  counter.use(program, VolumeFace::light_cap, !reversed);
  glDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, at(offsetof(FaceCommands, reversed_caps)));
}

void FaceDrawer::draw_light_caps(const VolumeCounter& counter) const {
  caps_.each([&](const Program& p) { p.set("clip_from_world", clip_from_world_); });
  draw_light_caps(counter, caps_);
}

void FaceDrawer::draw_caps(const VolumeCounter& counter) const {
  draw_light_caps(counter);
  if (is_pointed_) return;
  draw_arrays(counter, fan_, VolumeFace::dark_cap, offsetof(FaceCommands, fan));
  draw_arrays(counter, far_triangles_, VolumeFace::dark_cap, offsetof(FaceCommands, far_triangles));
}

}  // namespace gnomon
