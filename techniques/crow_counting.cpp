// Crow's counting of shadow volumes: on the way from the eye to a point, volumes entered minus volumes left, front to back.
//
// Source: Crow 1977; the front-to-back count of the lecture notes, with the rule put right: a point is in shadow iff
//         eye + entered - left > 0, where `eye` is the number of volumes that hold the eye (">= 0" would shadow everything).
//         Side quads are infinite and weigh what their edges count, so that open and inconsistently wound meshes and layers
//         are right; light caps are the triangles that face the light. A dark cap at infinity is never on the way.
// Error:  none on the float32 points that it is given: a crossing that double cannot decide is decided by exact signs. A way
//         through the border of a side quad is counted anew from a start beside the eye. A point on such a border, whose way to
//         the light goes exactly through an edge, is dark. Of a closed body only the half that faces the light counts:
//         behind a body thinner than the rounding of a point, the point may be lit. Tessellation on curved shapes.
// Fails:  nothing it supports; the work grows with the length of the silhouette's shadow on the screen. A closed body that
//         passes through itself inside out may be taken for empty.
#include <gnomon/kit/layers.h>
#include <gnomon/kit/lines.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

#include <mutex>

#include "crow_counting/own_volumes.h"
#include "crow_counting/tiles.h"
#include "crow_counting/volumes.h"

namespace {
using namespace gnomon;
using namespace gnomon::crow_counting;

constexpr std::uint32_t nothing = 0xffffffffu;
constexpr int tile_size = Pyramid::leaf * Pyramid::leaf;

/// A polygon met on the way to a point.
struct Met {
  double share;  ///< of the way to the point, 0 .. 1
  std::uint32_t polygon;
  int step;
};

/// A pixel of a tile while its polygons are looked for.
struct Asked {
  std::size_t pixel;
  glm::dvec3 seen;  ///< the point in the frame of the start
  double error;     ///< of a plane's value there
  bool unclear = false, touches = false;
};

/// What a pixel was found to be.
struct Found {
  std::int32_t depth = 0;           ///< volumes that hold the point, its own ones left out
  std::uint32_t crossings = 0;      ///< polygons met on the way, its own ones left out
  std::uint32_t entered = nothing;  ///< the last polygon through which the way enters a volume
};

/// What one thread works with.
struct Scratch {
  std::vector<std::vector<std::uint32_t>> polygons;  ///< of the tile on each level
  std::vector<std::uint32_t> caps;                   ///< triangles among those of the smallest
  std::vector<Met> met[tile_size];
  std::size_t bytes() const {
    std::size_t sum = sizeof(Scratch) + caps.capacity() * sizeof(std::uint32_t);
    for (const auto& list : polygons) sum += list.capacity() * sizeof(std::uint32_t);
    for (const auto& list : met) sum += list.capacity() * sizeof(Met);
    return sum;
  }
};

/// Work and findings of some pixels.
struct Tally {
  std::uint64_t rays = 0, crossings = 0, longest = 0, tests = 0, exact = 0, again = 0, touching = 0;
  std::int64_t deepest = 0;
  Tally& operator+=(const Tally& t) {
    rays += t.rays, crossings += t.crossings, tests += t.tests, exact += t.exact, again += t.again, touching += t.touching;
    longest = std::max(longest, t.longest), deepest = std::max(deepest, t.deepest);
    return *this;
  }
};

class CrowCounting final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    if (has_area(light)) return Support::unsupported("a shadow volume has one apex: it cannot see part of an area light");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override {
    scene_ = &scene;
    volumes_.build(scene);
    own_.build(scene);
  }
  void relight(const Light& light) override {
    light_ = light;
    volumes_.relight(light);
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::optional<Explanation> explain(std::size_t index) const override;
  std::vector<DebugLayer> debug_layers() const override {
    return {{"crossings", "Faces crossed on the way to each point: gray none, else colors as in the legend.", heat_legend()},
            {"depth", "Shadow volumes around each point: gray none, else colors as in the legend.", heat_legend()},
            silhouette_layer()};
  }
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  /// Decides what is left to decide, from one start; says how many pixels that leaves.
  std::size_t count_from(const Frame& frame, std::int64_t volumes_at_start, std::span<float> mask);
  void bound_tiles();
  /// Hands each tile of a tile the polygons that it does not miss, down to the smallest.
  Tally descend(int level, int x, int y, std::span<const std::uint32_t> polygons, std::span<float> mask, Scratch& scratch);
  Tally decide_tile(int x, int y, std::span<const std::uint32_t> polygons, std::span<float> mask, Scratch& scratch);
  /// Appends to `met` the way from the start to a pixel's point, if it meets the polygon.
  void meet(std::uint32_t polygon, Asked& asked, std::vector<Met>& met, Tally& tally) const;
  /// The count front to back; says whether the point is in shadow.
  bool walk(const Asked& asked, std::vector<Met>& met, std::span<const std::uint32_t> caps, Tally& tally);

  std::unique_ptr<Scratch> borrow_scratch();
  void return_scratch(std::unique_ptr<Scratch> scratch);

  const Scene* scene_ = nullptr;
  const GBuffer* gbuffer_ = nullptr;
  Light light_;
  Volumes volumes_;
  OwnVolumes own_;
  Frame frame_;  // of the present start
  std::int64_t volumes_at_start_ = 0, volumes_at_eye_ = 0;
  Pyramid pyramid_;
  std::vector<Found> found_;            // of each pixel
  std::vector<std::uint8_t> is_asked_;  // of each pixel: not yet decided
  Tally tally_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> scratch_;  // not in use
};

void CrowCounting::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  gbuffer_ = &gbuffer;
  tally_ = {};
  found_.assign(gbuffer.size(), {});
  is_asked_.resize(gbuffer.size());
  const std::span<float> pixels = mask.pixels();
  for_blocks(gbuffer.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      is_asked_[i] = faces_light(*scene_, gbuffer, light_, i);
      pixels[i] = 1;
    }
  });
  pyramid_.fit(gbuffer.width, gbuffer.height);

  // The count at a point does not depend on where it is begun, so where a start is in line with the border of a volume, another
  // one beside it will do. A point for which none of many starts will do lies on a border itself.
  const Bounds bounds = scene_->bounds();
  const glm::vec3 eye = gbuffer.view.eye;
  const glm::vec3 largest = glm::max(glm::max(glm::abs(bounds.min), glm::abs(bounds.max)), glm::abs(eye));
  const float beside = 0x1p-12f * std::max({largest.x, largest.y, largest.z});
  Random random(1977);
  std::size_t left = 1;
  for (int attempt = 0; attempt < 16 && left > 0; ++attempt) {
    glm::vec3 start = eye;
    if (attempt > 0) start += beside * glm::vec3(random.uniform(glm::dvec3(-1), glm::dvec3(1)));
    const EdgeAdjacency::Depth depth = volumes_.adjacency().depth_at(start, volumes_.silhouette());
    if (attempt == 0) volumes_at_eye_ = depth.volumes;
    if (!depth.degenerate) left = count_from(Frame(gbuffer.view, start), depth.volumes, pixels);
  }
  for (std::size_t i = 0; i < gbuffer.size(); ++i)
    if (is_asked_[i]) pixels[i] = 0, ++tally_.touching, ++tally_.rays;
}

std::size_t CrowCounting::count_from(const Frame& frame, std::int64_t volumes_at_start, std::span<float> mask) {
  frame_ = frame;
  volumes_at_start_ = volumes_at_start;
  volumes_.look_from(frame);
  bound_tiles();
  const int level = pyramid_.top();
  const Pyramid::Level& top = pyramid_.level(level);
  std::vector<Tally> tallies(top.tiles.size());
  for_blocks(top.tiles.size(), 1, [&](std::size_t k, std::size_t) {
    if (top.tiles[k].asked == 0) return;
    std::unique_ptr<Scratch> scratch = borrow_scratch();
    scratch->polygons.resize(std::max<std::size_t>(scratch->polygons.size(), level + 2));
    std::vector<std::uint32_t>& list = scratch->polygons[level + 1];
    list.clear();
    for (std::uint32_t p = 0; p < volumes_.count(); ++p)
      if (!top.tiles[k].misses(volumes_.outline(p))) list.push_back(p);
    const int x = static_cast<int>(k) % top.columns, y = static_cast<int>(k) / top.columns;
    tallies[k] = descend(level, x, y, list, mask, *scratch);
    return_scratch(std::move(scratch));
  });
  std::size_t left = 0;
  for (const Tally& tally : tallies) tally_ += tally, left += tally.again;
  return left;
}

void CrowCounting::bound_tiles() {
  Pyramid::Level& leaves = pyramid_.level(0);
  for_blocks(leaves.rows, 1, [&](std::size_t row, std::size_t) {
    for (int column = 0; column < leaves.columns; ++column) {
      Tile& tile = leaves.at(column, static_cast<int>(row)) = Tile{};
      pyramid_.for_pixels(column, static_cast<int>(row), [&](std::size_t i) {
        if (!is_asked_[i]) return;
        const glm::vec3 p = gbuffer_->position(i);
        tile.add(frame_.seen(p), std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}));
      });
    }
  });
  pyramid_.join();
}

Tally CrowCounting::descend(int level, int x, int y, std::span<const std::uint32_t> polygons, std::span<float> mask,
                            Scratch& scratch) {
  const Tile& tile = pyramid_.level(level).at(x, y);
  if (tile.asked == 0) return {};
  std::vector<std::uint32_t>& kept = scratch.polygons[level];
  kept.clear();
  for (const std::uint32_t p : polygons)
    if (!tile.misses(volumes_.outline(p)) && !tile.misses(volumes_.polygon(p))) kept.push_back(p);
  if (level == 0) return decide_tile(x, y, kept, mask, scratch);
  const Pyramid::Level& lower = pyramid_.level(level - 1);
  Tally sum;
  for (int v = 2 * y; v < std::min(2 * y + 2, lower.rows); ++v)
    for (int u = 2 * x; u < std::min(2 * x + 2, lower.columns); ++u) sum += descend(level - 1, u, v, kept, mask, scratch);
  return sum;
}

Tally CrowCounting::decide_tile(int x, int y, std::span<const std::uint32_t> polygons, std::span<float> mask,
                                Scratch& scratch) {
  Asked asked[tile_size];
  int count = 0;
  pyramid_.for_pixels(x, y, [&](std::size_t i) {
    if (!is_asked_[i]) return;
    const glm::dvec3 seen = frame_.seen(gbuffer_->position(i));
    scratch.met[count].clear();
    asked[count++] = {i, seen, relative_error * glm::length(seen)};
  });
  Tally tally;
  tally.tests = static_cast<std::uint64_t>(count) * polygons.size();
  scratch.caps.clear();
  for (const std::uint32_t p : polygons) {
    if (!volumes_.is_side(p)) scratch.caps.push_back(volumes_.cap(p));
    for (int k = 0; k < count; ++k) meet(p, asked[k], scratch.met[k], tally);
  }
  for (int k = 0; k < count; ++k) {
    const Asked& a = asked[k];
    if (a.unclear && !a.touches) {
      ++tally.again;
      continue;
    }
    const bool in_shadow = walk(a, scratch.met[k], scratch.caps, tally);
    mask[a.pixel] = in_shadow || a.touches ? 0.0f : 1.0f;
    tally.touching += a.touches;
    is_asked_[a.pixel] = 0;
  }
  return tally;
}

void CrowCounting::meet(std::uint32_t p, Asked& asked, std::vector<Met>& met, Tally& tally) const {
  const Polygon& polygon = volumes_.polygon(p);
  const double along = glm::dot(polygon.plane, asked.seen), beyond = along - polygon.distance;
  if (beyond < -(polygon.slack + asked.error)) return;
  const glm::dvec3* n = polygon.inside;
  const double inside = std::min({glm::dot(n[0], asked.seen), glm::dot(n[1], asked.seen), glm::dot(n[2], asked.seen)});
  if (inside < -asked.error) return;
  if (!(beyond > polygon.slack + asked.error && inside > asked.error)) {
    ++tally.exact;
    const Meeting meeting = volumes_.meet(p, frame_.start, gbuffer_->position(asked.pixel));
    asked.unclear |= meeting == Meeting::unclear;
    if (meeting == Meeting::touches) {
      const auto [low, high] = volumes_.ends(p);
      asked.touches |= !own_.is_own_edge(volumes_, own_.surface(*gbuffer_, asked.pixel), low, high);
    }
    if (meeting != Meeting::crosses) return;
  }
  const double share = polygon.distance / along;
  met.push_back({std::isfinite(share) ? share : 1.0, p, polygon.step});
}

bool CrowCounting::walk(const Asked& asked, std::vector<Met>& met, std::span<const std::uint32_t> caps, Tally& tally) {
  std::ranges::sort(met, [](const Met& one, const Met& other) {
    return one.share != other.share ? one.share < other.share : one.polygon < other.polygon;
  });
  Found& found = found_[asked.pixel];
  found.crossings = static_cast<std::uint32_t>(met.size());
  std::int64_t depth = volumes_at_start_, deepest = depth;
  for (const Met& m : met) {
    depth += m.step;
    deepest = std::max(deepest, depth);
    if (m.step > 0) found.entered = m.polygon;
  }
  // The volumes of the triangle that the point lies on do not count: a point rounded to below it is in them.
  const std::int64_t own =
      depth > 0 ? own_.count(volumes_, own_.surface(*gbuffer_, asked.pixel), frame_.start, caps) : std::int64_t{0};
  found.depth = static_cast<std::int32_t>(depth - own);
  found.crossings -= static_cast<std::uint32_t>(std::clamp<std::int64_t>(own, 0, found.crossings));
  ++tally.rays;
  tally.crossings += met.size();
  tally.longest = std::max<std::uint64_t>(tally.longest, met.size());
  tally.deepest = std::max(tally.deepest, deepest);
  return depth > own;
}

std::unique_ptr<Scratch> CrowCounting::borrow_scratch() {
  const std::lock_guard lock(mutex_);
  if (scratch_.empty()) return std::make_unique<Scratch>();
  std::unique_ptr<Scratch> scratch = std::move(scratch_.back());
  scratch_.pop_back();
  return scratch;
}

void CrowCounting::return_scratch(std::unique_ptr<Scratch> scratch) {
  const std::lock_guard lock(mutex_);
  scratch_.push_back(std::move(scratch));
}

Counts CrowCounting::counts() const {
  std::size_t bytes =
      volumes_.bytes() + own_.bytes() + pyramid_.bytes() + found_.capacity() * sizeof(Found) + is_asked_.capacity();
  for (const auto& scratch : scratch_) bytes += scratch->bytes();
  const auto count = [](const char* name, auto value) { return Count{name, static_cast<double>(value), ""}; };
  const double rays = static_cast<double>(std::max<std::uint64_t>(tally_.rays, 1));
  return {count("silhouette_edges", volumes_.silhouette().edges.size()),
          count("polygons", volumes_.count()),
          count("volumes_at_eye", volumes_at_eye_),
          count("rays", tally_.rays),
          count("crossings", tally_.crossings),
          count("crossings_per_ray", static_cast<double>(tally_.crossings) / rays),
          count("longest_list", tally_.longest),
          count("deepest", tally_.deepest),
          count("crossing_tests", tally_.tests),
          count("exact_tests", tally_.exact),
          count("restarts", tally_.again),
          count("degenerate_rays", tally_.touching),
          {"bytes", static_cast<double>(bytes), "byte"}};
}

// A volume is named by what it was entered through: a triangle of the scene or, from the number of triangles on, an edge of the
// silhouette.
std::optional<Explanation> CrowCounting::explain(std::size_t index) const {
  if (!faces_light(*scene_, *gbuffer_, light_, index)) return std::nullopt;
  Explanation why;
  const std::uint32_t entered = found_[index].entered;
  if (entered != nothing) why.element = volumes_.is_side(entered) ? scene_->triangle_count() + entered : volumes_.cap(entered);
  return why;
}

std::vector<float> CrowCounting::draw_debug(std::string_view layer) const {
  if (layer != "crossings" && layer != "depth" && layer != "silhouette") return Technique::draw_debug(layer);
  std::vector<float> values;
  values.reserve(found_.size());
  if (layer == "silhouette") {
    for (const Found& found : found_) values.push_back(found.depth > 0 ? 0.0f : 1.0f);
    std::vector<float> picture = shaded_layer(*scene_, *gbuffer_, light_, values);
    draw_lines(silhouette_lines(volumes_.adjacency(), volumes_.silhouette()), *gbuffer_, picture);
    return picture;
  }
  for (const Found& found : found_) values.push_back(static_cast<float>(layer == "depth" ? found.depth : found.crossings));
  return heat_layer(*gbuffer_, values);
}

}  // namespace

GNOMON_TECHNIQUE(
    crow_counting, CrowCounting,
    {.title = "Crow's counting of shadow volumes",
     .summary =
         "Shadow volumes entered and left on the way from the eye to each visible point, sorted and counted front to back.",
     .source = "Crow 1977",
     .error = "None on the float32 points it is given; tessellation on curved shapes.",
     .fails = "Nothing it supports; the work grows with the length of the silhouette's shadow on the screen.",
     .promise = gnomon::Promise::exact,
     .sees = gnomon::Truth::mesh,
     .role = gnomon::Role::contender})
