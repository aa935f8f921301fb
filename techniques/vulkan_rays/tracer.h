#pragma once
#include <gnomon/changes.h>
#include <gnomon/gbuffer.h>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

// The part of vulkan_rays that calls Vulkan; nothing here names a type of it.
namespace gnomon::vulkan_rays {

enum class Trace { pipeline, query };

/// How trees are built.
struct BuildChoices {
  bool is_fast_to_trace = true;  ///< else fast to build
  bool compacts = true;
  bool refits = true;  ///< where vertices move; else trees are built anew
};

/// What shaders know of a picture and its light, as rays.glsl has it.
struct FrameConstants {
  glm::vec4 light{0}, spot{0};
  glm::vec4 center{0};  ///< of a light with area; its radius
  glm::vec4 half_u{0};  ///< of a rectangle; the front of a disc
  glm::vec4 half_v{0};
  float scale = 1;
  std::uint32_t width = 0, height = 0;
  std::int32_t samples = 0;
  std::uint32_t facts = 0;
  std::int32_t form = 0;
};
inline constexpr std::uint32_t sees_shapes = 1, is_area_light = 2, is_one_sided = 4;

/// Sizes, for counts.
struct Sizes {
  std::size_t triangles = 0;
  std::size_t tree_bytes = 0;   ///< of the trees, as they are traced
  std::size_t built_bytes = 0;  ///< of the trees, as they were built
  std::size_t bytes = 0;        ///< of all buffers
};

/// What setup and build make: programs, trees, and what they were made of.
class Tracer {
 public:
  explicit Tracer(Trace trace);
  ~Tracer();
  /// `scale` of the world to the frame that is traced.
  void build(const Scene& scene, float scale, const BuildChoices& choices);
  /// Vertices moved since.
  void update(const Changes& changes);
  Sizes sizes() const;
  float scale() const;
  const Scene& scene() const;

 private:
  friend class Answers;
  struct Body;
  std::unique_ptr<Body> body_;
};

/// What one light needs: its buffers, and the answers.
class Answers {
 public:
  Answers();
  ~Answers();
  /// Places of a light with area: the points of the square -1 .. 1 or of the unit disc, set after set; empty for others.
  void resolve(const Tracer& tracer, FrameConstants constants, std::span<const glm::vec2> places, const GBuffer& gbuffer,
               std::span<float> mask);
  std::size_t bytes() const;
  /// Rays of each pixel of the last resolve.
  std::vector<std::uint32_t> ray_counts() const;

 private:
  struct Body;
  std::unique_ptr<Body> body_;
};

/// Why the present device cannot trace so many triangles so; empty: it can, or there is none yet.
std::string refusal(Trace trace, std::size_t triangles);

}  // namespace gnomon::vulkan_rays
