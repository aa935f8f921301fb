#pragma once
#include <gnomon/scene.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon {

/// The item of this name; null where there is none.
template <class Item>
const Item* find_named(const std::vector<Item>& items, const std::string& name) {
  const auto found = std::ranges::find(items, name, &Item::name);
  return found == items.end() ? nullptr : &*found;
}

template <class Item>
std::vector<std::string> names_of(const std::vector<Item>& items) {
  std::vector<std::string> names;
  for (const Item& item : items) names.push_back(item.name);
  return names;
}

/// The name in letters, digits and _ of plain names, each other byte as _; the fallback where nothing else is left.
std::string plain_name(std::string name, std::string_view fallback);

/// Throws Error with the nearest name when the scene lacks one of these lights (single ones, by name) or views.
void require_names(const std::string& reference, const Scene& scene, const std::vector<std::string>& lights,
                   const std::vector<std::string>& views);
/// Throws Error with the nearest name when one of `wanted` is missing in `there`, the names in scene `reference`.
void require_words(const std::vector<std::string>& wanted, const std::vector<std::string>& there, const char* what,
                   const std::string& reference);

}  // namespace gnomon
