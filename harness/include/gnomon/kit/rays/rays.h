#pragma once
#include <gnomon/changes.h>
#include <gnomon/gbuffer.h>
#include <gnomon/kit/geometry/crossings.h>

#include <array>

struct RTCSceneTy;

namespace gnomon {

class EdgeAdjacency;

/// Rays that are traced at a time.
inline constexpr int ray_lanes = 16;

/// So many shadow rays, struct of arrays, in the layout and alignment that Embree requires.
struct alignas(64) ShadowPacket {
  std::array<float, ray_lanes> ox, oy, oz, tnear, dx, dy, dz, time, tfar;
  std::array<std::uint32_t, ray_lanes> mask, id, flags;
};

/// Lane `lane` becomes a ray from `origin` along `direction`, from `nearest` to `end` of its length: 1 for a light at a place
/// where the direction ends, infinity for a directional one.
inline void set_ray(ShadowPacket& packet, int lane, const glm::vec3& origin, const glm::vec3& direction, float end,
                    float nearest = 0) {
  packet.ox[lane] = origin.x;
  packet.oy[lane] = origin.y;
  packet.oz[lane] = origin.z;
  packet.dx[lane] = direction.x;
  packet.dy[lane] = direction.y;
  packet.dz[lane] = direction.z;
  packet.tnear[lane] = nearest;
  packet.tfar[lane] = end;
  packet.time[lane] = 0;
  packet.mask[lane] = 0xffffffffu;
  packet.id[lane] = static_cast<std::uint32_t>(lane);
  packet.flags[lane] = 0;
}

/// The receivers of a packet: a hit on a ray's own receiver is no hit.
struct Receivers {
  const std::uint32_t* mesh;      ///< 16 mesh indices
  const std::uint32_t* triangle;  ///< 16; ignored on exact curved shapes, excluded whole unless the ray starts inside
};

/// A scene in Embree, traced by the measured ray recipe (docs/method.md): robust mode; the receiver's own triangle is excluded
/// by a filter; the origin is lifted by 8 * 2^-24 * max|P| along the normal. Exact curved shapes are traced exactly, in
/// double; flat shapes are their triangles. Rays go through the holes of alpha masks (kit/geometry/holes.h), and shadow rays
/// through casters with transmission, which `crossed` alone reports. A scene whose
/// largest coordinate is below 2^-10 m or above 2^30 m is traced scaled by a power of two; all arguments and results are in
/// meters.
class RayScene {
 public:
  enum class Which { seen, casters };  ///< what the eye sees, or what casts
  /// How Embree builds: one tree with the fastest queries, or a tree over those of the meshes, of which the ones with a
  /// Mesh::reach can be refitted.
  enum class Trees { fixed, moving };
  RayScene(const Scene& scene, Truth truth, Which which, Trees trees = Trees::fixed);
  /// Vertices of the scene moved in place: what `changes` names since it was built or updated last. Answers are then those of a
  /// RayScene that is built there. Moving trees are refitted, and one that has decayed is built anew; fixed ones are built. No
  /// copy of this object is valid afterwards, and no reference that it gave.
  void update(const Changes& changes);

  struct Hit {
    std::uint32_t mesh = no_mesh, triangle = 0;
    glm::dvec3 normal{0};  ///< unit geometric normal as wound, or of the shape
    double t = INFINITY;   ///< along the direction given; as Embree has it, in float32 precision on triangles
  };
  Hit closest(const glm::dvec3& origin, const glm::dvec3& direction) const;
  /// The same of what keeps light off: a texel that lets all of it through is not there.
  Hit closest_caster(const glm::dvec3& origin, const glm::dvec3& direction) const;

  /// Whether anything opaque blocks each of the packet's rays; bit k of the result is ray k. Lanes off in `valid` answer 0.
  std::uint32_t occluded(std::uint32_t valid, ShadowPacket& packet, const Receivers& receivers) const;

  /// The same. And `crossings[k]` becomes the solid triangles with transmission that ray k meets; of a blocked ray, some.
  std::uint32_t crossed(std::uint32_t valid, ShadowPacket& packet, const Receivers& receivers,
                        std::span<Crossings, ray_lanes> crossings) const;

  struct Blocked {
    std::uint32_t at_all = 0;   ///< as `occluded` answers
    std::uint32_t clearly = 0;  ///< by an exact shape, or by a triangle whose edges and plane leave no doubt
  };
  /// The same, and of each blocked ray whether a triangle blocks it clearly: in double, the ray passes `clearance` meters or
  /// more inside of its edges, and meets it as far from both ends of the ray, and four times that from its origin.
  Blocked blocked(std::uint32_t valid, ShadowPacket& packet, const Receivers& receivers, double clearance) const;

  /// A triangle of the scene by numbers.
  struct Met {
    std::uint32_t mesh, triangle;
  };
  /// Every triangle that the segment from `origin` to `origin` + `way` meets, as float32 sees it, in its holes, too; no exact
  /// curved shapes, and nothing with transmission.
  std::vector<Met> met(const glm::dvec3& origin, const glm::dvec3& way) const;
  /// Bit k is set when ray k, as `occluded` takes it, meets such a triangle.
  std::uint32_t met(std::uint32_t valid, ShadowPacket& packet, const Receivers& receivers) const;

  /// Which of the triangles traced share an edge, those with transmission left out. The first call finds it.
  const EdgeAdjacency& adjacency() const;

  /// Bytes that Embree holds for this scene as one thread builds it. The first call does so once more, which takes its time.
  std::size_t bytes() const;
  /// The scene that is traced.
  const Scene& scene() const;
  /// Whether a mesh that is traced has an alpha mask, and whether one has transmission.
  bool has_alpha_masks() const;
  bool has_transmission() const;
  /// Library, instruction sets, flags and ray recipe, for certificates.
  std::string description() const;
  /// The Embree scene, for a bare loop beside which ours is measured.
  RTCSceneTy* handle() const;

 private:
  struct Body;
  std::shared_ptr<Body> body_;
};

/// Of the Embree that the program was compiled for, as 3.13.5.
const char* embree_version();

/// Fills a packet with the shadow rays of pixels first .. first+15 (fewer at the end) toward a homogeneous light, by the ray
/// recipe, and returns the lanes that face the light (see faces_light, which it equals in every lane).
std::uint32_t fill_packet(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::size_t first,
                          ShadowPacket& packet);

/// One shadow ray per pixel that faces the light, packets of 16 on all threads: 1 lit, 0 blocked, 1 where not facing. Behind
/// transmission the product of what the triangles let through (red of three), each looked up from the pixel's point and the
/// light, in double; into `surfaces`, where it is not empty, how many take a part of the light. Returns the number of rays.
std::size_t trace_shadows(const RayScene& casters, const Scene& scene, const GBuffer& gbuffer, const Light& light,
                          std::span<float> visibility, std::span<std::uint8_t> surfaces = {});
/// In `surfaces`: an opaque caster hides the light. Counts end before it.
inline constexpr std::uint8_t blocked_surfaces = 255;
/// The same of opaque casters alone.
std::size_t trace_opaque_shadows(const RayScene& casters, const Scene& scene, const GBuffer& gbuffer, const Light& light,
                                 std::span<float> visibility);

/// How far a shadow ray starts off its surface: 8 * 2^-24 * the largest absolute coordinate of `point`, meters.
double ray_offset(const glm::vec3& point);

}  // namespace gnomon
