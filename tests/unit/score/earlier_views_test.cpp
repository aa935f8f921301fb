// Flicker where the camera moves: against values derived on paper, and against a search through all pixels.
#include "measure/score/earlier_views.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "film.h"

namespace earlier_views_test {

using namespace gnomon;
using film::Film;
using film::Frame;

constexpr float field = 90;  // degrees: half a picture's height is as far as the wall

/// The wall z = 0 from in front, so near that a pixel is 1 m wide; column c of the frame shows x = slid + c.
Frame wall(int width, int height, double slid) {
  Frame frame(width, height);
  const double middle = slid + (width - 1) / 2.0;
  frame.picture->gbuffer.view = {
      .name = "wall", .eye = glm::vec3(middle, 0, height / 2.0), .target = glm::vec3(middle, 0, 0), .fov_y_degrees = field};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      frame.picture->set(static_cast<std::size_t>(y * width + x), glm::vec3(slid + x, (height - 1) / 2.0 - y, 0), {0, 0, 1}, 0,
                         0);
  return frame;
}

/// A film of walls, slid by `step` meters a frame.
Film slide(std::size_t frames, int width, int height, double step) {
  Film film;
  for (std::size_t t = 0; t < frames; ++t) film.push_back(wall(width, height, step * static_cast<double>(t)));
  return film;
}

std::optional<double> camera_score(const Film& film, std::string_view metric) {
  return film::score(film, 60, Path::Moves::camera).find(metric)->second;
}

// At the points x = 1, 2, 3 the error changes by -0.2, 0 and -0.1: sqrt((0.04 + 0 + 0.01) / 3) = 0.1291. Points 0 and 4 are in
// one frame each, with errors that would show.
TEST(earlier_views, flicker_is_that_of_the_points_in_both_frames) {
  Film film = slide(2, 4, 1, 1);
  film[0].mask = {1, 1, 0.5f, 0};
  film[0].reference = {0, 1, 0.5f, 0};
  film[1].mask = {0.8f, 0.5f, 0.4f, 1};
  film[1].reference = {1, 0.5f, 0.5f, 0};
  EXPECT_NEAR(*camera_score(film, "flicker_1_60"), std::sqrt(0.05 / 3), 1e-7);
  EXPECT_EQ(camera_score(film, "steady_share"), 0.75);
  EXPECT_EQ(camera_score(film, "flicker_1_15"), std::nullopt) << "the row is shorter";
}

TEST(earlier_views, an_error_that_lies_on_the_surface_does_not_flicker) {
  Film film = slide(20, 24, 3, 1);
  for (std::size_t t = 0; t < film.size(); ++t)
    for (std::size_t i = 0; i < film[t].mask.size(); ++i) {
      const std::size_t x = t + i % 24;
      film[t].reference[i] = static_cast<float>(x % 5 < 2);
      film[t].mask[i] = static_cast<float>(x % 7 < 3);
    }
  for (const FlickerMetric& flicker : flicker_metrics) EXPECT_EQ(camera_score(film, flicker.name), 0) << flicker.name;
  EXPECT_EQ(camera_score(film, "steady_share"), 23.0 / 24);
  for (const std::string_view none : {"temporal_sd", "false_flips", "late_flips"})
    EXPECT_EQ(camera_score(film, none), std::nullopt) << none;
}

TEST(earlier_views, a_right_mask_does_not_flicker_at_any_step) {
  Film film = slide(20, 24, 3, 0.37);
  for (Frame& frame : film)
    for (std::size_t i = 0; i < frame.mask.size(); ++i)
      frame.mask[i] = frame.reference[i] = static_cast<float>(std::fmod(frame.picture->value[0][i], 5) < 2);
  for (const FlickerMetric& flicker : flicker_metrics) EXPECT_EQ(camera_score(film, flicker.name), 0) << flicker.name;
}

// A step of 0.25 px leaves the nearest center 0.25 px off: e changes where an edge lies between both centers. Stripes have two
// edges in 10 px, so that 2 * 0.25 / 10 = 0.05 of the pairs change by 1. Each edge is 1/8 px before the center of a pixel.
TEST(earlier_views, the_edge_of_an_error_on_the_surface_flickers_by_the_way_to_the_nearest_center) {
  Film film = slide(41, 80, 1, 0.25);
  for (Frame& frame : film)
    for (std::size_t i = 0; i < frame.mask.size(); ++i)
      frame.mask[i] = static_cast<float>(std::fmod(frame.picture->value[0][i] + 0.125, 10) < 5);
  // The point of the last column is 0.25 px from the earlier center of that column, within the picture.
  EXPECT_EQ(camera_score(film, "steady_share"), 1);
  EXPECT_NEAR(*camera_score(film, "flicker_1_60"), std::sqrt(0.05), 0.01);
  EXPECT_EQ(camera_score(film, "flicker_1_15"), 0) << "4 frames are a whole pixel";
}

TEST(earlier_views, an_error_that_lies_on_the_picture_flickers) {
  Film film = slide(20, 24, 3, 1);
  for (Frame& frame : film)
    for (std::size_t i = 0; i < frame.mask.size(); ++i) frame.mask[i] = static_cast<float>(i % 2);
  EXPECT_EQ(camera_score(film, "flicker_1_60"), 1);
  EXPECT_EQ(camera_score(film, "flicker_1_15"), 0) << "4 pixels are even";
  EXPECT_EQ(camera_score(film, "flicker_1_4"), 1) << "15 pixels are odd";
}

TEST(earlier_views, pixels_are_tested_in_both_frames_and_show_one_triangle) {
  // A mask that is wrong where it must not be compared: in the second frame everywhere but at column 0.
  Film film = slide(2, 4, 1, 1);
  film[1].mask = {0, 1, 1, 1};
  film[0].classes[2] = PixelClass::S;
  film[0].picture->triangle[3] = 1;
  EXPECT_EQ(camera_score(film, "flicker_1_60"), 0);
  EXPECT_EQ(camera_score(film, "steady_share"), 0.25) << "x = 1; 2 was not tested, 3 another triangle, 4 out of the picture";
  film[1].classes[0] = PixelClass::G;
  EXPECT_EQ(camera_score(film, "flicker_1_60"), std::nullopt);
  EXPECT_EQ(camera_score(film, "steady_share"), 0);
}

TEST(earlier_views, a_camera_that_rests_compares_what_one_that_stands_compares) {
  Film film = slide(20, 24, 3, 0);
  for (std::size_t t = 0; t < film.size(); ++t)
    for (std::size_t i = 0; i < film[t].mask.size(); ++i) film[t].mask[i] = static_cast<float>((7 * i + t * t) % 11) / 16;
  const Metrics stands = film::score(film, 60);
  for (const FlickerMetric& flicker : flicker_metrics)
    EXPECT_EQ(camera_score(film, flicker.name), stands.find(flicker.name)->second) << flicker.name;
  EXPECT_EQ(camera_score(film, "steady_share"), 1);
}

// --- a ball before a wall
// -----------------------------------------------------------------------------------------------------

constexpr int ball_width = 64, ball_height = 48;
constexpr double radius = 3;  // around the origin: mesh 1, all of it triangle 0; the wall z = -4 is mesh 0

/// The ball and the wall from an eye; errors of no pattern.
Frame ball(const glm::vec3& eye, std::size_t number) {
  Frame frame(ball_width, ball_height);
  const View view{.name = "ball", .eye = eye, .target = {0, 0, 0}, .fov_y_degrees = 50};
  frame.picture->gbuffer.view = view;
  const Camera camera(view, ball_width, ball_height);
  for (std::size_t i = 0; i < frame.mask.size(); ++i) {
    const glm::dvec3 ray = camera.ray(static_cast<double>(i % ball_width) + 0.5, static_cast<double>(i / ball_width) + 0.5);
    const double a = glm::dot(ray, ray), b = glm::dot(ray, camera.eye), c = glm::dot(camera.eye, camera.eye) - radius * radius;
    frame.mask[i] = static_cast<float>((37 * i + 11 * number) % 101) / 128;
    if (const double root = b * b - a * c; root > 0) {
      const glm::dvec3 point = camera.eye + ray * ((-b - std::sqrt(root)) / a);
      frame.picture->set(i, glm::vec3(point), glm::vec3(glm::normalize(point)), 1, 0);
    } else if (ray.z < 0 && camera.eye.z > -4) {
      const glm::dvec3 point = camera.eye - ray * ((camera.eye.z + 4) / ray.z);
      // Triangles in cells of 2.3 m.
      const auto cell = [](double x) { return static_cast<std::uint32_t>(std::floor(x / 2.3) + 1000); };
      frame.picture->set(i, glm::vec3(point), {0, 0, 1}, 0, cell(point.x) * 2000 + cell(point.y));
    } else {
      frame.picture->set(i, {}, {}, no_mesh, 0);
      frame.classes[i] = PixelClass::B;
    }
  }
  return frame;
}

/// Mean square of the changes and the share of pixels that have one: for each pixel a search through all of the frame before.
std::pair<double, double> searched(const Film& film, std::size_t lag) {
  double squares = 0, compared = 0, tested = 0;
  for (std::size_t t = lag; t < film.size(); ++t) {
    const Frame &now = film[t], &before = film[t - lag];
    const GBuffer &here = now.picture->gbuffer, &there = before.picture->gbuffer;
    const glm::dmat4 camera = glm::lookAt(glm::dvec3(there.view.eye), glm::dvec3(there.view.target), glm::dvec3(there.view.up));
    const double angle = glm::radians(static_cast<double>(there.view.fov_y_degrees));
    const glm::dmat4 picture = glm::perspective(angle, double(ball_width) / ball_height, 0.1, 1000.0) * camera;
    for (std::size_t i = 0; i < now.mask.size(); ++i) {
      if (now.classes[i] != PixelClass::T) continue;
      ++tested;
      const glm::dvec3 point = here.position(i), normal = here.normal(i);
      const glm::dvec4 clip = picture * glm::dvec4(point, 1);
      if (clip.w <= 0 || std::max(std::abs(clip.x), std::abs(clip.y)) > clip.w) continue;
      const glm::dvec2 place((clip.x / clip.w + 1) / 2 * ball_width, (1 - clip.y / clip.w) / 2 * ball_height);
      const auto distance = [&](std::size_t q) {
        return glm::length(place - glm::dvec2(double(q % ball_width) + 0.5, double(q / ball_width) + 0.5));
      };
      std::size_t nearest = 0;
      for (std::size_t q = 1; q < before.mask.size(); ++q)
        if (distance(q) < distance(nearest)) nearest = q;
      if (before.classes[nearest] != PixelClass::T || there.mesh[nearest] != here.mesh[i] ||
          there.triangle[nearest] != here.triangle[i])
        continue;
      if (glm::dot(normal, glm::dvec3(there.view.eye) - point) <= 0) continue;
      const double pixel = 2 * std::tan(angle / 2) * clip.w / ball_height;
      if (std::abs(glm::dot(normal, glm::dvec3(there.position(nearest)) - point)) > pixel) continue;
      ++compared;
      squares += std::pow((now.mask[i] - now.reference[i]) - (before.mask[nearest] - before.reference[nearest]), 2);
    }
  }
  return {std::sqrt(squares / compared), compared / tested};
}

TEST(earlier_views, finds_what_a_search_through_all_pixels_finds) {
  Film film;
  for (std::size_t t = 0; t < 6; ++t) {
    const double angle = 0.031 * static_cast<double>(t * t);
    film.push_back(ball(glm::vec3(11 * std::sin(angle), 2 + 0.11 * static_cast<double>(t), 11 * std::cos(angle)), t));
  }
  const auto [sixtieth, share] = searched(film, 1);
  EXPECT_NEAR(*camera_score(film, "flicker_1_60"), sixtieth, 1e-6);
  EXPECT_NEAR(*camera_score(film, "steady_share"), share, 1e-12);
  EXPECT_GT(share, 0.5);
  EXPECT_LT(share, 1);
  EXPECT_NEAR(*camera_score(film, "flicker_1_15"), searched(film, 4).first, 1e-6);
}

// Every pixel of the ball projects onto the ball's picture from behind, on the same mesh and triangle.
TEST(earlier_views, the_far_side_of_a_ball_is_not_its_near_side) {
  const auto behind = [](const glm::vec3& eye) {
    Film film;
    film.push_back(ball({0, 0, 11}, 0));
    film.push_back(ball(eye, 1));
    for (Frame& frame : film)
      for (std::size_t i = 0; i < frame.mask.size(); ++i)
        if (frame.picture->mesh[i] == 0) frame.classes[i] = PixelClass::U;
    return film;
  };
  EXPECT_EQ(camera_score(behind({0, 0, -11}), "steady_share"), 0);
  EXPECT_EQ(camera_score(behind({0, 0, -11}), "flicker_1_60"), std::nullopt);
  // From the side the eyes have in common where normals are within acos(3 / 11) of both: 0.33 of the disc, seen from far away.
  const std::optional<double> from_side = camera_score(behind({11, 0, 0}), "steady_share");
  EXPECT_GT(*from_side, 0.2);
  EXPECT_LT(*from_side, 0.5);
}

}  // namespace earlier_views_test
