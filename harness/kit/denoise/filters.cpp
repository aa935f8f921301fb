#include <gnomon/error.h>
#include <gnomon/kit/denoise/filters.h>
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/vectorized.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon {

namespace {

constexpr std::size_t guide_rows = 8;  // of a task
constexpr int moment_chunk = 64;       // pixels of a row at once
using MomentChunk = std::array<float, moment_chunk>;

/// Adds f, f V and f V^2 of one tap to those of a chunk, where it is on the same mesh and near the plane.
GNOMON_VECTORIZED void add_share_moments(const FilterGuides::Row& middle, const FilterGuides::Row& beside,
                                         const float* numerator, const float* denominator, int count, float* __restrict sum_f,
                                         float* __restrict sum_v, float* __restrict sum_v2) {
  const FilterGuides::Row p = middle, q = beside;
  for (int i = 0; i < count; ++i) {
    const float dx = q.px[i] - p.px[i], dy = q.py[i] - p.py[i], dz = q.pz[i] - p.pz[i];
    const float apart = std::fabs(p.nx[i] * dx + p.ny[i] * dy + p.nz[i] * dz) * p.per_footprint[i];
    const bool joins = (p.mesh[i] == q.mesh[i]) & (q.mesh[i] != no_mesh) & (apart < 2);
    const float asked = denominator[i], seen = numerator[i];  // read unconditionally, or the loop is no vector loop
    const float f = joins ? asked : 0, v = joins ? seen : 0;
    sum_f[i] += f;
    sum_v[i] += v;
    sum_v2[i] += v * v / (f > 0 ? f : 1);
  }
}

FilterGuides::Row row_from(const FilterGuides::Row& g, std::ptrdiff_t x) {
  return {g.px + x, g.py + x, g.pz + x, g.nx + x, g.ny + x, g.nz + x, g.per_footprint + x, g.mesh + x};
}

}  // namespace

void FilterGuides::resize(int width, int height) {
  width_ = width;
  height_ = height;
  const std::size_t size = static_cast<std::size_t>(stride()) * height_;
  for (UnsetVector<float>* plane : {&px_, &py_, &pz_, &nx_, &ny_, &nz_, &footprint_, &per_footprint_}) plane->resize(size);
  mesh_.resize(size);
}

void FilterGuides::clear_row(int y) {
  const std::size_t start = at(0, y) - filter_margin, length = static_cast<std::size_t>(stride());
  for (UnsetVector<float>* plane : {&px_, &py_, &pz_, &nx_, &ny_, &nz_, &footprint_, &per_footprint_})
    std::fill_n(&(*plane)[start], length, 0.0f);
  std::fill_n(&mesh_[start], length, no_mesh);
}

void FilterGuides::make(const GBuffer& gbuffer, std::span<const std::uint8_t> faces) {
  if (faces.size() != gbuffer.size())
    throw Error("flags of {} pixels do not fit a G-buffer of {} x {}", faces.size(), gbuffer.width, gbuffer.height);
  resize(gbuffer.width, gbuffer.height);
  const Camera camera(gbuffer.view, width_, height_);
  const double per_meter = 2 * camera.tan_y / height_;  // pixel's height at a depth of 1 m, along the view's axis
  for_blocks(static_cast<std::size_t>(height_), guide_rows, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      clear_row(y);
      for (int x = 0; x < width_; ++x) {
        const std::size_t i = static_cast<std::size_t>(y) * width_ + x, to = at(x, y);
        if (faces[i] == 0 || gbuffer.is_background(i)) continue;
        px_[to] = gbuffer.px[i];
        py_[to] = gbuffer.py[i];
        pz_[to] = gbuffer.pz[i];
        nx_[to] = gbuffer.nx[i];
        ny_[to] = gbuffer.ny[i];
        nz_[to] = gbuffer.nz[i];
        mesh_[to] = gbuffer.mesh[i];
        const double depth = glm::dot(glm::dvec3(gbuffer.position(i)) - camera.eye, camera.forward);
        footprint_[to] = static_cast<float>(std::max(depth * per_meter, 1e-30));  // points are before the eye; 1 / it is finite
        per_footprint_[to] = 1 / footprint_[to];
      }
    }
  });
}

void FilterGuides::halve(const FilterGuides& fine) {
  resize((fine.width_ + 1) / 2, (fine.height_ + 1) / 2);
  for_blocks(static_cast<std::size_t>(height_), guide_rows, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      clear_row(y);
      for (int x = 0; x < width_; ++x)
        for (int k = 0; k < 4; ++k) {
          const int fine_x = 2 * x + k % 2, fine_y = 2 * y + k / 2;
          if (fine_x >= fine.width_ || fine_y >= fine.height_ || !fine.counts(fine_x, fine_y)) continue;
          const std::size_t from = fine.at(fine_x, fine_y), to = at(x, y);
          for (UnsetVector<float> FilterGuides::*plane :
               {&FilterGuides::px_, &FilterGuides::py_, &FilterGuides::pz_, &FilterGuides::nx_, &FilterGuides::ny_,
                &FilterGuides::nz_, &FilterGuides::footprint_, &FilterGuides::per_footprint_})
            (this->*plane)[to] = (fine.*plane)[from];
          mesh_[to] = fine.mesh_[from];
          break;
        }
    }
  });
}

bool FilterGuides::joins(int x, int y, const FilterGuides& other, glm::ivec2 there) const {
  constexpr float near = 2, alike = 0.866f;
  const std::size_t p = at(x, y), q = other.at(there.x, there.y);
  if (mesh_[p] == no_mesh || mesh_[p] != other.mesh_[q]) return false;
  const glm::vec3 normal(nx_[p], ny_[p], nz_[p]), apart(other.px_[q] - px_[p], other.py_[q] - py_[p], other.pz_[q] - pz_[p]);
  return std::fabs(glm::dot(normal, apart)) * per_footprint_[p] < near &&
         glm::dot(normal, glm::vec3(other.nx_[q], other.ny_[q], other.nz_[q])) > alike;
}

FilterGuides::Row FilterGuides::row(int y) const {
  const std::size_t start = at(0, y);
  return {&px_[start], &py_[start], &pz_[start], &nx_[start], &ny_[start], &nz_[start], &per_footprint_[start], &mesh_[start]};
}

std::size_t FilterGuides::bytes() const { return mesh_.size() * (8 * sizeof(float) + sizeof(std::uint32_t)); }

float sigma_of_width(float width_pixels) noexcept {
  if (!(width_pixels > 0)) return 0;
  const float root = std::cbrt(width_pixels / 12);
  return 1.8f * root * root;
}

float penumbra_width(float radius, float light_distance, float caster_distance) noexcept {
  return 2 * radius * caster_distance / std::max(light_distance - caster_distance, light_distance / 1024);
}

void spread_variance(const FilterGuides& guides, std::span<const float> numerators, std::span<const float> denominators,
                     std::span<float> variance, std::span<const float> history_length, float fewest_frames) {
  const int width = guides.width(), height = guides.height();
  const std::size_t size = static_cast<std::size_t>(width) * height;
  for (const std::size_t given : {numerators.size(), denominators.size(), variance.size()})
    if (given != size) throw Error("a plane has {} pixels, not the {} of the guides", given, size);
  if (!history_length.empty() && history_length.size() != size)
    throw Error("the plane of history has {} pixels, not the {} of the guides", history_length.size(), size);

  constexpr int reach = 3;
  const auto spread = [&](int x, int y, int count) {
    const std::size_t at = static_cast<std::size_t>(y) * width + x;
    const auto is_wanted = [&](int i) {
      return guides.counts(x + i, y) && (history_length.empty() || history_length[at + i] < fewest_frames);
    };
    bool any = false;
    for (int i = 0; i < count && !any; ++i) any = is_wanted(i);
    if (!any) return;
    MomentChunk f{}, v{}, v2{};
    for (int row = std::max(y - reach, 0); row <= std::min(y + reach, height - 1); ++row)
      for (int by = -reach; by <= reach; ++by) {
        // Planes have no margins: pixels whose tap is beside the picture are left out.
        const int low = std::max(0, -by - x), high = std::min(count, width - by - x);
        if (low >= high) continue;
        const std::size_t tap = static_cast<std::size_t>(row) * width + (x + low + by);
        add_share_moments(row_from(guides.row(y), x + low), row_from(guides.row(row), x + low + by), &numerators[tap],
                          &denominators[tap], high - low, &f[low], &v[low], &v2[low]);
      }
    for (int i = 0; i < count; ++i) {
      if (!is_wanted(i)) continue;
      const float mean = f[i] > 0 ? v[i] / f[i] : 0.5f;
      variance[at + i] = f[i] > 0 ? std::max(v2[i] / f[i] - mean * mean, 0.0f) : 0.25f;  // nothing asked: a coin's
    }
  };
  for_blocks(static_cast<std::size_t>(height), guide_rows, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < width; x += moment_chunk) spread(x, y, std::min(moment_chunk, width - x));
  });
}

}  // namespace gnomon
