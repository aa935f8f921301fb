#include "analysis/mask_differences.h"

#include "analysis/in_order.h"
#include "measure/record/scene_place.h"
#include "measure/record/title.h"
#include "measure/row/current_scene.h"
#include "measure/row/kept_row.h"

namespace gnomon {

namespace {

namespace fs = std::filesystem;

/// A step of a picture of 8 bits: less is not seen in any.
constexpr double least_change = 1.0 / 256;

/// A row's mask in its place, with what is tested there.
MeasuredRow read_row(const Record& record, const fs::path& dir, CurrentScene& current) {
  try {
    MeasuredRow row =
        kept_row(record, dir / *record.mask, "V", kept_place(record, *current.scene, record.truth), *current.frames);
    put_together(row, *current.scene);
    return row;
  } catch (const Error& problem) {
    throw Error("the mask of {} cannot be compared: {}", title(record), problem.what());
  }
}

/// Nothing where no pixel is tested.
std::optional<MaskDifference> difference(const Evidence& base, const Evidence& other) {
  MaskDifference found;
  std::size_t tested = 0, changed = 0;
  double squares = 0;
  for (std::size_t i = 0; i < base.mask.size(); ++i) {
    if (base.classes[i] != PixelClass::T) continue;
    const double off = std::abs(static_cast<double>(other.mask[i]) - base.mask[i]);
    ++tested;
    changed += off > least_change;
    found.mean += off;
    squares += off * off;
    found.greatest = std::max(found.greatest, off);
  }
  if (tested == 0) return std::nullopt;
  const auto of_tested = [&](double sum) { return sum / static_cast<double>(tested); };
  found.changed = of_tested(static_cast<double>(changed));
  found.mean = of_tested(found.mean);
  found.rms = std::sqrt(of_tested(squares));
  return found;
}

using Places = std::vector<std::pair<Place, std::vector<const Record*>>>;

/// Rows with masks by place; of places with one row none. Counts what it leaves out. Throws Error when a mask is not there.
Places places_of(std::span<const Record> records, const fs::path& dir, MaskDifferences& result) {
  Places places;
  std::size_t on_path = 0, without_mask = 0;
  for (const Record& record : records) {
    if (record.status != Status::ok) continue;
    if (!record.path.empty())
      ++on_path;
    else if (!record.mask)
      ++without_mask;
    else
      value_of_key(places, place_of(record)).push_back(&record);
  }
  const auto note = [&](std::size_t count, std::string_view why) {
    if (count) result.notes.push_back(fmt::format("{} row{} left out: {}", count, count == 1 ? "" : "s", why));
  };
  note(on_path, "on a path, only the mask of the last frame is kept");
  note(without_mask, "no mask was kept");
  std::erase_if(places, [](const auto& place) { return place.second.size() < 2; });
  for (const auto& [place, rows] : places)
    for (const Record* record : rows)
      if (const fs::path file = dir / *record->mask; !fs::exists(file))
        throw Error("the mask {} of {} is not there", file.string(), title(*record));
  return places;
}

void compare_place(const std::vector<const Record*>& rows, const fs::path& dir, CurrentScene& current,
                   MaskDifferences& result) {
  const MeasuredRow base = read_row(*rows.front(), dir, current);
  const Evidence of_base = base.evidence(*current.scene);
  for (const Record* record : std::span(rows).subspan(1)) {
    const MeasuredRow other = read_row(*record, dir, current);
    std::optional<MaskDifference> found = difference(of_base, other.evidence(*current.scene));
    if (!found) continue;
    found->base = rows.front();
    found->other = record;
    result.pairs.push_back(*found);
  }
}

}  // namespace

MaskDifferences compare_masks(std::span<const Record> records, const fs::path& dir, Progress& progress) {
  MaskDifferences result;
  const Places places = places_of(records, dir, result);
  progress.expect(static_cast<double>(places.size()));
  std::optional<CurrentScene> current;
  std::string loaded;
  for (const auto& [place, rows] : places) {
    progress.step(title(*rows.front()));
    if (!current || loaded != place.scene) current.emplace(place.scene, scene_reference(*rows.front(), dir), progress);
    loaded = place.scene;
    if (const std::string obstacle = current->obstacle(*rows.front()); !obstacle.empty())
      result.notes.push_back(fmt::format("{}: {} rows left out: {}", title(place, std::vector{place}), rows.size(), obstacle));
    else
      compare_place(rows, dir, *current, result);
    progress.advance(1);
  }
  if (result.pairs.empty())
    throw Error("no two rows of one place have masks to compare{}{}", result.notes.empty() ? "" : ": ",
                joined(result.notes, "; "));
  return result;
}

}  // namespace gnomon
