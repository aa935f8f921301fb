#pragma once
#include <gnomon/kit/bins.h>
#include <gnomon/kit/geometry/clip.h>
#include <gnomon/kit/maps/light_map.h>

#include <optional>

#include "pages.h"

// Which triangles touch which pages.
namespace gnomon::virtual_map {

/// A box of texels of level 0 that contains all that a triangle covers on a face.
struct Footprint {
  glm::vec2 low, high;
  std::uint32_t mesh, triangle;
};

/// The casters of each face of a camera. Of closed meshes lit from outside only what is not turned away from the light.
struct Footprints {
  std::vector<Footprint> all;        ///< face after face
  std::vector<std::size_t> begin{};  ///< of each face; one more ends the last
};

/// What each page draws. Triangles that reach far beyond their page come after the others, and are drawn apart: drivers clip
/// all triangles of a draw one by one as soon as one of them needs it (70 ms become 46 ms, bunny, llvmpipe).
struct DrawLists {
  Bins bins;                           ///< footprints: those of slot k are in bins 2 k and, far beyond it, 2 k + 1
  std::vector<std::uint32_t> corners;  ///< three vertices a triangle; those of bin b begin at 3 bins.begin[b]
  std::size_t triangle_count() const { return bins.items.size(); }
};

inline constexpr std::size_t list_block = 4096;
/// By how many texels shaders, boxes in float32 and the rasterizer's grid may be off together, amply.
inline constexpr double texels_of_rounding = 1.0 / 16;
/// How far beyond a page drivers need not clip, in pages.
inline constexpr double guard_band = 0.5;

/// A triangle as a face sees it.
inline std::array<glm::dvec3, 3> seen(const LightImage& image, const Mesh& mesh, std::uint32_t triangle) {
  const glm::uvec3& t = mesh.triangles[triangle];
  return {image.seen(mesh.positions[t.x]), image.seen(mesh.positions[t.y]), image.seen(mesh.positions[t.z])};
}

/// A point of a face's frame as homogeneous texel coordinates of level 0.
inline glm::dvec3 texel_of(const LightImage& image, const glm::dvec3& q) {
  const double w = image.is_perspective ? q.z : 1;
  return {glm::dvec2(q) * image.scale + image.offset * w, w};
}

/// Whether a triangle shows the light its back, beyond what rounding may make of one seen edge-on.
inline bool is_turned_away(const LightImage& image, const std::array<glm::dvec3, 3>& q) {
  // A mirrored frame reverses the winding.
  const double winding = glm::determinant(image.light_from_world) < 0 ? -1.0 : 1.0;
  const glm::dvec3 normal = glm::cross(q[1] - q[0], q[2] - q[0]) * winding;
  const glm::dvec3 ray = image.is_perspective ? q[0] : glm::dvec3(0, 0, 1);
  return glm::dot(normal, ray) > 0x1p-30 * glm::length(normal) * glm::length(ray);
}

/// A box around what the triangle covers of the image; empty where it covers nothing.
inline bool find_box(const LightImage& image, const std::array<glm::dvec3, 3>& q, glm::dvec2& low, glm::dvec2& high) {
  low = glm::dvec2(INFINITY);
  high = glm::dvec2(-INFINITY);
  const auto add = [&](const glm::dvec3& t) {
    low = glm::min(low, glm::dvec2(t) / t.z);
    high = glm::max(high, glm::dvec2(t) / t.z);
  };
  if (!image.is_perspective || std::ranges::all_of(q, [](const glm::dvec3& p) { return p.z > 0; })) {
    for (const glm::dvec3& p : q) add(texel_of(image, p));
  } else {
    // Beside the light's plane, where a center would divide by zero: only what lies within the image's pyramid.
    Clipper polygon;
    for (const glm::dvec3& p : q) polygon.add({texel_of(image, p)});
    constexpr double side = finest_side;
    for (const glm::dvec3& plane : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(-1, 0, side), glm::dvec3(0, -1, side)})
      if (polygon.keep_positive({plane, 0}, 0) == Lies::negative) return false;
    for (const Corner& corner : polygon.corners())
      if (corner.at.z > 0) add(corner.at);
  }
  return low.x < finest_side && low.y < finest_side && high.x > 0 && high.y > 0;
}

/// The half-planes that bound a triangle on a face: points (x, y) of texel coordinates with dot(side, (x, y, 1)) > 0
/// (Olano and Greer 1997). They are valid for triangles that go through the light's plane, too.
using Sides = std::array<glm::dvec3, 3>;
inline Sides sides_of(const LightImage& image, const std::array<glm::dvec3, 3>& q) {
  const glm::dvec3 a = texel_of(image, q[0]), b = texel_of(image, q[1]), c = texel_of(image, q[2]);
  const double turn = glm::dot(a, glm::cross(b, c)) < 0 ? -1 : 1;
  return {turn * glm::cross(a, b), turn * glm::cross(b, c), turn * glm::cross(c, a)};
}
/// Whether a box meets all of them.
inline bool may_touch(const Sides& sides, const glm::dvec2& low, const glm::dvec2& high) {
  return std::ranges::all_of(sides, [&](const glm::dvec3& s) {
    return s.x * (s.x > 0 ? high.x : low.x) + s.y * (s.y > 0 ? high.y : low.y) + s.z >= 0;
  });
}

/// The pages of one level of one face, row after row.
struct LevelPages {
  int face, level;
  std::span<const PageAddress> pages;
  std::uint32_t first_slot;
  int first_row = 0;
  std::vector<std::uint32_t> row_begin{};  ///< of each row from the first, in pages; one more ends the last

  LevelPages(std::span<const PageAddress> of_level, std::uint32_t slot)
      : face(of_level[0].face()), level(of_level[0].level()), pages(of_level), first_slot(slot), first_row(pages[0].page().y) {
    for (std::uint32_t k = 0; k < pages.size(); ++k)
      while (first_row + static_cast<int>(row_begin.size()) <= pages[k].page().y) row_begin.push_back(k);
    row_begin.push_back(static_cast<std::uint32_t>(pages.size()));
  }

  /// Calls visit(slot, page) for the pages with low <= page <= high.
  template <class Visit>
  void for_pages(const glm::ivec2& low, const glm::ivec2& high, const Visit& visit) const {
    const int last_row = first_row + static_cast<int>(row_begin.size()) - 2;
    for (int y = std::max(low.y, first_row); y <= std::min(high.y, last_row); ++y) {
      const auto row = pages.subspan(row_begin[y - first_row], row_begin[y - first_row + 1] - row_begin[y - first_row]);
      const auto from = std::ranges::lower_bound(row, low.x, {}, [](const PageAddress& page) { return page.page().x; });
      for (auto page = from; page != row.end() && page->page().x <= high.x; ++page)
        visit(first_slot + static_cast<std::uint32_t>(&*page - pages.data()), page->page());
    }
  }
};

/// Level by level, those of a face side by side.
inline std::vector<LevelPages> levels_of(const PageTable& table) {
  std::vector<LevelPages> levels;
  for (std::size_t begin = 0, end = 0; begin < table.pages.size(); begin = end) {
    const PageAddress first = table.pages[begin];
    while (end < table.pages.size() && table.pages[end].face() == first.face() && table.pages[end].level() == first.level())
      ++end;
    levels.emplace_back(std::span(table.pages).subspan(begin, end - begin), static_cast<std::uint32_t>(begin));
  }
  return levels;
}

/// Footprints of an earlier pose of the scene, under an equal camera: those of meshes that stand still hold.
struct EarlierFootprints {
  const Footprints& all;
  const MovingMeshes& moving;

  /// Of a mesh on a face.
  std::span<const Footprint> of(std::size_t face, std::uint32_t mesh) const {
    const std::span<const Footprint> on_face =
        std::span(all.all).subspan(all.begin[face], all.begin[face + 1] - all.begin[face]);
    // Casters of an image are in order.
    const auto first = std::ranges::lower_bound(on_face, mesh, {}, &Footprint::mesh);
    const auto end = std::ranges::upper_bound(on_face, mesh, {}, &Footprint::mesh);
    return on_face.subspan(first - on_face.begin(), end - first);
  }
};

/// Adds those of a caster in an image.
inline void add_footprints(const Mesh& mesh, std::uint32_t number, const LightImage& image, bool only_lit,
                           std::vector<Footprint>& all) {
  std::vector<std::vector<Footprint>> found((mesh.triangles.size() + list_block - 1) / list_block);
  for_blocks(mesh.triangles.size(), list_block, [&](std::size_t begin, std::size_t end) {
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
      const auto q = seen(image, mesh, i);
      glm::dvec2 low, high;
      if (only_lit && is_turned_away(image, q)) continue;
      if (find_box(image, q, low, high)) found[begin / list_block].push_back({low, high, number, i});
    }
  });
  for (const auto& mine : found) all.insert(all.end(), mine.begin(), mine.end());
}

/// Of what stands still from `earlier`, where it is given.
inline Footprints footprints_of(const Scene& scene, const SolidParts& solid_parts, const LightCamera& camera,
                                const std::optional<EarlierFootprints>& earlier = {}) {
  Footprints footprints;
  for (std::size_t face = 0; face < camera.images.size(); ++face) {
    const LightImage& image = camera.images[face];
    footprints.begin.push_back(footprints.all.size());
    if (image.layer < 0) continue;
    for (const std::uint32_t m : image.casters) {
      if (earlier && !earlier->moving.moves(m)) {
        const std::span<const Footprint> kept = earlier->of(face, m);
        footprints.all.insert(footprints.all.end(), kept.begin(), kept.end());
      } else {
        add_footprints(scene.meshes[m], m, image, is_seen_from_outside(solid_parts[m], image), footprints.all);
      }
    }
  }
  footprints.begin.push_back(footprints.all.size());
  footprints.all.shrink_to_fit();
  return footprints;
}

inline void fill(DrawLists& lists, const Scene& scene, const SceneBuffers& buffers, const LightCamera& camera,
                 const Footprints& footprints, const PageTable& table, int page_size) {
  const std::vector<LevelPages> levels = levels_of(table);
  sort_into_bins_at_once(
      footprints.all.size(), list_block, 2 * table.pages.size(), lists.bins, [&](std::size_t i, auto&& visit) {
        const Footprint& f = footprints.all[i];
        const int face = static_cast<int>(std::ranges::upper_bound(footprints.begin, i) - footprints.begin.begin()) - 1;
        const LightImage& image = camera.images[face];
        std::optional<Sides> sides;
        for (const LevelPages& level : levels) {
          if (level.face != face) continue;
          // A texel is covered at its center. Of small triangles many cover none: one of five on `terrain`, one of seven on
          // `bunny`.
          const double per_texel = std::ldexp(1.0, -level.level), per_page = per_texel / page_size;
          const glm::dvec2 first = glm::ceil(glm::dvec2(f.low) * per_texel - 0.5 - texels_of_rounding);
          const glm::dvec2 last = glm::floor(glm::dvec2(f.high) * per_texel - 0.5 + texels_of_rounding);
          if (first.x > last.x || first.y > last.y) continue;
          constexpr double beyond = 1 << 18;
          const glm::ivec2 low(glm::floor(glm::clamp(first, -1.0, beyond) / double(page_size)));
          const glm::ivec2 high(glm::floor(glm::clamp(last, -1.0, beyond) / double(page_size)));
          const bool is_large = std::int64_t(high.x - low.x + 1) * (high.y - low.y + 1) > 4;
          level.for_pages(low, high, [&](std::uint32_t slot, const glm::ivec2& page) {
            // Corners of the page, in texels of level 0, so many pages beyond it.
            const auto low_end = [&](double pages) { return (glm::dvec2(page) - pages) / per_page; };
            const auto high_end = [&](double pages) { return (glm::dvec2(page) + 1.0 + pages) / per_page; };
            if (is_large) {
              const double slack = texels_of_rounding / page_size;
              if (!sides) sides = sides_of(image, seen(image, scene.meshes[f.mesh], f.triangle));
              if (!may_touch(*sides, low_end(slack), high_end(slack))) return;
            }
            const bool is_near = glm::all(glm::greaterThan(glm::dvec2(f.low), low_end(guard_band))) &&
                                 glm::all(glm::lessThan(glm::dvec2(f.high), high_end(guard_band)));
            visit(2 * slot + (is_near ? 0 : 1));
          });
        }
      });
  lists.corners.resize(3 * lists.triangle_count());
  for_blocks(lists.triangle_count(), list_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Footprint& f = footprints.all[lists.bins.items[k]];
      const glm::uvec3 corners = scene.meshes[f.mesh].triangles[f.triangle] + buffers.meshes[f.mesh].first_vertex;
      for (int c = 0; c < 3; ++c) lists.corners[3 * k + c] = corners[c];
    }
  });
}

}  // namespace gnomon::virtual_map
