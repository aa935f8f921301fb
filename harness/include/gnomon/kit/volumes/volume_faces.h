#pragma once
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/volumes/gl_volumes.h>

namespace gnomon {

// The faces of the shadow volumes of triangles: what is drawn of a scene under one light, on the device, and its drawing in the
// passes of a VolumeCounter. A face names vertices of the scene, so that a light changes a list of edges and one of triangles
// and nothing else. A volume has a side quad for every silhouette edge, light caps, which are the triangles that face the
// light, and dark caps where it ends: a fan over the outline where the part has a hub, its triangles elsewhere. It ends at
// infinity, or, if FarPlanes are requested, where nothing receives any more: what lies beyond is filled for nothing. At
// infinity the volume of a directional light ends in one point: its sides are triangles, and it has no dark cap.

struct DrawArrays {
  std::uint32_t count = 0, instances = 1, first = 0, base_instance = 0;
};
struct DrawElements {
  std::uint32_t count = 0, instances = 1, first_index = 0, base_vertex = 0, base_instance = 0;
};
/// What is drawn, as the device reads it from a buffer of indirect draws. Counts are of corners.
struct FaceCommands {
  DrawArrays sides;            ///< side quads of the outline
  DrawArrays fan;              ///< dark caps over the outline
  DrawArrays triangle_sides;   ///< side quads triangle by triangle
  DrawArrays far_triangles;    ///< dark caps triangle by triangle
  DrawElements caps;           ///< light caps, counter-clockwise seen from the light
  DrawElements reversed_caps;  ///< clockwise

  std::size_t triangle_count() const {
    const std::size_t of_caps = std::size_t{caps.count} + reversed_caps.count;
    return (of_caps + sides.count + fan.count + triangle_sides.count + far_triangles.count) / 3;
  }
};

/// A buffer that is written anew by every light, and grows when it must. It keeps its room when a light needs less, or nothing.
class RewrittenBuffer {
 public:
  /// Makes room for `count` elements of T, and calls fill(span<T>) on the mapped memory, whose old contents are gone.
  template <class T, class Fill>
  void rewrite(std::size_t count, Fill&& fill) {
    reserve(count * sizeof(T));
    if (count == 0) return;
    fill(std::span<T>(static_cast<T*>(map(0, count * sizeof(T), GL_MAP_INVALIDATE_BUFFER_BIT)), count));
    unmap();
  }
  /// Calls fill(span<T>) on the memory of some elements of what is there; the others keep what they hold.
  template <class T, class Fill>
  void rewrite_part(std::size_t first, std::size_t count, Fill&& fill) {
    if (count == 0) return;
    fill(std::span<T>(static_cast<T*>(map(first * sizeof(T), count * sizeof(T), GL_MAP_INVALIDATE_RANGE_BIT)), count));
    unmap();
  }
  template <class T>
  void rewrite(const std::vector<T>& values) {
    rewrite<T>(values.size(), [&](std::span<T> mapped) { std::ranges::copy(values, mapped.begin()); });
  }
  void reserve(std::size_t bytes);
  /// Has so many bytes from now on, with what is written in them, where there is room; otherwise answers false and does
  /// nothing.
  bool resize(std::size_t bytes);
  void clear() { bytes_ = 0; }
  GLuint name() const { return buffer_.name(); }
  std::size_t bytes() const { return bytes_; }        ///< what was reserved since the last `clear`
  std::size_t room() const { return buffer_.bytes; }  ///< at least as much; how much more depends on earlier lights

 private:
  void* map(std::size_t first, std::size_t bytes, GLbitfield loses);
  void unmap();
  Buffer buffer_;
  std::size_t bytes_ = 0;
};

/// The faces of all volumes under one light, on the device.
struct FaceBuffers {
  /// uvec4: low, high, part, 1 where high comes first. Where several vertices may be at one position, low is the end with the
  /// smaller coordinates in place of the smaller number.
  RewrittenBuffer sides;
  RewrittenBuffer triangles;  ///< three uint32 a triangle, turned to the light: for sides and dark caps triangle by triangle
  RewrittenBuffer caps;       ///< three uint32 a triangle, as its mesh winds it
  /// vec4 of each part: the point that its fan turns about, and in w where its volume ends: 0 at infinity, without a fan, 1 at
  /// infinity, 2 + k on far plane k.
  RewrittenBuffer hubs;
  RewrittenBuffer commands;  ///< FaceCommands

  void clear() {
    for (RewrittenBuffer* const buffer : {&sides, &triangles, &caps, &hubs, &commands}) buffer->clear();
  }
  std::size_t bytes() const { return sides.bytes() + triangles.bytes() + caps.bytes() + hubs.bytes() + commands.bytes(); }
};

/// The planes of a box around everything that receives, 1/256 of its size apart from it, each turned inward. A flat end is
/// as good as an infinite one for every point inside, if the light is on the inner side of the plane, above the whole part.
class FarPlanes {
 public:
  FarPlanes() = default;
  explicit FarPlanes(const Scene& scene);
  /// Of six, the plane on which the volume of a part ends soonest; none: only at infinity.
  std::optional<int> end_of(const EdgeAdjacency::Part& part, const glm::dvec4& light) const;
  const glm::dvec4& operator[](int k) const { return planes_[k]; }
  bool empty() const { return is_empty_; }

 private:
  std::array<glm::dvec4, 6> planes_{};
  bool is_empty_ = true;  ///< nothing receives
};

/// Which faces a count needs.
struct WantedFaces {
  bool outline = true;              ///< side quads of the outline, else of every triangle
  bool light_caps = true;           ///< for z-fail, and for a near cap
  bool dark_caps = true;            ///< for z-fail, unless the volumes end in one point
  const FarPlanes* ends = nullptr;  ///< where volumes may end, which takes outline and dark caps; null: at infinity
  bool operator==(const WantedFaces&) const = default;

  /// Whether all sides are triangles that end in one point.
  bool are_pointed(const glm::dvec4& light) const { return light.w == 0 && !ends; }
};

/// Whether the dark cap of a part can be a fan about the middle of its bounds: if the light is outside them, no caster lies in
/// the direction opposite to the fan's middle, where fan and caps would disagree.
bool has_hub(const EdgeAdjacency::Part& part, const glm::dvec4& light);
/// The hubs of all parts.
void write_hubs(const EdgeAdjacency& adjacency, const glm::dvec4& light, const FarPlanes* ends, FaceBuffers& faces);

/// Fills all buffers from a silhouette, on all threads; the order of faces does not depend on their number.
FaceCommands write_faces(const EdgeAdjacency& adjacency, const Silhouette& silhouette, const WantedFaces& wanted,
                         FaceBuffers& faces);

/// The same over what it wrote before, which gave `before`, for the same light and wanted faces: only of the triangles
/// `refaced` some may face the light otherwise. Writes what may have changed, and the same bytes as write_faces.
FaceCommands rewrite_faces(const EdgeAdjacency& adjacency, const Silhouette& silhouette, const WantedFaces& wanted,
                           const Refaced& refaced, const FaceCommands& before, FaceBuffers& faces);

/// Draws the faces.
class FaceDrawer {
 public:
  /// A program of a vertex shader that fetches vertices by number. Its source has, behind position_snippet, the buffers of
  /// FaceBuffers at bindings 1 to 3, `vec4 light` and `bool pointed`; it may declare `bool by_position`, see `bind`. It offers
  /// `vec3 fetch(uint vertex)`, `vec4 end_of(vec3 p, float end)` for an end as hubs have it, and `vec4 quad_corner(uint low,
  /// uint high, bool high_first, float end, int corner)`, a corner of the six (pointed: three) of a side.
  static VolumeProgram program(std::string_view title, std::string_view body);

  /// What any drawing of the volumes of this scene's triangles needs of the device; how many sides they have shows later.
  static GlLimits needs(const Scene& scene);

  void setup(std::string_view title);
  /// Before any draw of a pass. `positions` holds the vertices of the adjacency's scene, tightly packed; `by_position` says
  /// whether several of them may be at one position. Throws Error where the device cannot read that many sides.
  void bind(const Buffer& positions, const FaceBuffers& faces, const glm::mat4& clip_from_world, const glm::dvec4& light,
            const FarPlanes* ends = nullptr, bool by_position = false);
  /// Side quads of the outline.
  void draw_sides(const VolumeCounter& counter) const {
    draw_arrays(counter, sides_, VolumeFace::side, offsetof(FaceCommands, sides));
  }
  /// Light caps, and dark ones unless volumes end in one point.
  void draw_caps(const VolumeCounter& counter) const;
  /// Light caps alone. Before the surface they count where the eye does not see the caster.
  void draw_light_caps(const VolumeCounter& counter) const;
  /// Their two draws, with a program of one's own; `reversed` turns both about.
  void draw_light_caps(const VolumeCounter& counter, const VolumeProgram& program, bool reversed = false) const;
  /// One command, `offset` into FaceCommands, with a program that `program` made.
  void draw_arrays(const VolumeCounter& counter, const VolumeProgram& program, VolumeFace face, std::size_t offset) const;

 private:
  VolumeProgram sides_, fan_, far_triangles_, caps_;
  VertexArray vertex_array_;
  glm::mat4 clip_from_world_{1};
  glm::vec4 light_{0};
  bool is_pointed_ = false, by_position_ = false;
  std::array<glm::vec4, 6> far_planes_{}, far_heights_{};
};

}  // namespace gnomon
