#pragma once
#include <gnomon/account.h>
#include <gnomon/changes.h>
#include <gnomon/gbuffer.h>
#include <gnomon/param.h>

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon {

/// What an approximate answer promises.
struct Approximation {
  /// Largest share of the tested pixels that is wrong, 0 .. 1, and under a light with area their largest mean error. Nothing:
  /// what all promise, to be far better than no shadows. The reason tells it, and conformance judges by it.
  std::optional<double> most_wrong = {};
};

/// Whether a technique can do a scene, light and view. No default: somebody must have thought about it.
class Support {
 public:
  enum class Kind { full, approximate, unsupported };
  static Support full() { return Support(Kind::full, ""); }
  /// Throws Error on a promise outside 0 .. 1.
  static Support approximate(std::string why, const Approximation& promise = {});
  static Support unsupported(std::string why) { return Support(Kind::unsupported, std::move(why)); }
  Kind kind() const { return kind_; }
  const std::string& why() const { return why_; }
  std::optional<double> most_wrong() const { return most_wrong_ < 0 ? std::nullopt : std::optional<double>(most_wrong_); }
  explicit operator bool() const { return kind_ != Kind::unsupported; }

 private:
  Support(Kind kind, std::string why) : kind_(kind), why_(std::move(why)) {}
  Kind kind_;
  float most_wrong_ = -1;  ///< below 0: none is promised
  std::string why_;
};
std::string_view name(Support::Kind kind);
/// What a technique supports that answers for one point of the light: every light without area, and of others `why` not.
inline Support hard_lights_only(const Light& light, const char* why) {
  return has_area(light) ? Support::unsupported(why) : Support::full();
}

/// Which of the two numbers that are true of a light with area (see LightShares) a mask holds: the share of the light's area
/// that is seen, or the share of the irradiance that all of it would give.
enum class LightShareKind { area, irradiance };
inline constexpr std::string_view name(LightShareKind kind) { return kind == LightShareKind::area ? "area" : "irradiance"; }

enum class Promise { exact, sampled };
enum class Role { contender, baseline, reference };

/// What the stages of a technique are called with: made ready by the harness, on the thread that calls them.
enum class Device {
  processor,  ///< nothing else
  opengl,     ///< a current OpenGL 4.5 core context
  vulkan,     ///< a current Vulkan device with rays (gnomon/kit/vulkan/vulkan.h)
};
std::string_view name(Device device);

/// The barest pass over the same scene or picture that a technique that draws cannot do without. Tables show how much of a
/// frame it takes, on any device.
enum class Floor {
  none,        ///< nothing to compare with
  depth_draw,  ///< all triangles once from the eye, depth alone, into an image of the picture's size
  fetch,       ///< each pixel reads its position and normal and writes one number
  copy,        ///< one number a pixel copied from picture to picture
};
std::string_view name(Floor floor);

/// What a scene may hold beside opaque triangles that stand still. A technique says which of it it handles; a scene that holds
/// more is unsupported, so that nothing that was written before the feature is silently wrong on it.
enum class Feature {
  alpha_masks,   ///< casters with holes, see Mesh::alpha_mask
  transmission,  ///< casters that let a part of the light through, see Mesh::transmission; the same of every color
};
std::string_view name(Feature feature);
/// By name; nothing where there is none.
std::optional<Feature> feature_named(std::string_view name);
/// All there are.
std::span<const Feature> all_features();
/// Those that the casters of a scene have.
std::vector<Feature> features_of(const Scene& scene);

/// A reason for wrong pixels that a technique finds by itself, beside the common ones of docs/causes.md. It says by
/// Explanation::cause at which pixels it holds.
struct OwnCause {
  std::string_view id;                  ///< plain name that no common cause has: "off_screen"
  std::string_view sentence;            ///< what it means, for people
  std::array<std::uint8_t, 3> color{};  ///< sRGB, in every picture; at least 10 in CIE Lab from every other cause's
};

/// A part of what a mask is wrong by, signed.
struct ErrorTerm {
  std::string_view cause;     ///< of About::causes
  std::vector<float> values;  ///< of each pixel
};

struct About {
  std::string_view title;
  std::string_view summary;  ///< one sentence
  std::string_view source;   ///< short names of the glossary
  std::string_view error;    ///< what goes wrong and by how much
  std::string_view fails;    ///< the scene that breaks it
  Promise promise = Promise::sampled;
  Truth sees = Truth::mesh;  ///< geometry the technique works on; promises and conformance are judged by that truth
  LightShareKind estimates = LightShareKind::area;  ///< under lights with area; it is scored against that
  Role role = Role::contender;
  Device device = Device::processor;
  Floor floor = Floor::none;  ///< of one that draws
  bool is_default = false;    ///< the technique that `gnomon view` shows when none is named
  /// The edges of its shadows are those of polygons that a rasterizer draws in the picture's pixels, snapped to its grid.
  bool rasterizes = false;
  std::span<const Feature> handles = {};          ///< of scenes: it supports none that needs another
  std::span<const OwnCause> causes = {};          ///< of its own
  std::span<const std::string_view> lights = {};  ///< kinds that a program supports; empty: `supports` tells
  /// How far a mask after updates may be from that after a build, mean over the tested pixels; 0: bit for bit.
  float update_error = 0;
  /// A mask depends on the pictures before it, see Technique::forget. Every other technique answers as if there were none.
  bool remembers = false;
  bool named_only = false;  ///< not among what `*` stands for: an engine, which runs only where it is named
};

/// Another device than the processor does its work.
inline bool draws(const About& about) { return about.device != Device::processor; }

class Technique;
/// What a technique supports: what its `supports` answers where it handles all features of the scene, else `unsupported`, which
/// names those that it does not handle. The harness decides by this function alone.
Support support_of(const About& about, const Technique& technique, const Scene& scene, const Light& light, const View& view);

/// What a technique that looks up AlphaMask handles.
inline constexpr Feature with_alpha_masks[] = {Feature::alpha_masks};
/// And one that multiplies what Transmission lets through, the same for all colors.
inline constexpr Feature with_gray_transmission[] = {Feature::alpha_masks, Feature::transmission};

/// A shadow technique. Life: construct (no work), set parameters, then setup, build, relight, resolve in this order; each
/// later stage may be repeated without the earlier ones, with other arguments. A parameter set afterwards is seen from the
/// stage that it spoils on. Scene, light and G-buffer outlive the technique until the next build, relight, resolve.
/// Where the scene's vertices moved, update takes build's place; relight and resolve follow it always.
/// Every call does its whole work: it may reuse allocations, never answers, but for what `update` and `forget` say. GL
/// techniques find the GL state at its defaults, restore it, and drain the queue before a stage returns.
class Technique : public Parametrized {
 public:
  /// Called before anything runs, on a fresh object with its parameters set: without GL, and of one that draws again where a
  /// context is current, whose limits count then (gnomon/kit/gl/gl_limits.h).
  virtual Support supports(const Scene& scene, const Light& light, const View& view) const = 0;
  /// Once per process. Ends with one draw per shader variant in the state of the timed stages.
  virtual void setup() = 0;
  virtual void build(const Scene& scene) = 0;
  /// Vertices of the scene that build got last moved in place; triangles, masks, flags and all else are the same. Update may
  /// keep all that no change spoils, and afterwards the technique answers as after a build, within `About::update_error`. The
  /// first relight after it may keep what no change spoils, too, where it is under the very light of the relight before; what
  /// depends on the picture the first resolve after that relight may. By default it builds.
  virtual void update(const Scene& scene, [[maybe_unused]] const Changes& changes) { build(scene); }
  virtual void relight(const Light& light) = 0;
  /// Writes every pixel of the mask and nothing else.
  virtual void resolve(const GBuffer& gbuffer, VisibilityMask& mask) = 0;
  /// Of one that remembers: the next resolve is the first of a sequence, as on a fresh object. Every resolve after it is the
  /// next frame, also where nothing has changed; light, camera and vertices may differ from frame to frame, and build and
  /// settings do not within a sequence. The harness calls it before each sequence. Who needs the G-buffer of the frame before
  /// keeps a copy, which shares its arrays, and counts their bytes.
  virtual void forget() {}
  virtual Counts counts() const = 0;
  /// An object for another light, which shares what setup and build make, now and later: these two stages are called on this
  /// object alone, relight, resolve and all questions on each. It has this one's settings, and counts only what it holds
  /// itself. This object outlives it. Null when the technique shares nothing: then every light gets a whole object. Kit:
  /// gnomon/kit/shared.h.
  virtual std::unique_ptr<Technique> for_another_light() const { return nullptr; }
  /// Why pixel `index` of the last resolve got its answer; nothing when the technique has no samples to show. Untimed.
  virtual std::optional<Explanation> explain([[maybe_unused]] std::size_t index) const { return std::nullopt; }
  /// The parts of the difference between the mask of the last resolve and `exact`, what is exact of each of its pixels: they
  /// add up to it within 1e-6 wherever the light is faced. None from techniques that cannot tell. Called after every resolve of
  /// a sequence from its first one on, once, or after none. `explain` then names the cause of the largest of them that has the
  /// sign of the difference. Untimed.
  virtual std::vector<ErrorTerm> error_terms([[maybe_unused]] std::span<const float> exact) { return {}; }
  /// The curve of the texel in which pixel `index` of the last resolve was looked up; nothing from techniques that hold none,
  /// and where they looked nothing up. Untimed.
  virtual std::optional<DepthCurve> depth_curve([[maybe_unused]] std::size_t index) const { return std::nullopt; }
  /// Which part of its images answered each pixel of the last resolve: its slice, face or page, by a number from 1 on, 0 where
  /// none did. Nothing from techniques of one part. Seams are where parts meet (error_seam_0_1 of docs/method.md). Untimed.
  virtual std::vector<std::uint32_t> image_parts() const { return {}; }
  /// The lit and shadowed polygons of the last relight; nothing from techniques that do not make polygons. A fresh object of
  /// one that does gives an empty detail. Untimed.
  virtual std::optional<SurfaceDetail> surface_detail() const { return std::nullopt; }
  /// The pictures that `draw_debug` can make; none by default.
  virtual std::vector<DebugLayer> debug_layers() const { return {}; }
  /// RGB picture, width * height * 3 floats, of one layer for the last resolve.
  virtual std::vector<float> draw_debug(std::string_view layer) const;
  /// All light that the surfaces of the last resolve send to the eye, handed on by other surfaces included: linear RGB
  /// radiance, width * height * 3 floats, in W/(m2 sr); background 0. Nothing from techniques that answer
  /// for shadows alone. Untimed.
  virtual std::optional<std::vector<float>> global_picture() const { return std::nullopt; }
};

}  // namespace gnomon
