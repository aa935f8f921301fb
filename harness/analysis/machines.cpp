#include "analysis/machines.h"

#include <cmath>

#include "analysis/in_order.h"
#include "measure/picture/picture.h"

namespace gnomon {

std::vector<MachineRow> rows_by_machine(std::span<const MachineRun> runs) {
  std::vector<MachineRow> rows;
  std::map<std::pair<Place, std::string>, std::size_t> known;
  for (std::size_t run = 0; run < runs.size(); ++run)
    for (const Record& record : runs[run].records) {
      const std::pair key(place_of(record), setting_key(record));
      const auto [found, is_new] = known.try_emplace(key, rows.size());
      if (is_new) rows.emplace_back(runs.size());
      const Record*& place = rows[found->second][run];
      if (!place) place = &record;
    }
  return rows;
}

std::optional<std::vector<DifferingPixels>> differing_pixels(const Record& first, const std::filesystem::path& first_dir,
                                                             const Record& second, const std::filesystem::path& second_dir) {
  if (!first.mask || !second.mask) return std::nullopt;
  const std::filesystem::path a = first_dir / *first.mask, b = second_dir / *second.mask;
  if (!std::filesystem::exists(a) || !std::filesystem::exists(b)) return std::nullopt;
  const std::vector<std::string> others = light_names(second);
  std::vector<DifferingPixels> result;
  for (const std::string& light : light_names(first)) {
    if (std::ranges::find(others, light) == others.end()) continue;
    const auto read = [&](const std::filesystem::path& file) {
      return read_exr(file, light + ".V", first.width, first.height);
    };
    const std::vector<float> x = read(a), y = read(b);
    DifferingPixels& found = result.emplace_back(DifferingPixels{.light = light, .pixels = {}});
    for (std::size_t k = 0; k < x.size(); ++k)
      if (!(std::abs(x[k] - y[k]) <= same_visibility))
        found.pixels.push_back({static_cast<int>(k) % first.width, static_cast<int>(k) / first.width, x[k], y[k]});
  }
  return result;
}

}  // namespace gnomon
