#pragma once
#include <gnomon/kit/volumes/volume_faces.h>

#include <memory>

namespace stencil_volume {
using namespace gnomon;

/// Bytes of `work_` before the facing of the triangles: the commands, counted there and read back.
inline constexpr GLintptr work_header = 128;
static_assert(sizeof(FaceCommands) <= work_header && offsetof(FaceCommands, fan) == 16 && offsetof(FaceCommands, caps) == 64 &&
              offsetof(FaceCommands, reversed_caps) == 84);

inline const std::string finder_head = R"(
layout(local_size_x = 256) in;
layout(std430, binding = 1) readonly buffer Triangles { uvec4 triangles[]; };  // corners and part
layout(std430, binding = 5) buffer Work { uint commands[32]; int facing[]; };
uniform int count;
uniform vec4 light;  // homogeneous
const int sides_count = 0, fan_count = 4, triangle_sides_count = 8, far_count = 12;
const int caps_count = 16, reversed_count = 21, reversed_first = 23;
int item() { return int(gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * 32768u * 256u); }
uniform bool pointed;
uint corners() { return pointed ? 3u : 6u; }
)";

inline const std::string facing_body = R"(
layout(std430, binding = 0) readonly buffer Positions { float positions[]; };
layout(std430, binding = 2) readonly buffer First { uint first[]; };
layout(std430, binding = 3) readonly buffer Hubs { vec4 hubs[]; };
layout(std430, binding = 4) readonly buffer Halves { int halves[]; };
layout(std430, binding = 6) writeonly buffer Caps { uint caps[]; };
layout(std430, binding = 7) writeonly buffer Turned { uint turned[]; };
uniform bool outline, light_caps, dark_caps;
dvec3 fetch(uint v) { return dvec3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]); }
void main() {
  int t = item();
  if (t >= count) return;
  uvec4 triangle = triangles[t];
  int turn = 0;
  if (triangle.w != 0xffffffffu) {
    dvec3 a = fetch(triangle.x);
    double side = dot(cross(fetch(triangle.y) - a, fetch(triangle.z) - a), dvec3(light.xyz) - double(light.w) * a);
    turn = side > 0 ? 1 : side < 0 ? -1 : 0;
    int wanted = halves[triangle.w];
    if (wanted != 0 && turn != wanted) turn = 0;
  }
  facing[t] = turn;
  if (turn == 0) return;
  if (light_caps) {
    uint place = turn > 0 ? atomicAdd(commands[caps_count], 3u) : atomicAdd(commands[reversed_first], 0xfffffffdu) - 3u;
    if (turn < 0) atomicAdd(commands[reversed_count], 3u);
    caps[place] = triangle.x, caps[place + 1] = triangle.y, caps[place + 2] = triangle.z;
  }
  bool far = dark_caps && (!outline || hubs[triangle.w].w == 0);
  if (!outline || far) {
    uint place = outline ? atomicAdd(commands[far_count], 3u) : 0;
    if (!outline) {
      place = atomicAdd(commands[triangle_sides_count], 3u * corners()) / corners();
      if (far) atomicAdd(commands[far_count], 3u);
    }
    uvec3 v = turn > 0 ? triangle.xyz : triangle.xzy;
    turned[place] = first[v.x], turned[place + 1] = first[v.y], turned[place + 2] = first[v.z];
  }
}
)";

/// Where several vertices may be at one position, a side begins as write_faces has it, and an edge without length has none.
inline const std::string add_side = R"(
layout(std430, binding = 3) readonly buffer Positions { float positions[]; };
layout(std430, binding = 6) writeonly buffer Sides { uvec4 sides[]; };
uniform bool dark_caps, by_position;
uniform int side_capacity;
vec3 fetch(uint v) { return vec3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]); }
void add(uint low, uint high, uint part, int times) {
  if (by_position) {
    vec3 a = fetch(low), b = fetch(high);
    if (a == b) return;
    if (b.x != a.x ? b.x < a.x : b.y != a.y ? b.y < a.y : b.z < a.z) {
      uint other = low;
      low = high, high = other, times = -times;
    }
  }
  uint copies = uint(abs(times)), place = atomicAdd(commands[sides_count], corners() * copies) / corners();
  if (dark_caps) atomicAdd(commands[fan_count], 3u * copies);
  for (uint i = 0; i < copies; ++i)
    if (place + i < uint(side_capacity)) sides[place + i] = uvec4(low, high, part, times > 0);
}
)";

inline const std::string edges_body = add_side + R"(
layout(std430, binding = 0) readonly buffer Edges { uvec4 edges[]; };  // low, high, first, second
void main() {
  int e = item();
  if (e >= count) return;
  uvec4 edge = edges[e];
  int times = facing[edge.z] - facing[edge.w];
  if (times != 0) add(edge.x, edge.y, triangles[edge.z].w, times);
}
)";

inline const std::string irregular_body = add_side + R"(
layout(std430, binding = 0) readonly buffer Edges { uvec4 edges[]; };  // low, high, first of `at`, how many
layout(std430, binding = 2) readonly buffer At { uint at[]; };         // triangle times two, plus one for low to high
void main() {
  int e = item();
  if (e >= count) return;
  uvec4 edge = edges[e];
  int times = 0;
  for (uint i = edge.z; i < edge.z + edge.w; ++i) times += (at[i] & 1u) != 0 ? facing[at[i] / 2] : -facing[at[i] / 2];
  if (times != 0) add(edge.x, edge.y, triangles[at[edge.z] / 2].w, times);
}
)";

/// The relight of `finder=gpu`: facing, outline and caps by compute shaders. Facing is decided in double without the exact
/// fallback: a triangle so nearly edge-on that this matters casts a shadow thinner than rounding, whichever way it is turned.
/// The order of the faces in the buffers is not fixed. The set of faces is, and so are the counts.
class GpuFinder {
 public:
  /// Of the device, beside what drawing needs. How many edges there are shows in `build`.
  static GlLimits needs(const Scene& scene) {
    return {.compute_storage_blocks = 8,
            .storage_bindings = 8,
            .storage_block_bytes = static_cast<std::int64_t>(scene.triangle_count() * sizeof(glm::uvec4)),
            .work_group_size = 256,
            .work_groups = 32768};
  }

  void setup() {
    programs_ = std::make_shared<const Programs>(
        Programs{.facing = Program::compute("stencil_volume facing", finder_head + facing_body),
                 .edges = Program::compute("stencil_volume edges", finder_head + edges_body),
                 .irregular = Program::compute("stencil_volume irregular edges", finder_head + irregular_body)});
  }
  /// For other triangles, with the same programs.
  GpuFinder another() const {
    GpuFinder finder;
    finder.programs_ = programs_;
    return finder;
  }

  void build(const EdgeAdjacency& adjacency) {
    std::vector<glm::uvec4> triangles;
    triangles.reserve(adjacency.triangles().size());
    for (std::size_t t = 0; t < adjacency.triangles().size(); ++t)
      triangles.emplace_back(adjacency.triangles()[t], adjacency.part_of()[t]);
    const auto upload = [](const auto& values) {
      require_storage_block(values.size() * sizeof(values[0]));
      return Buffer(values.data(), values.size() * sizeof(values[0]));
    };
    for (Buffer* const old : {&triangles_, &first_, &edges_, &irregular_, &at_irregular_}) *old = {};
    triangles_ = upload(triangles);
    first_ = upload(adjacency.first_at_position());
    edges_ = upload(adjacency.edges());
    irregular_ = upload(adjacency.irregular_edges());
    at_irregular_ = upload(adjacency.sides());
  }

  /// Finds the silhouette of the scene whose buffers these are, and fills the buffers of faces. All of it stays on the device
  /// but the commands.
  FaceCommands find(const SceneBuffers& buffers, const EdgeAdjacency& adjacency, const glm::dvec4& light,
                    const WantedFaces& wanted, FaceBuffers& faces) {
    faces.clear();
    write_hubs(adjacency, light, wanted.ends, faces);
    halves_.rewrite<std::int32_t>(std::max<std::size_t>(adjacency.parts().size(), 1), [&](std::span<std::int32_t> halves) {
      for (std::size_t i = 0; i < adjacency.parts().size(); ++i)
        halves[i] = static_cast<std::int32_t>(adjacency.half(adjacency.parts()[i], light));
    });
    make_room(adjacency, wanted, faces);

    FaceCommands commands = run(buffers, adjacency, light, wanted, faces);
    const std::size_t corners = wanted.are_pointed(light) ? 3 : 6, found = commands.sides.count / corners;
    const bool had_room = found * sizeof(glm::uvec4) <= faces.sides.room();
    faces.sides.reserve(std::max(found * sizeof(glm::uvec4), faces.sides.bytes()));
    if (!had_room) commands = run(buffers, adjacency, light, wanted, faces);
    side_count_ = found;
    if (!wanted.outline) commands.sides.count = commands.fan.count = 0;
    faces.commands.rewrite<FaceCommands>(1, [&](std::span<FaceCommands> mapped) { mapped[0] = commands; });
    return commands;
  }

  /// At least as many volumes as overlap anywhere, from the number of sides alone: an outline that winds w times around a point
  /// has more than 2 w edges, since none of them takes half a turn. None where casters may be all around the light.
  std::optional<std::int64_t> depth_bound(const EdgeAdjacency& adjacency, const glm::dvec4& light) const {
    const auto is_outside = [&](const EdgeAdjacency::Part& part) { return has_hub(part, light); };
    if (!std::ranges::all_of(adjacency.parts(), is_outside)) return std::nullopt;
    return static_cast<std::int64_t>(side_count_ / 2);
  }

  std::size_t bytes() const {
    return triangles_.bytes + first_.bytes + edges_.bytes + irregular_.bytes + at_irregular_.bytes + halves_.bytes() +
           work_.bytes();
  }

 private:
  void make_room(const EdgeAdjacency& adjacency, const WantedFaces& wanted, FaceBuffers& faces) {
    const std::size_t triangle_count = adjacency.triangles().size();
    const std::size_t triangle_bytes = std::max<std::size_t>(triangle_count, 1) * sizeof(glm::uvec3);
    if (wanted.light_caps) faces.caps.reserve(triangle_bytes);
    if (!wanted.outline || wanted.dark_caps) faces.triangles.reserve(triangle_bytes);
    faces.sides.reserve(sizeof(glm::uvec4) * (adjacency.edges().size() / 8 + adjacency.sides().size() + 1));
    work_.reserve(work_header + triangle_count * sizeof(std::int32_t));
  }

  /// Counts all faces, and writes them as far as there is room.
  FaceCommands run(const SceneBuffers& buffers, const EdgeAdjacency& adjacency, const glm::dvec4& light,
                   const WantedFaces& wanted, const FaceBuffers& faces) {
    FaceCommands commands;
    commands.reversed_caps.first_index = static_cast<std::uint32_t>(3 * adjacency.triangles().size());
    glNamedBufferSubData(work_.name(), 0, sizeof(commands), &commands);
    // Buffers from binding 0 on; 0 where the program has none.
    const auto dispatch = [&](const Program& program, std::size_t count, std::initializer_list<GLuint> names) {
      if (count == 0) return;
      for (GLuint binding = 0; const GLuint name : names) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding++, name);
      const auto set = [&](const char* uniform, const auto& value) { program.set_if_used(uniform, value); };
      set("count", static_cast<int>(count));
      set("light", glm::vec4(light));  // exact: the light's floats
      set("outline", wanted.outline ? 1 : 0);
      set("pointed", wanted.are_pointed(light) ? 1 : 0);
      set("light_caps", wanted.light_caps ? 1 : 0);
      set("dark_caps", wanted.dark_caps ? 1 : 0);
      set("by_position", adjacency.has_meeting_vertices() ? 1 : 0);
      set("side_capacity", static_cast<int>(faces.sides.room() / sizeof(glm::uvec4)));
      glUseProgram(program.name());
      // Rows of groups: one row holds no more than every device allows.
      const auto groups = static_cast<GLuint>((count + 255) / 256), rows = (groups + 32767) / 32768;
      glDispatchCompute(rows > 1 ? 32768 : groups, rows, 1);
      glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    };
    dispatch(programs_->facing, adjacency.triangles().size(),
             {buffers.positions.name(), triangles_.name(), first_.name(), faces.hubs.name(), halves_.name(), work_.name(),
              faces.caps.name(), faces.triangles.name()});
    dispatch(programs_->edges, adjacency.edges().size(),
             {edges_.name(), triangles_.name(), 0, buffers.positions.name(), 0, work_.name(), faces.sides.name()});
    dispatch(programs_->irregular, adjacency.irregular_edges().size(),
             {irregular_.name(), triangles_.name(), at_irregular_.name(), buffers.positions.name(), 0, work_.name(),
              faces.sides.name()});
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    glGetNamedBufferSubData(work_.name(), 0, sizeof(commands), &commands);
    return commands;
  }

  struct Programs {
    Program facing, edges, irregular;
  };
  std::shared_ptr<const Programs> programs_;
  Buffer triangles_, first_, edges_, irregular_, at_irregular_;
  RewrittenBuffer halves_, work_;
  std::size_t side_count_ = 0;  // of the last `find`
};

}  // namespace stencil_volume
