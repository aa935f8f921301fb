#include "measure/cause/components.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace components_test {

using namespace gnomon;

RC_GTEST_PROP(components, are_what_flooding_from_each_pixel_reaches, ()) {
  const int width = *rc::gen::inRange(1, 12), height = *rc::gen::inRange(1, 12);
  const auto keys = *rc::gen::container<std::vector<std::uint32_t>>(static_cast<std::size_t>(width) * height,
                                                                    rc::gen::inRange<std::uint32_t>(0, 3));
  const Components found = connect(keys, 0, width, height);
  // By repeated spreading of the smallest index until nothing changes.
  std::vector<std::size_t> root(keys.size());
  for (std::size_t i = 0; i < root.size(); ++i) root[i] = i;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < keys.size(); ++i)
      for (std::size_t j = 0; j < keys.size(); ++j) {
        const int dx = int(i % width) - int(j % width), dy = int(i / width) - int(j / width);
        if (keys[i] != keys[j] || std::abs(dx) > 1 || std::abs(dy) > 1 || root[j] >= root[i]) continue;
        root[i] = root[j];
        changed = true;
      }
  }
  for (std::size_t i = 0; i < keys.size(); ++i) {
    RC_ASSERT((found.of[i] == no_component) == (keys[i] == 0));
    if (keys[i] == 0) continue;
    std::uint32_t size = 0;
    for (std::size_t j = 0; j < keys.size(); ++j) {
      if (keys[j] == 0) continue;
      RC_ASSERT((found.of[i] == found.of[j]) == (root[i] == root[j]));
      size += root[i] == root[j];
    }
    RC_ASSERT(found.size[found.of[i]] == size);
  }
}

}  // namespace components_test
