#include "pages.h"

#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <bit>

namespace gnomon::virtual_map {

namespace {

void sort_and_thin(std::vector<PageAddress>& pages) {
  std::ranges::sort(pages);
  pages.erase(std::unique(pages.begin(), pages.end()), pages.end());
}

}  // namespace

int top_level(int page_size) { return std::countr_zero(unsigned(finest_side)) - std::countr_zero(unsigned(page_size)); }

LightCamera finest_camera(const Light& light, const MeshBoxes& boxes) {
  LightCamera camera = fit_to_scene(light, boxes, finest_side, fit_margin);
  for (LightImage& image : camera.images) {
    const glm::dvec2 middle = (finest_side / 2.0 - image.offset) / image.scale;
    image.scale = glm::dvec2(std::min(image.scale.x, image.scale.y));
    image.offset = finest_side / 2.0 - middle * image.scale;
  }
  return camera;
}

LightImage at_level(LightImage image, int level) {
  image.scale *= std::ldexp(1.0, -level);
  image.offset *= std::ldexp(1.0, -level);
  return image;
}

std::uint32_t PageTable::slot(PageAddress address) const {
  return static_cast<std::uint32_t>(std::ranges::lower_bound(pages, address) - pages.begin());
}

int PageTable::level_count() const {
  std::uint32_t levels = 0;
  for (const PageAddress& page : pages) levels |= 1u << page.level();
  return std::popcount(levels);
}

PageTable pages_of(std::span<const std::uint32_t> asked, std::size_t room, int top) {
  // Neighbors mostly ask for the same page: what differs from the pixel before is sorted, block by block.
  constexpr std::size_t block = 16384;
  std::vector<std::vector<PageAddress>> found((asked.size() + block - 1) / block);
  for_blocks(asked.size(), block, [&](std::size_t begin, std::size_t end) {
    std::vector<PageAddress>& mine = found[begin / block];
    std::uint32_t last = PageAddress::none;
    for (std::size_t i = begin; i < end; ++i) {
      if (asked[i] == last) continue;
      last = asked[i];
      if (last != PageAddress::none) mine.push_back({last});
    }
    sort_and_thin(mine);
  });
  PageTable table;
  for (const auto& mine : found) table.pages.insert(table.pages.end(), mine.begin(), mine.end());
  sort_and_thin(table.pages);
  table.asked_count = table.pages.size();
  while (table.pages.size() > room && table.raised < top) {
    ++table.raised;
    for (PageAddress& page : table.pages) page = page.raised(1, top);
    sort_and_thin(table.pages);
  }
  return table;
}

}  // namespace gnomon::virtual_map
