#pragma once
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "analysis/analysis.h"

namespace gnomon {

// Lists that keep the order in which their items first came.

/// The names of all items.
template <class List>
std::vector<std::string> names_in(const List& items) {
  std::vector<std::string> names;
  for (const auto& item : items) names.emplace_back(item.name);
  return names;
}

/// The index of a value in a list, or the list's size where it is not there.
template <class T>
std::size_t index_of(const std::vector<T>& list, const T& value) {
  return static_cast<std::size_t>(std::ranges::find(list, value) - list.begin());
}

template <class T>
void add_once(std::vector<T>& list, const T& value) {
  if (index_of(list, value) == list.size()) list.push_back(value);
}

/// The value of a key, made empty where the key is new.
template <class Key, class Value>
Value& value_of_key(std::vector<std::pair<Key, Value>>& list, const Key& key) {
  const auto found = std::ranges::find(list, key, &std::pair<Key, Value>::first);
  return found == list.end() ? list.emplace_back(key, Value()).second : found->second;
}

/// The places of all items; by `maps`, each item has a map from Place. None of no item.
template <class List, class Maps>
std::set<Place> common_places(const List& list, Maps maps) {
  std::set<Place> common;
  for (const auto& item : list)
    for (const auto& [place, value] : std::invoke(maps, item)) common.insert(place);
  for (const auto& item : list)
    std::erase_if(common, [&](const Place& place) { return !std::invoke(maps, item).contains(place); });
  return common;
}

/// Rows by setting (see setting_key), of each setting by place: the first one that is accepted.
using RowsBySetting = std::vector<std::pair<std::string, std::map<Place, const Record*>>>;
template <class Accepts>
RowsBySetting rows_by_setting(std::span<const Record> records, Accepts accepts) {
  RowsBySetting settings;
  for (const Record& r : records)
    if (r.status == Status::ok && accepts(r)) value_of_key(settings, setting_key(r)).try_emplace(place_of(r), &r);
  return settings;
}

}  // namespace gnomon
