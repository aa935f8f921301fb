#pragma once
// Regular BSP trees looked at from outside: scenes for them, and what must be true of every one.
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include "hard_scenes.h"
#include "techniques/svbsp/bsp.h"

namespace gnomon::bsp_rig {

using namespace svbsp;

using Choice = BspOptions::Choice;

inline const std::vector<BspOptions> all_options = {{},
                                                    {.free_cuts = false},
                                                    {.choice = Choice::fewest_splits},
                                                    {.choice = Choice::fewest_splits, .free_cuts = false, .candidates = 20},
                                                    {.choice = Choice::first},
                                                    {.candidates = 1, .sample = 1}};

inline Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.meshes = std::move(meshes);
  return scene;
}

inline std::vector<Triangle> triangles_of(const Scene& scene) {
  std::vector<Triangle> triangles;
  for (const Mesh& mesh : scene.meshes)
    for (const glm::uvec3& t : mesh.triangles)
      triangles.push_back({{mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}});
  return triangles;
}

inline glm::dvec3 normal_of(const Triangle& t) {
  const glm::dvec3 a(t.points[0]);
  return glm::normalize(glm::cross(glm::dvec3(t.points[1]) - a, glm::dvec3(t.points[2]) - a));
}

/// How far a point of the polygon's plane is inside it, by its nearest edge; negative outside.
inline double depth_inside(std::span<const Corner> polygon, const glm::dvec3& normal, const glm::dvec3& p) {
  double least = INFINITY;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 a = polygon[i].at, along = polygon[(i + 1) % polygon.size()].at - a;
    least = std::min(least, glm::dot(glm::cross(along, p - a), normal) / std::max(glm::length(along), 1e-300));
  }
  return least;
}

inline double area(std::span<const Corner> polygon) {
  glm::dvec3 sum(0);
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += glm::cross(polygon[i - 1].at - polygon[0].at, polygon[i].at - polygon[0].at);
  return glm::length(sum) / 2;
}

/// The triangles of each coplanar set, sorted, from front to back.
inline std::vector<std::vector<std::uint32_t>> order(const Bsp& bsp, const glm::dvec4& from) {
  std::vector<std::vector<std::uint32_t>> sets;
  bsp.front_to_back(from, [&](std::span<const BspPolygon> set) {
    sets.emplace_back();
    for (const BspPolygon& polygon : set) sets.back().push_back(polygon.triangle);
    std::ranges::sort(sets.back());
  });
  return sets;
}

/// Six kinds of scenes, one after the other.
inline Scene random_scene(Random& random, int round) {
  std::mt19937 engine(static_cast<unsigned>(round));
  switch (round % 6) {
    case 0:
      return scene_of({hard_scenes::grid_soup(random, 40)});
    case 1:
      return scene_of({hard_scenes::boxes(random, 6, true), hand_made::square(3, 0)});
    case 2:
      return scene_of({hard_scenes::boxes(random, 6, false), hand_made::square(3, 0)});
    case 3:
      return scene_of({hard_scenes::cycle(2, 0), hard_scenes::cycle(1, 0.3f), hard_scenes::grid_soup(random, 10)});
    case 4:
      return scene_of({small_world::random_soup(engine, 40, 2, 0.1f, 2, 0.6f), hand_made::square(3, 0)});
    default:
      return scene_of({tessellate(Sphere{{0.5f, 0, 0}, 1}, 8, "a"), tessellate(Sphere{{-0.5f, 0, 0}, 1}, 8, "b")});
  }
}

/// Areas of the parts against those of the triangles; edges of parts against those of their triangle: what is marked 0 lies on
/// one of them, what is marked 1 does not. A sliver of 2^-12 m is at most as wide there.
inline void expect_partition(const Scene& scene, const Bsp& bsp) {
  const std::vector<Triangle> triangles = triangles_of(scene);
  std::vector<double> areas(triangles.size(), 0);
  for (const BspPolygon& polygon : bsp.polygons()) {
    const std::span<const Corner> corners = bsp.corners(polygon);
    ASSERT_GE(corners.size(), 3u);
    areas[polygon.triangle] += area(corners);
    const Triangle& t = triangles[polygon.triangle];
    const glm::dvec3 n = normal_of(t);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec3 a = corners[i].at, b = corners[(i + 1) % corners.size()].at;
      EXPECT_LT(std::abs(glm::dot(n, a - glm::dvec3(t.points[0]))), 1e-8);
      double off = INFINITY;  // of both ends, from the nearest of the triangle's own edges
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 p(t.points[k]), along = glm::normalize(glm::dvec3(t.points[(k + 1) % 3]) - p);
        off = std::min(off, std::max(glm::length(glm::cross(along, a - p)), glm::length(glm::cross(along, b - p))));
      }
      if (corners[i].edge == 0) {
        EXPECT_LT(off, 1e-8);
      } else {
        EXPECT_EQ(corners[i].edge, 1u);
        // A cut that starts at a corner may leave an edge at as small an angle as epsilon over its length.
        if (glm::distance(a, b) > 1e-3) {
          EXPECT_GT(off, bsp.epsilon() / 1000);
        }
      }
    }
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const glm::dvec3 a(triangles[i].points[0]);
    const double whole =
        glm::length(glm::cross(glm::dvec3(triangles[i].points[1]) - a, glm::dvec3(triangles[i].points[2]) - a)) / 2;
    EXPECT_NEAR(areas[i], whole, 1e-8 * (1 + whole)) << i;
  }
}

}  // namespace gnomon::bsp_rig
