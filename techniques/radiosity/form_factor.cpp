#include "form_factor.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace gnomon::radiosity {

namespace {

constexpr int most_order = 16;
constexpr std::size_t most_corners = 8;

/// Roots of the Legendre polynomial of degree n and their weights, on 0 .. 1, by Newton's method.
std::vector<std::pair<double, double>> gauss_rule(int n) {
  std::vector<std::pair<double, double>> rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 100; ++step) {
      double before = 1, here = x;
      for (int k = 2; k <= n; ++k) before = std::exchange(here, ((2 * k - 1) * x * here - (k - 1) * before) / k);
      slope = n * (x * here - before) / (x * x - 1);
      const double change = here / slope;
      x -= change;
      if (std::abs(change) < 1e-16) break;
    }
    rule.push_back({(1 + x) / 2, 1 / ((1 - x * x) * slope * slope)});
  }
  return rule;
}

struct GaussTables {
  std::array<std::array<std::vector<GaussPoint>, 2>, most_order + 1> points;
  GaussTables() {
    for (int n = 1; n <= most_order; ++n) {
      const auto rule = gauss_rule(n);
      for (const auto& [x, wx] : rule)
        for (const auto& [y, wy] : rule) {
          points[n][0].push_back({{x, y}, wx * wy});
          points[n][1].push_back({{x, y * (1 - x)}, 2 * wx * wy * (1 - x)});
        }
    }
    // One point of a triangle is its center.
    points[1][1] = {{{1.0 / 3, 1.0 / 3}, 1}};
  }
};

}  // namespace

double factor_at(const glm::dvec3& point, const glm::dvec3& normal, std::span<const glm::dvec3> polygon) {
  std::array<glm::dvec3, most_corners + 1> above;
  std::size_t count = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 a = polygon[i] - point, b = polygon[i + 1 < polygon.size() ? i + 1 : 0] - point;
    const double height_a = glm::dot(a, normal), height_b = glm::dot(b, normal);
    if (height_a > 0) above[count++] = a;
    if ((height_a > 0) != (height_b > 0)) above[count++] = a + (b - a) * (height_a / (height_a - height_b));
  }
  if (count < 3) return 0;
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3& a = above[i];
    const glm::dvec3& b = above[i + 1 < count ? i + 1 : 0];
    const glm::dvec3 across = glm::cross(a, b);
    const double sine = glm::length(across);
    if (sine > 0) sum += std::atan2(sine, glm::dot(a, b)) / sine * glm::dot(normal, across);
  }
  return std::abs(sum) / (2 * std::numbers::pi);
}

double mean_factor(const Patch& receiver, std::span<const glm::dvec3> polygon, int order) {
  double sum = 0;
  for (const GaussPoint& at : gauss_points(order, receiver.is_triangle))
    sum += at.weight * factor_at(receiver.corner + at.place.x * receiver.u + at.place.y * receiver.v, receiver.normal, polygon);
  return sum;
}

std::span<const GaussPoint> gauss_points(int order, bool is_triangle) {
  static const GaussTables tables;
  return tables.points[order][is_triangle];
}

}  // namespace gnomon::radiosity
