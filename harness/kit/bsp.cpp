#include <gnomon/error.h>
#include <gnomon/kit/bsp.h>
#include <gnomon/kit/exact.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>

namespace gnomon {

namespace {

/// A triangle on its way down, or a part of one.
struct Piece {
  float at[9];  ///< three corners; of a part the lower and the upper corner of its box, rounded outward
  std::uint32_t triangle;
  const Corner* corners;  ///< of a part; null for a triangle
  std::uint32_t count;    ///< of a part
};

struct Divider {
  ClipPlane plane;
  int axis = -1;            ///< of a free cut
  double place = 0;         ///< of a free cut
  std::uint32_t owner = 0;  ///< the piece in the list whose plane it is, of others
  Triangle triangle;        ///< of the owner
};

/// The unit normal's error, an angle, is that of the cross product, some 2^-52, over the sine between the edges: below 1e-11 as
/// it stands where the sine is above 1e-4, and otherwise the product is taken in quadruple precision, where it is exact.
bool plane_of(const Triangle& t, ClipPlane& plane) {
  const glm::dvec3 a(t.points[0]), u = glm::dvec3(t.points[1]) - a, v = glm::dvec3(t.points[2]) - a;
  glm::dvec3 n = glm::cross(u, v);
  if (!(glm::dot(n, n) > 1e-8 * glm::dot(u, u) * glm::dot(v, v))) {
    using Quad = __float128;
    const auto product = [&](int i, int j) { return Quad(u[i]) * v[j] - Quad(u[j]) * v[i]; };
    Quad q[3] = {product(1, 2), product(2, 0), product(0, 1)}, largest = 0;
    for (const Quad x : q) largest = std::max(largest, x < 0 ? -x : x);
    if (largest == 0) return false;
    for (int k = 0; k < 3; ++k) n[k] = static_cast<double>(q[k] / largest);
  }
  plane.normal = n / std::sqrt(glm::dot(n, n));
  plane.offset = -glm::dot(plane.normal, a);
  return true;
}

/// Corners of parts, from many threads. They stay where they are until the tree is made.
class Arena {
 public:
  class Lot {
   public:
    explicit Lot(Arena& arena) : arena_(arena) {}
    Corner* reserve(std::size_t count) {
      if (static_cast<std::size_t>(end_ - next_) < count) {
        const std::size_t size = std::max<std::size_t>(count, 2048);
        next_ = arena_.take(size);
        end_ = next_ + size;
      }
      return next_;
    }
    void keep(std::size_t count) { next_ += count; }

   private:
    Arena& arena_;
    Corner *next_ = nullptr, *end_ = nullptr;
  };

 private:
  Corner* take(std::size_t size) {
    std::unique_ptr<Corner[]> lot(new Corner[size]);
    const std::scoped_lock lock(mutex_);
    lots_.push_back(std::move(lot));
    return lots_.back().get();
  }
  std::mutex mutex_;
  std::vector<std::unique_ptr<Corner[]>> lots_;
};

}  // namespace

struct BspBuilder {
  using Node = Bsp::Node;
  static constexpr std::uint32_t none = Bsp::none;

  /// What a task has made: nodes of its own, and their polygons.
  struct Grown {
    std::vector<Node> nodes;
    std::vector<Piece> sets;
    std::size_t splits = 0, depth = 0, corners = 0;
  };

  const Scene& scene;
  const BspOptions& options;
  double epsilon;
  std::vector<std::uint32_t> first_triangle;
  Arena arena;

  Triangle triangle(const Piece& piece) const {
    Triangle t;
    if (!piece.corners) {
      for (int k = 0; k < 3; ++k) t.points[k] = {piece.at[3 * k], piece.at[3 * k + 1], piece.at[3 * k + 2]};
      return t;
    }
    const auto m =
        static_cast<std::size_t>(std::ranges::upper_bound(first_triangle, piece.triangle) - first_triangle.begin()) - 1;
    const Mesh& mesh = scene.meshes[m];
    const glm::uvec3& v = mesh.triangles[piece.triangle - first_triangle[m]];
    return {{mesh.positions[v.x], mesh.positions[v.y], mesh.positions[v.z]}};
  }

  /// Divides lists of pieces, one after the other.
  struct Worker {
    Worker(BspBuilder& builder, Grown& grown) : builder(builder), grown(grown), lot(builder.arena) {}
    BspBuilder& builder;
    Grown& grown;
    Arena::Lot lot;
    std::vector<Piece> positive;
    std::vector<double> values;
    std::vector<Corner> part;
    std::vector<float> places;

    Lies lies(const Piece& piece, const Divider& divider, std::vector<double>* values) const {
      const double epsilon = builder.epsilon;
      if (!piece.corners) {
        unsigned lies = 0;
        for (int k = 0; k < 3; ++k) {
          const double value = divider.plane.at({piece.at[3 * k], piece.at[3 * k + 1], piece.at[3 * k + 2]});
          if (values) (*values)[k] = value;
          lies |= static_cast<unsigned>(value < -epsilon) | static_cast<unsigned>(value > epsilon) << 1;
        }
        return static_cast<Lies>(lies);
      }
      const glm::dvec3& n = divider.plane.normal;
      double low = divider.plane.offset, high = low;
      for (int k = 0; k < 3; ++k) {
        low += n[k] * piece.at[n[k] > 0 ? k : 3 + k];
        high += n[k] * piece.at[n[k] > 0 ? 3 + k : k];
      }
      if (low > epsilon) return Lies::positive;
      if (high < -epsilon) return Lies::negative;
      if (!values) return Lies::across;
      values->resize(std::max<std::size_t>(values->size(), piece.count));
      return classify({piece.corners, piece.count}, divider.plane, epsilon, values->data());
    }

    /// For pieces within epsilon.
    Lies lies_exactly(const Piece& piece, const Divider& divider) const {
      const Triangle t = builder.triangle(piece);
      int low = 1, high = -1;
      for (const glm::vec3& p : t.points) {
        int sign;
        if (divider.axis < 0)
          sign = orient3d_sign(divider.triangle.points[0], divider.triangle.points[1], divider.triangle.points[2], p);
        else
          sign = (p[divider.axis] > divider.place) - (p[divider.axis] < divider.place);
        low = std::min(low, sign), high = std::max(high, sign);
      }
      if (high <= 0 && low < 0) return Lies::negative;
      if (low >= 0 && high > 0) return Lies::positive;
      return Lies::within;
    }

    void choose(std::span<const Piece> list, bool with_free_cuts, Divider& best) {
      const BspOptions& options = builder.options;
      const std::size_t n = list.size();
      const auto face = [&](std::size_t i, Divider& divider) {
        divider.axis = -1;
        divider.owner = static_cast<std::uint32_t>(i);
        divider.triangle = builder.triangle(list[i]);
        plane_of(divider.triangle, divider.plane);
      };
      if (options.choice == BspOptions::Choice::first || n == 1) {
        face(0, best);
        return;
      }
      const std::size_t sample = std::min<std::size_t>(n, options.sample);
      const auto sampled = [&](std::size_t k, std::size_t count) { return (2 * k + 1) * n / (2 * count); };
      std::pair<long, long> least{std::numeric_limits<long>::max(), 0};
      const auto consider = [&](const Divider& divider) {
        long counts[4] = {};
        for (std::size_t k = 0; k < sample; ++k)
          ++counts[static_cast<unsigned>(lies(list[sampled(k, sample)], divider, nullptr))];
        const long imbalance = std::abs(counts[1] - counts[2]);
        if (divider.axis >= 0 && imbalance > static_cast<long>(sample / 2)) return;
        std::pair<long, long> score{counts[3], imbalance};
        if (options.choice == BspOptions::Choice::balanced) score = {8 * counts[3] + imbalance, 0};
        if (score < least) least = score, best = divider;
      };
      Divider divider;
      if (with_free_cuts && n >= 8) {
        for (int axis = 0; axis < 3; ++axis) {
          places.clear();
          for (std::size_t k = 0; k < sample; ++k) {
            const Piece& piece = list[sampled(k, sample)];
            places.push_back(piece.corners ? piece.at[axis]
                                           : std::min({piece.at[axis], piece.at[axis + 3], piece.at[axis + 6]}));
          }
          const auto middle = places.begin() + static_cast<std::ptrdiff_t>(places.size() / 2);
          std::nth_element(places.begin(), middle, places.end());
          divider.axis = axis;
          divider.place = *middle;
          divider.plane = {};
          divider.plane.normal[axis] = 1;
          divider.plane.offset = -divider.place;
          consider(divider);
        }
      }
      const std::size_t candidates = std::min<std::size_t>(n, options.candidates);
      for (std::size_t k = 0; k < candidates; ++k) {
        face(sampled(k, candidates), divider);
        consider(divider);
      }
    }

    Piece make_part(std::uint32_t triangle, const Corner* corners, std::size_t count) {
      Piece made{.at = {}, .triangle = triangle, .corners = corners, .count = static_cast<std::uint32_t>(count)};
      glm::dvec3 low = corners[0].at, high = low;
      for (std::size_t i = 1; i < count; ++i) low = glm::min(low, corners[i].at), high = glm::max(high, corners[i].at);
      for (int k = 0; k < 3; ++k) {
        made.at[k] = static_cast<float>(low[k]);
        if (made.at[k] > low[k]) made.at[k] = std::nextafter(made.at[k], -INFINITY);
        made.at[3 + k] = static_cast<float>(high[k]);
        if (made.at[3 + k] < high[k]) made.at[3 + k] = std::nextafter(made.at[3 + k], INFINITY);
      }
      return made;
    }

    /// Leaves the negative pieces of list in its front, and says how many; the positive ones in `positive`, the rest in `sets`.
    std::size_t divide(std::span<Piece> list, const Divider& divider) {
      std::size_t negative = 0;
      positive.clear();
      values.resize(std::max<std::size_t>(values.size(), 3));
      for (std::size_t i = 0; i < list.size(); ++i) {
        const Piece piece = list[i];
        if (divider.axis < 0 && i == divider.owner) {
          grown.sets.push_back(piece);
          continue;
        }
        Lies where = lies(piece, divider, &values);
        if (where == Lies::within) where = lies_exactly(piece, divider);
        switch (where) {
          case Lies::within:
            grown.sets.push_back(piece);
            break;
          case Lies::negative:
            list[negative++] = piece;
            break;
          case Lies::positive:
            positive.push_back(piece);
            break;
          case Lies::across: {
            Corner own[3];
            std::span<const Corner> polygon(piece.corners, piece.count);
            if (!piece.corners) {
              for (int k = 0; k < 3; ++k) own[k] = {{piece.at[3 * k], piece.at[3 * k + 1], piece.at[3 * k + 2]}, 0};
              polygon = own;
            }
            part.resize(std::max(part.size(), polygon.size() + 1));
            Corner* const room = lot.reserve(2 * polygon.size() + 2);
            const CutCounts counts = cut_polygon(polygon, values.data(), builder.epsilon, 1, room, part.data());
            std::copy_n(part.data(), counts.positive, room + counts.negative);
            lot.keep(counts.negative + counts.positive);
            list[negative++] = make_part(piece.triangle, room, counts.negative);
            positive.push_back(make_part(piece.triangle, room + counts.negative, counts.positive));
            ++grown.splits;
            break;
          }
        }
      }
      return negative;
    }

    /// The tree of a list, its root first.
    void grow(std::vector<Piece>& list, std::size_t depth) {
      struct Task {
        std::size_t begin, depth;
        std::uint32_t parent, side;
        bool with_free_cuts;
      };
      std::vector<Task> tasks{{0, depth, none, 0, builder.options.free_cuts}};
      while (!tasks.empty()) {
        const Task task = tasks.back();
        tasks.pop_back();
        const auto index = static_cast<std::uint32_t>(grown.nodes.size());
        if (task.parent != none) grown.nodes[task.parent].children[task.side] = index;
        grown.depth = std::max(grown.depth, task.depth);
        Node node{.plane = {}, .children = {none, none}, .first = static_cast<std::uint32_t>(grown.sets.size()), .count = 0};
        std::span<Piece> rest = std::span(list).subspan(task.begin);
        if (rest.size() == 1) {
          grown.sets.push_back(rest[0]);
          list.pop_back();
          node.count = 1;
          grown.nodes.push_back(node);
          continue;
        }
        Divider divider;
        choose(rest, task.with_free_cuts, divider);
        const std::size_t count = rest.size();
        const std::size_t negative = divide(rest, divider);
        node.plane = divider.plane;
        node.count = static_cast<std::uint32_t>(grown.sets.size()) - node.first;
        grown.nodes.push_back(node);
        list.resize(task.begin + negative);
        list.insert(list.end(), positive.begin(), positive.end());
        // A free cut takes no piece away: one that hardly divides is followed by a plane that does.
        const auto next = [&](std::size_t begin, std::size_t size, std::uint32_t side) {
          const bool with_free_cuts = builder.options.free_cuts && (divider.axis < 0 || 10 * size <= 9 * count);
          if (size > 0) tasks.push_back({begin, task.depth + 1, index, side, with_free_cuts});
        };
        next(task.begin, negative, 0);
        next(task.begin + negative, positive.size(), 1);
      }
    }
  };
};

Bsp::Bsp(const Scene& scene, const BspOptions& options) {
  if (options.candidates < 1) throw Error("BspOptions::candidates = 0 is outside 1 .. 4294967295");
  if (options.sample < 1) throw Error("BspOptions::sample = 0 is outside 1 .. 4294967295");
  const Bounds bounds = scene.bounds();
  if (bounds.empty()) return;
  const glm::vec3 largest = glm::max(glm::abs(bounds.min), glm::abs(bounds.max));
  epsilon_ = 1e-10 * std::max({largest.x, largest.y, largest.z});
  BspBuilder builder{.scene = scene, .options = options, .epsilon = epsilon_, .first_triangle = {}, .arena = {}};
  std::vector<Piece> list;
  list.reserve(scene.triangle_count());
  std::uint32_t index = 0;
  for (const Mesh& mesh : scene.meshes) {
    builder.first_triangle.push_back(index);
    for (const glm::uvec3& t : mesh.triangles) {
      Piece piece{.at = {}, .triangle = index++, .corners = nullptr, .count = 3};
      Triangle triangle;
      for (int k = 0; k < 3; ++k) {
        triangle.points[k] = mesh.positions[t[k]];
        for (int c = 0; c < 3; ++c) piece.at[3 * k + c] = triangle.points[k][c];
      }
      if (ClipPlane plane; plane_of(triangle, plane)) list.push_back(piece);
    }
  }
  if (list.empty()) return;
  BspBuilder::Grown grown;
  BspBuilder::Worker(builder, grown).grow(list, 1);
  nodes_ = std::move(grown.nodes);
  for (const Piece& piece : grown.sets) {
    polygons_.push_back({piece.triangle, static_cast<std::uint32_t>(corners_.size()), piece.count});
    if (piece.corners) {
      corners_.insert(corners_.end(), piece.corners, piece.corners + piece.count);
    } else {
      for (int k = 0; k < 3; ++k) corners_.push_back({{piece.at[3 * k], piece.at[3 * k + 1], piece.at[3 * k + 2]}, 0});
    }
  }
  split_count_ = grown.splits;
  depth_ = grown.depth;
}

}  // namespace gnomon
