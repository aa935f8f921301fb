// What a tree of shadow planes takes that follows: triangles that moved are removed and inserted again (Chrysanthou and Slater
// 1995), beside trees that are grown anew. One thread, the sun, trees of svbsp alone: neither the facing
// of triangles nor resolve.
//
// balls    64 balls of together 33,792 triangles over a ground, of which one, eight or half of them move by 1/60 m.
// soup     32,768 small triangles, of which 1/64, 1/8 or half, anywhere among the others, move by 1/60 m.
//
// refill_ms       The tree of face planes loses all below the planes of what moved, and what stands still is filtered into
//                 the places so emptied; what moved is inserted. Only the insertions are timed: what reaches which place is
//                 found before the clock starts. So it is less than a tree that follows could take.
// refilled        The share of the tree's nodes that so goes.
// joined          The share of nodes that would be filtered again if at each plane that goes the larger of the two subtrees
//                 stayed. Then all edges need planes, since those of a plane that goes bound what it cut: `nodes_none` of
//                 them, where `nodes` are enough for the other tree.
// face_planes_ms  The same tree, grown anew; `none_ms` with planes for all edges.
// tiles_ms        Pieces and trees in tiles, as svbsp has them by default, made anew.
// follow_ms       The same where tiles in which nothing moved stay, as svbsp does it: `ratio` of tiles_ms.
// touched         The share of tiles that are grown anew then.
#include <benchmark/benchmark.h>
#include <gnomon/kit/bases/point_technique.h>
#include <gnomon/kit/geometry/shapes.h>
#include <tbb/global_control.h>

#include <unordered_map>

#include "bench/micro/alternate.h"
#include "techniques/svbsp/forest.h"

namespace {
using namespace gnomon;
using namespace gnomon::svbsp;

/// Casting triangles, and which of them move: those of mesh 1.
struct Casters {
  std::vector<SceneTriangle> triangles;
  std::vector<std::uint8_t> moves;

  void add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, bool is_moving) {
    triangles.push_back({{{a, b, c}}, is_moving});
    moves.push_back(is_moving);
  }
  void add(const Mesh& mesh, const glm::vec3& at, bool is_moving) {
    const glm::vec3* const p = mesh.positions.data();
    for (const glm::uvec3& t : mesh.triangles) add(p[t.x] + at, p[t.y] + at, p[t.z] + at, is_moving);
  }
  void step() {
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (glm::vec3& p : triangles[i].points) p.x += moves[i] ? 1 / 60.0f : 0;
  }
};

Casters balls(int moving) {
  constexpr int side = 8;
  Casters casters;
  casters.add(tessellate(ground_plane(side + 2), default_segments, "ground"), {}, false);
  const Mesh ball = tessellate(Sphere{{0, 1, 0}, 0.75f}, 24, "ball");
  for (int i = 0; i < side * side; ++i)
    casters.add(ball, glm::vec3(2 * (i % side) + 1 - side, 0, 2 * (i / side) + 1 - side), i < moving);
  return casters;
}

/// `moving` of each 64 triangles move.
Casters soup(int moving) {
  Casters casters;
  casters.add(tessellate(ground_plane(10), default_segments, "ground"), {}, false);
  Random random(3);
  for (int i = 0; i < 32768; ++i) {
    const glm::vec3 at(random.uniform(glm::dvec3(-8, 0.5, -8), glm::dvec3(8, 4, 8)));
    glm::vec3 p[3];
    for (glm::vec3& corner : p) corner = at + glm::vec3(random.uniform(glm::dvec3(-0.1), glm::dvec3(0.1)));
    casters.add(p[0], p[1], p[2], i % 64 < moving);
  }
  return casters;
}

/// As the sun sees them, on its one face.
struct Seen {
  const Casters& casters;
  ProjectedSpace space;
  std::vector<std::int8_t> signs;
  double extent = 0;
  Pieces pieces;
  Rules rules;

  explicit Seen(const Casters& seen, Drop drop = Drop::shared) : casters(seen) {
    const glm::dvec4 light(-0.375, 1, -0.3125, 0);
    const Bounds bounds{glm::vec3(-10, 0, -10), glm::vec3(10, 5, 10)};  // of all poses
    extent = bounds.extent();
    space = ProjectedSpace(light, bounds);
    find_facing(casters.triangles, light, signs);
    make(pieces, {});
    rules.epsilon = space.epsilons(2 * extent, extent);
    rules.drop = drop;
  }
  void make(Pieces& made, const Moved& moved) const {
    const auto corners_of = [&](std::size_t i, Corner* scratch) -> Pieces::Part {
      if (signs[i] == 0) return {static_cast<std::uint32_t>(i), {}};
      for (int k = 0; k < 3; ++k) scratch[k] = {glm::dvec3(casters.triangles[i].points[k]), own_edge};
      return {static_cast<std::uint32_t>(i), {scratch, 3}};
    };
    made.make(space, facing(), casters.triangles.size(), corners_of, moved);
  }
  Facing facing() const { return {casters.triangles, signs, nullptr}; }
  bool moves(const Piece& piece) const { return casters.moves[piece.triangle] != 0; }
};

struct PlaneOf {
  const Seen& seen;
  ClipPlane operator()(std::uint32_t triangle) const { return seen.facing().plane(seen.space, 0, triangle); }
};
using TreeBuilder = Builder<PlaneOf>;

/// The tree of face planes, and whose plane each node is.
class Tree {
 public:
  explicit Tree(const Seen& seen) : seen_(seen), order_(shuffled(seen)) {}
  void grow() {
    nodes_.clear();
    owners_.clear();
    root_ = out_cell;
    TreeBuilder builder = start(seen_);
    for (const std::uint32_t i : order_) insert(builder, pieces()[i].polygon(), pieces()[i].triangle, root_);
  }
  /// Empties what lies below the planes of what moves, and finds what of the others reaches each emptied place.
  void empty() {
    places_.clear();
    std::unordered_map<std::uint64_t, std::size_t> numbers;
    find_places({}, numbers);
    for (const Emptied& emptied : places_) link(emptied.place) = out_cell;
    Filter filter;
    std::uint64_t thin = 0;
    for (const std::uint32_t i : order_) {
      const Piece& piece = pieces()[i];
      if (seen_.moves(piece)) continue;
      filter.run(nodes_, root_, piece.polygon(), seen_.rules.epsilon.across, thin,
                 [&](const Place& place, Link, std::span<const Corner> fragment) {
                   const auto found = numbers.find(key(place));
                   if (found == numbers.end()) return;
                   places_[found->second].fragments.push_back({{fragment.begin(), fragment.end()}, piece.triangle});
                 });
    }
  }
  /// What moved is inserted as `now` has it.
  void refill(const Seen& now) {
    TreeBuilder builder = start(now);
    for (const Emptied& emptied : places_) {
      Link filled = out_cell;
      for (const Fragment& fragment : emptied.fragments) insert(builder, fragment.corners, fragment.triangle, filled);
      link(emptied.place) = filled;
    }
    for (const Piece& piece : now.pieces.of_face(0))
      if (now.moves(piece)) insert(builder, piece.polygon(), piece.triangle, root_);
  }
  std::size_t size() const { return nodes_.size(); }
  /// The nodes below the planes of what moves, these included.
  std::size_t emptied_count() const {
    std::vector<std::uint8_t> is_below(nodes_.size(), 0);
    std::size_t count = 0;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {  // children come after their parents
      is_below[i] |= seen_.casters.moves[owners_[i]];
      count += is_below[i];
      for (const Link link : nodes_[i].sides)
        if (link >= 0) is_below[link] |= is_below[i];
    }
    return count;
  }
  /// The nodes on the smaller sides of planes that go.
  std::size_t joined_count() const {
    std::vector<std::size_t> sizes(nodes_.size(), 0);
    std::size_t count = 0;
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      std::size_t below[2] = {0, 0};
      for (int side = 0; side < 2; ++side)
        if (nodes_[i].sides[side] >= 0) below[side] = sizes[nodes_[i].sides[side]];
      const bool goes = seen_.casters.moves[owners_[i]] != 0;
      sizes[i] = below[0] + below[1] + !goes;
      if (goes) count += std::min(below[0], below[1]);
    }
    return count;
  }

 private:
  struct Fragment {
    std::vector<Corner> corners;
    std::uint32_t triangle;
  };
  struct Emptied {
    Place place;
    std::vector<Fragment> fragments;
  };
  std::span<const Piece> pieces() const { return seen_.pieces.of_face(0); }
  static std::vector<std::uint32_t> shuffled(const Seen& seen) {
    std::vector<std::uint32_t> order(seen.pieces.of_face(0).size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    Random(1).shuffle(order);
    return order;
  }
  TreeBuilder start(const Seen& seen) {
    TreeBuilder builder(seen.space, seen.rules, PlaneOf{seen}, nodes_, work_);
    builder.start();
    return builder;
  }
  void insert(TreeBuilder& builder, std::span<const Corner> polygon, std::uint32_t triangle, Link& root) {
    builder.add(polygon, triangle, root);
    owners_.resize(nodes_.size(), triangle);
  }
  Link& link(const Place& place) { return place.parent < 0 ? root_ : nodes_[place.parent].sides[place.side]; }
  static std::uint64_t key(const Place& place) { return 2 * static_cast<std::uint64_t>(place.parent + 1) + place.side; }
  void find_places(const Place& place, std::unordered_map<std::uint64_t, std::size_t>& numbers) {
    const Link at = link(place);
    const std::uint32_t owner = at >= 0 ? owners_[at] : is_in_cell(at) ? triangle_in(at) : 0;
    if (at != out_cell && seen_.casters.moves[owner] != 0) {
      numbers[key(place)] = places_.size();
      places_.push_back({place, {}});
    } else if (at >= 0) {
      for (std::uint32_t side = 0; side < 2; ++side) find_places({at, side}, numbers);
    }
  }

  const Seen& seen_;
  std::vector<std::uint32_t> order_;  // of pieces
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> owners_;  // of each node
  Link root_ = out_cell;
  TreeWork work_;
  std::vector<Emptied> places_;
};

/// Trees in tiles, as svbsp has them.
class Tiles {
 public:
  void make(const Seen& seen) { grow(seen, {}); }
  void follow(const Seen& seen) {
    static constexpr std::uint8_t meshes[] = {0, 1};
    const Moved moved{seen.casters.triangles, meshes};
    forest_.leave(pieces_, moved);
    grow(seen, moved);
  }
  double touched() const {
    return 1 - static_cast<double>(forest_.kept_tile_count()) / static_cast<double>(forest_.tile_count());
  }
  double node_count() const { return static_cast<double>(forest_.node_count()); }

 private:
  void grow(const Seen& seen, const Moved& moved) {
    seen.make(pieces_, moved);
    forest_.grow(seen.space, pieces_, seen.facing(), Forest::Order::tiles, {.is_followed = true}, seen.extent, moved);
  }
  Pieces pieces_;
  Forest forest_;
};

void update(benchmark::State& state, Casters (*make)(int)) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 1);
  Casters casters = make(static_cast<int>(state.range(0)));
  const Casters start = casters;
  casters.step();
  const Seen before(start), after(casters), every_edge(start, Drop::none);
  Tree tree(before), fresh(after), whole(every_edge);
  whole.grow();
  tree.grow();
  state.counters["nodes"] = static_cast<double>(tree.size());
  state.counters["nodes_none"] = static_cast<double>(whole.size());
  state.counters["refilled"] = static_cast<double>(tree.emptied_count()) / static_cast<double>(tree.size());
  state.counters["joined"] = static_cast<double>(whole.joined_count()) / static_cast<double>(whole.size());
  Tiles made, following;
  following.make(after);
  Timings of_refill, of_fresh, of_none, of_tiles, of_following;
  bool is_after = true;
  for (auto _ : state) {
    tree.grow();
    tree.empty();
    state.SetIterationTime(of_refill.add([&] { tree.refill(after); }));
    of_fresh.add([&] { fresh.grow(); });
    of_none.add([&] { whole.grow(); });
    is_after = !is_after;
    const Seen& now = is_after ? after : before;
    of_tiles.add([&] { made.make(now); });
    of_following.add([&] { following.follow(now); });
  }
  state.counters["refill_ms"] = 1000 * of_refill.median();
  state.counters["face_planes_ms"] = 1000 * of_fresh.median();
  state.counters["none_ms"] = 1000 * of_none.median();
  state.counters["tiles_ms"] = 1000 * of_tiles.median();
  state.counters["follow_ms"] = 1000 * of_following.median();
  state.counters["ratio"] = of_following.median() / of_tiles.median();
  state.counters["touched"] = following.touched();
  state.counters["nodes_tiles"] = made.node_count();
}

[[maybe_unused]] const bool is_registered = [] {
  const std::pair<const char*, Casters (*)(int)> scenes[] = {{"balls", balls}, {"soup", soup}};
  for (const auto& [name, make] : scenes)
    add_timed(fmt::format("update_trees/{}", name), update, make)->ArgName("moving")->ArgsProduct({{1, 8, 32}})->Iterations(7);
  return true;
}();

}  // namespace
