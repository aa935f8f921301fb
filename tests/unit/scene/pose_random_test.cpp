// Random poses against a second way: each vertex alone, in long double, turned by its quaternions without a matrix.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "measure/scene/pose.h"

namespace pose_random_test {

using namespace gnomon;
using Property = Track::Property;
using Real = long double;
using Point = glm::vec<3, Real>;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double number(double most) { return std::uniform_real_distribution(-most, most)(engine_); }
  std::uint32_t below(std::size_t count) {
    return static_cast<std::uint32_t>(std::uniform_int_distribution<std::size_t>(0, count - 1)(engine_));
  }
  glm::dvec3 point(double most) { return {number(most), number(most), number(most)}; }
  glm::dvec4 turn() { return glm::normalize(glm::dvec4(point(1), number(1))); }
  glm::dmat4 matrix() {
    glm::dmat4 matrix(1);
    for (int c = 0; c < 4; ++c) matrix[c] = glm::dvec4(point(1), c == 3);
    return matrix;
  }
  std::vector<double> numbers(std::size_t count, double most) {
    std::vector<double> numbers(count);
    for (double& x : numbers) x = number(most);
    return numbers;
  }

 private:
  std::mt19937_64 engine_;
};

Track random_track(Random& random, std::uint32_t node, Property property, std::size_t width) {
  Track track{.node = node, .property = property, .interpolation = Track::Interpolation(random.below(3))};
  const bool is_cubic = track.interpolation == Track::Interpolation::cubic;
  const std::uint32_t last = random.below(3);
  for (std::uint32_t k = 0; k <= last; ++k) {
    track.times.push_back(k + 0.5);
    for (int part = 0; part < (is_cubic ? 3 : 1); ++part) {
      std::vector<double> value = random.numbers(width, 1.5);
      if (const glm::dvec4 q = random.turn(); property == Property::rotation) value = {q.x, q.y, q.z, q.w};
      track.values.insert(track.values.end(), value.begin(), value.end());
    }
  }
  return track;
}

/// Up to six nodes, a skin of three of them, and at each node a triangle with as many targets as it has weights.
Motion random_motion(Random& random) {
  Motion motion;
  Animation animation{.name = "any", .tracks = {}};
  const std::uint32_t count = 1 + random.below(6);
  for (std::uint32_t n = 0; n < count; ++n) {
    MotionNode node{.translation = random.point(2), .rotation = random.turn(), .scale = random.point(1.5)};
    if (n > 0 && random.below(4) > 0) node.parent = random.below(n);
    if (random.below(5) == 0) node.matrix = random.matrix();
    node.weights = random.numbers(random.below(3), 1);
    for (const Property property : {Property::translation, Property::rotation, Property::scale})
      if (!node.matrix && random.below(2) == 0)
        animation.tracks.push_back(random_track(random, n, property, property == Property::rotation ? 4 : 3));
    if (!node.weights.empty() && random.below(2) == 0)
      animation.tracks.push_back(random_track(random, n, Property::weights, node.weights.size()));
    Rig rig{.mesh = n, .node = n};
    rig.placement = {.scale = random.point(2), .rotate_degrees = random.point(360), .translate = random.point(5)};
    for (int v = 0; v < 3; ++v) rig.base.push_back(random.point(2));
    for (std::size_t d = 0; d < 3 * node.weights.size(); ++d) rig.targets.push_back(random.point(1));
    if (random.below(2) == 0) {
      rig.skin = 0;
      rig.joints_per_vertex = 4;
      rig.weights = random.numbers(12, 1);
      for (double& weight : rig.weights) {
        rig.joints.push_back(random.below(3));
        if (random.below(3) == 0) weight = 0;
      }
    }
    motion.nodes.push_back(std::move(node));
    motion.rigs.push_back(std::move(rig));
  }
  Skin skin;
  for (int j = 0; j < 3; ++j) {
    skin.joints.push_back(random.below(count));
    skin.inverse_bind.push_back(random.matrix());
  }
  motion.skins = {skin};
  motion.animations = {animation};
  return motion;
}

Point placed(const glm::dmat4& matrix, const Point& p) {
  return Point(matrix[3]) + p.x * Point(matrix[0]) + p.y * Point(matrix[1]) + p.z * Point(matrix[2]);
}

/// In the world, from node `n`.
Point placed(const std::vector<MotionNode>& nodes, std::uint32_t n, Point p) {
  for (; n != MotionNode::none; n = nodes[n].parent) {
    const MotionNode& node = nodes[n];
    if (node.matrix) {
      p = placed(*node.matrix, p);
      continue;
    }
    const Point axis(node.rotation.x, node.rotation.y, node.rotation.z);
    p *= Point(node.scale);
    p += Real(2) * (Real(node.rotation.w) * glm::cross(axis, p) + glm::cross(axis, glm::cross(axis, p)));
    p += Point(node.translation);
  }
  return p;
}

Point placed(const Placement& placement, Point p) {
  p *= Point(placement.scale);
  for (int axis = 0; axis < 3; ++axis) {
    const Real angle = placement.rotate_degrees[axis] * std::numbers::pi_v<Real> / 180;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const Real before = p[u];
    p[u] = std::cos(angle) * before - std::sin(angle) * p[v];
    p[v] = std::sin(angle) * before + std::cos(angle) * p[v];
  }
  return p + Point(placement.translate);
}

/// Where vertex `v` is.
Point plain(const Motion& motion, const std::vector<MotionNode>& nodes, const Rig& rig, std::size_t v) {
  Point p(rig.base[v]);
  const std::vector<double>& weights = nodes[rig.node].weights;
  for (std::size_t t = 0; t < weights.size(); ++t) p += Real(weights[t]) * Point(rig.targets[3 * t + v]);
  Point world(0);
  if (rig.skin == Rig::no_skin) world = placed(nodes, rig.node, p);
  for (std::size_t k = 0; k < rig.joints_per_vertex; ++k) {
    const std::size_t place = rig.joints_per_vertex * v + k;
    const std::uint32_t joint = rig.joints[place];
    const Skin& skin = motion.skins[rig.skin];
    world += Real(rig.weights[place]) * placed(nodes, skin.joints[joint], placed(skin.inverse_bind[joint], p));
  }
  return placed(rig.placement, world);
}

std::vector<MotionNode> nodes_at(const Motion& motion, double seconds) {
  std::vector<MotionNode> nodes = motion.nodes;
  for (const Track& track : motion.animations[0].tracks) {
    const std::vector<double> value = sampled(track, seconds);
    MotionNode& node = nodes[track.node];
    if (track.property == Property::translation) node.translation = {value[0], value[1], value[2]};
    if (track.property == Property::scale) node.scale = {value[0], value[1], value[2]};
    if (track.property == Property::rotation) node.rotation = {value[0], value[1], value[2], value[3]};
    if (track.property == Property::weights) node.weights = value;
  }
  return nodes;
}

TEST(Pose, of_random_motions_is_exact_but_for_one_rounding) {
  for (unsigned seed = 0; seed < 500; ++seed) {
    Random random(seed);
    const Motion motion = random_motion(random);
    Scene scene;
    for (std::size_t m = 0; m < motion.rigs.size(); ++m) scene.meshes.push_back({.positions = std::vector<glm::vec3>(3)});
    scene.motion = std::make_shared<const Motion>(motion);
    const std::vector<bool> moved = moved_rigs(motion, motion.animations[0]);
    for (const double t : {0.0, 0.5, 0.5 + 2 * std::abs(random.number(1)), 9.0}) {
      pose(scene, motion.animations[0], t);
      const std::vector<MotionNode> nodes = nodes_at(motion, t);
      for (std::size_t m = 0; m < motion.rigs.size(); ++m)
        for (int v = 0; v < 3; ++v) {
          const glm::vec3& p = scene.meshes[m].positions[v];
          const Point exact = moved[m] ? plain(motion, nodes, motion.rigs[m], v) : Point(0);
          // Half a unit in the last place of float32; six nodes take lengths to 2000 m, and double's rounding to 1e-11 m.
          for (int c = 0; c < 3; ++c)
            ASSERT_LE(std::abs(p[c] - exact[c]), std::abs(exact[c]) * Real(0x1p-24) + Real(1e-10)) << seed << ' ' << t;
        }
    }
  }
}

// What `moved_rigs` leaves out stands still at all times.
TEST(Pose, of_rigs_that_an_animation_does_not_move_is_always_their_own) {
  std::size_t still = 0, moving = 0;
  for (unsigned seed = 0; seed < 500; ++seed) {
    Random random(seed);
    const Motion motion = random_motion(random);
    const std::vector<bool> moved = moved_rigs(motion, motion.animations[0]);
    for (std::size_t m = 0; m < motion.rigs.size(); ++m) {
      moving += moved[m];
      if (moved[m]) continue;
      ++still;
      for (const double t : {0.0, 1.2})
        ASSERT_EQ(plain(motion, nodes_at(motion, t), motion.rigs[m], 1), plain(motion, motion.nodes, motion.rigs[m], 1));
    }
  }
  EXPECT_GT(still, 100u);
  EXPECT_GT(moving, 1000u);
}

}  // namespace pose_random_test
