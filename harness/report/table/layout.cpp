#include "report/table/layout.h"

#include "analysis/in_order.h"
#include "measure/counted.h"
#include "measure/frame/classify.h"
#include "measure/scene/load.h"
#include "report/table/digits.h"

namespace gnomon {

namespace {

/// Above this share of class U among the pixels that face the light, a table says so.
constexpr double most_uncertain_share = 0.01;

std::string group_heading(const Record& r) {
  std::string text = scene_in_words(r.scene);
  if (r.scene_facts) text += fmt::format(" ({})", counted(r.scene_facts->triangles, "triangle{s}"));
  if (!r.light.empty()) text += fmt::format(", light {}", r.light);
  if (!r.light_kind.empty() && r.light_kind != r.light) text += fmt::format(" ({})", r.light_kind);
  if (!r.view.empty()) text += fmt::format(", view {}", r.view);
  if (!r.path.empty()) text += fmt::format(", path {}", r.path);
  if (moves_geometry(r)) text += fmt::format(" from {} s at {} Hz", r.start.value_or(0), *r.frame_rate);
  if (r.frame_count) text += ", " + counted(*r.frame_count, "frame{s}");
  if (r.width > 0) text += fmt::format(", {} x {}", r.width, r.height);
  return text + fmt::format(", {} truth", name(r.truth));
}

/// What to say of a group whose reference leaves much undecided; empty where it does not. Classes do not depend on the
/// technique.
std::string uncertainty(const Layout::Group& group) {
  const auto uncertain_share = [](const Record& r) { return class_share(r, "U").value_or(0); };
  const Record* most = group.rows.front().record;
  for (const Layout::Row& row : group.rows)
    if (uncertain_share(*row.record) > uncertain_share(*most)) most = row.record;
  const double share = uncertain_share(*most);
  if (share <= most_uncertain_share) return "";
  return fmt::format("float32 cannot decide {} % of the pixels facing the light (class U): {}, light {}, view {}{}",
                     measured(100 * share), most->scene, most->light, most->view,
                     share > 0.5 ? "; the scene is outside what the reference can decide" : "");
}

/// Marks the best contenders of each column in one group, of those that beat a constant mask; nothing where there is no choice
/// or no difference. Of times, whoever is not told apart from the best is marked, too (told_apart, over all times of the
/// group).
void mark_best(std::span<const Column> columns, Layout::Group& group) {
  struct Mark {
    std::size_t column;
    Cell* cell;
    bool is_best;
  };
  std::vector<Mark> marks;
  std::vector<Contrast> contrasts;
  std::vector<std::size_t> contrasted;  // marks
  for (std::size_t index = 0; index < columns.size(); ++index) {
    const Column& column = columns[index];
    if (column.better.empty()) continue;
    struct Competitor {
      Cell* cell;
      double value, least;  // what noise may have made of the best is as good as the best
      std::optional<LogTime> log_time;
    };
    std::vector<Competitor> competitors;
    for (Layout::Row& row : group.rows) {
      const Record& record = *row.record;
      Cell& cell = row.cells[index];
      const double* value = cell.number();
      if (!value || record.status != Status::ok || record.role != Role::contender || !beats_constant(record, column.name))
        continue;
      competitors.push_back(
          {&cell, *value, cell.is_floored ? 0 : *value, column.log_time ? column.log_time(record) : std::nullopt});
    }
    if (competitors.empty()) continue;
    const auto [least, greatest] = std::ranges::minmax_element(competitors, {}, &Competitor::value);
    const Competitor best = column.better == "lower" ? *least : *greatest;
    for (const Competitor& c : competitors) {
      if (c.value != best.value && c.log_time && best.log_time) {
        contrasts.push_back({*c.log_time, *best.log_time, competitors.size()});
        contrasted.push_back(marks.size());
      }
      marks.push_back({index, c.cell, c.least <= best.value && c.value >= best.least});
    }
  }
  const std::vector<bool> told = told_apart(contrasts);
  for (std::size_t k = 0; k < told.size(); ++k) marks[contrasted[k]].is_best = !told[k];
  for (auto first = marks.begin(); first != marks.end();) {
    const auto last = std::find_if(first, marks.end(), [&](const Mark& mark) { return mark.column != first->column; });
    if (!std::all_of(first, last, std::mem_fn(&Mark::is_best)))
      for (auto mark = first; mark != last; ++mark) mark->cell->is_best = mark->is_best;
    first = last;
  }
}

/// Not every record has it: without this check the table would show an empty column.
bool has_metric(std::span<const Record> records, std::string_view metric) {
  return std::ranges::any_of(records, [&](const Record& r) { return r.metric(metric).has_value(); });
}

bool any_is(std::span<const Record> records, AnswerKind of) {
  return std::ranges::any_of(records, [&](const Record& r) { return r.answer == of; });
}
/// Whether pixels are right or wrong: under lights without area.
bool has_wrong_pixels(std::span<const Record> records) {
  return any_is(records, AnswerKind::binary) || any_is(records, AnswerKind::transmitted);
}
/// Whether a rasterizer of these rows rounds vertices to another grid than most do.
bool has_unusual_grid(std::span<const Record> records) {
  return std::ranges::any_of(records, [](const Record& r) {
    const auto bits = r.context.find("gl_subpixel_bits");
    return bits != r.context.end() && *bits != usual_subpixel_bits;
  });
}

/// Adds those of the metrics that some record has.
void add_known(std::vector<std::string>& names, std::span<const Record> records,
               std::initializer_list<std::string_view> metrics) {
  for (const std::string_view metric : metrics)
    if (has_metric(records, metric)) names.emplace_back(metric);
}

/// What a row is judged by, and what it is read against; where the answer is binary the wrong rate, of several lights the worst
/// of them, the light received and how it looks.
void add_error_columns(std::vector<std::string>& names, std::span<const Record> records) {
  names.emplace_back("error");
  add_known(names, records, {"error_floor", "snapping_floor"});
  add_known(names, records, {"coverage_error_mean", "coverage_error_rms", "coverage_error_mean_floor"});
  if (has_wrong_pixels(records)) names.emplace_back("wrong_rate");
  add_known(names, records, {"transmittance_error_rms", "transmittance_error_p95", "hue_error"});
  if (any_is(records, AnswerKind::received))
    names.insert(names.end(), {"light_error_max", "received_error_rms", "flip", "ssim"});
}

/// Of techniques that remember frames: their error once nothing changes any more. And how long the error of a jump lasts.
void add_memory_columns(std::vector<std::string>& names, std::span<const Record> records) {
  add_known(names, records, {"error_settled", "ghost_half_life", "ghost_frames"});
}

/// What is defined under lights with area alone.
void add_soft_columns(std::vector<std::string>& names, std::span<const Record> records) {
  if (any_is(records, AnswerKind::fraction))
    add_known(names, records,
              {"other_error_mean", "penumbra_width_ratio", "penumbra_shift", "penumbra_noise", "contact_hardening"});
}

/// The stages after setup, and where the geometry of some row moves what that costs.
void add_stage_columns(std::vector<std::string>& names, std::span<const Record> records) {
  const auto has = [&](std::string_view time) {
    return std::ranges::any_of(records, [&](const Record& r) { return quantity(r, time).has_value(); });
  };
  names.emplace_back("build_ms");
  if (has("update_ms")) names.emplace_back("update_ms");
  names.insert(names.end(), {"relight_ms", "resolve_ms"});
  if (has("motion_ms")) names.emplace_back("motion_ms");
}

/// What is tested of the pixels that face the light, and what is not, by class.
void add_class_columns(std::vector<std::string>& names) {
  names.insert(names.end(), {"tested_share", "silhouette_share", "grazing_share", "uncertain_share"});
}

/// Explains the signs and words of the columns.
void add_shorthands(Layout& layout, std::span<const Record> records, bool has_null) {
  const auto say = [&](std::string_view word, std::string text) { layout.shorthands.emplace_back(word, std::move(text)); };
  const auto has = [&](std::string_view column) {
    return std::ranges::find(layout.columns, column, &Column::name) != layout.columns.end();
  };
  const auto add = [&](std::string_view column, std::string_view word, std::string text) {
    if (has(column)) say(word, std::move(text));
  };
  if (has_null) say("-", "not measured or not defined");
  if (std::ranges::find(layout.columns, "ms", &Column::unit) != layout.columns.end())
    say("ms", "median of the medians of the processes");
  if (has("silhouette_share") || has("grazing_share") || has("uncertain_share"))
    say("S, G, U", "shares of the pixels facing the light that are not tested: silhouette, grazing, uncertain");
  if (std::ranges::any_of(records, moves_geometry)) {
    add("update_ms", "update", "time in build's place where the geometry moved, mean over steps through the animation");
    add("motion_ms", "motion", "update, and relight and resolve after it; relight and resolve alone are of the first frame");
  }
  add("resolve_device_ms", "on device",
      "time by the clock of the device; ms alone is by the clock of the host, which waits for the device");
  add("floor_share", "bare share", "share of relight and resolve that the technique's bare pass takes (column floor)");
  add("rays_per_second", "rays", "millions of rays traced in a second: count rays over relight and resolve");
  if (has("resolve_device_ms") || has("clocks"))
    if (const auto count = std::ranges::count(records, std::optional(false), clocks_agree); count > 0)
      say("clocks", fmt::format("device and host contradict each other in {}: do not trust their times (column clocks)",
                                counted(count, "row{s}")));
  add("error", "error", "mean difference from the reference over the tested pixels; rows are judged by it");
  if (any_is(records, AnswerKind::binary))
    add("wrong_rate", "wrong", "share of the tested pixels that are dark where the reference is lit, or lit where it is dark");
  if (any_is(records, AnswerKind::transmitted))
    add("wrong_rate", "wrong behind glass",
        "share of the tested pixels that are off by more than 1/20; false dark: too dark by so much");
  if (has_metric(records, "constant_error")) say("best constant mask", constant_note);
  add("light_error_max", "worst light", "the largest error of one light's mask");
  add("received_error_rms", "received error rms",
      "root mean square of the difference in irradiance, as a share of the reference's");
  add("error_settled", "error settled", "mean error of the last 16 of 64 frames in which nothing moves");
  add("ghost_half_life", "ghost half life", "frames after a jump until half of the error that it adds is gone");
  add("ghost_frames", "ghost frames", "frames after a jump until the error is at most 1.1 times that before");
  add("coverage_error_mean", "coverage error mean",
      "mean difference from the mean of the reference over each pixel; its floor: what the noise of that mean makes of it");
  add("error_floor", "error floor", floor_note);
  add("other_error_mean", "other error",
      "difference from the light's share of irradiance, or from its share of area where the technique estimates irradiance");
  add("contact_hardening", "contact hardening",
      "growth of the penumbra's width with the caster's distance, technique to reference");
  if (has_metric(records, "snapping_floor"))
    add("snapping_floor", "snapping floor",
        has_unusual_grid(records)
            ? "share of pixels whose reference changes when samples shift by half the rasterizer's grid (without OpenGL, by "
              "1/512 pixel); rasterizers cannot do better"
            : "share of pixels whose reference changes when samples shift by 1/512 pixel; rasterizers cannot do better");
}

}  // namespace

/// How many values those have that have one.
static std::size_t value_count(std::span<const Record> records, std::optional<double> Record::*member) {
  std::set<double> values;
  for (const Record& r : records)
    if (r.*member) values.insert(*(r.*member));
  return values.size();
}

std::vector<std::string> headline_columns(std::span<const Record> records, bool with_group) {
  const auto varies = [&](auto member) {
    return std::ranges::any_of(records, [&](const Record& r) { return r.*member != records.front().*member; });
  };
  std::vector<std::string> names;
  if (with_group) {
    names = {"scene", "light"};
    if (varies(&Record::view)) names.emplace_back("view");
    if (std::ranges::any_of(records, [](const Record& r) { return !r.path.empty(); })) names.emplace_back("path");
    if (value_count(records, &Record::start) > 1) names.emplace_back("start");
    if (value_count(records, &Record::frame_rate) > 1) names.emplace_back("frame_rate");
    if (varies(&Record::width) || varies(&Record::height)) names.insert(names.end(), {"width", "height"});
    if (varies(&Record::truth)) names.emplace_back("truth");
    add_known(names, records, {"constant_error"});
  }
  names.insert(names.end(), {"technique", "support", "setup_ms"});
  add_stage_columns(names, records);
  const auto has_device_times = [](const Record& r) { return !r.device_times(Stage::resolve).empty(); };
  if (std::ranges::any_of(records, has_device_times)) {
    names.insert(names.end(), {"relight_device_ms", "resolve_device_ms", "floor_share"});
    if (std::ranges::any_of(records, [](const Record& r) { return rays_per_second(r).has_value(); }))
      names.emplace_back("rays_per_second");
  }
  names.insert(names.end(), {"bytes", "peak_bytes"});
  add_error_columns(names, records);
  add_memory_columns(names, records);
  const bool with_hard = has_wrong_pixels(records);
  if (with_hard) names.insert(names.end(), {"wrong_rate_all", "false_dark_rate", "false_lit_rate"});
  if (std::ranges::any_of(records, [](const Record& r) { return !top_causes(r).empty(); })) names.emplace_back("causes");
  if (with_hard) names.insert(names.end(), {"displacement_mean", "displacement_p95"});
  add_soft_columns(names, records);
  add_class_columns(names);
  return names;
}

std::vector<std::string> paper_columns(std::span<const Record> records) {
  std::vector<std::string> names = {"technique", "support"};
  add_stage_columns(names, records);
  names.emplace_back("bytes");
  add_error_columns(names, records);
  if (has_wrong_pixels(records)) names.insert(names.end(), {"false_dark_rate", "false_lit_rate", "displacement_mean"});
  add_soft_columns(names, records);
  add_class_columns(names);
  return names;
}

Remarks legend(const Layout& layout, const Marks& marks) {
  const auto has = [&](bool Cell::*mark) {
    for (const Layout::Group& group : layout.groups)
      for (const Layout::Row& row : group.rows)
        if (std::ranges::any_of(row.cells, mark)) return true;
    return false;
  };
  Remarks lines;
  if (has(&Cell::is_best)) lines.emplace_back(marks.best, layout.best);
  if (has(&Cell::is_floored)) lines.emplace_back(marks.floored, "within the reference's noise of the best value");
  if (has(&Cell::is_flagged))
    lines.emplace_back(marks.flagged,
                       fmt::format("less than {} % of the pixels facing the light are tested: read the errors with care",
                                   exact(100 * least_tested_share)));
  lines.insert(lines.end(), layout.shorthands.begin(), layout.shorthands.end());
  return lines;
}

Layout::Row row_of(const Record& record, std::span<const Column> columns) {
  Layout::Row row{.record = &record};
  for (const Column& column : columns) row.cells.push_back(column.cell(record));
  return row;
}

Layout lay_out(std::span<const Record> records, std::span<const std::string> names) {
  Layout layout{.columns = select(all_columns(records), names), .provenance = provenance(records)};
  const std::vector<Column>& columns = layout.columns;
  bool has_null = false;
  for (const Record& record : records) {
    auto group = std::ranges::find_if(
        layout.groups, [&](const Layout::Group& one) { return place_of(*one.rows.front().record) == place_of(record); });
    if (group == layout.groups.end()) {
      layout.groups.push_back({.heading = group_heading(record)});
      group = layout.groups.end() - 1;
    }
    Layout::Row& row = group->rows.emplace_back(row_of(record, columns));
    for (std::size_t i = 0; i < columns.size(); ++i) has_null = has_null || shown(columns[i], row.cells[i]) == "-";
    if (record.reason.empty()) continue;
    add_once(layout.reasons, record.reason);
    row.reason = index_of(layout.reasons, record.reason) + 1;
  }
  for (Layout::Group& group : layout.groups) mark_best(columns, group);

  for (Layout::Group& group : layout.groups) {
    // Techniques that are compared with different numbers that are true of a light have constants of their own.
    std::optional<double> largest;
    for (const Layout::Row& row : group.rows)
      if (const std::optional<double> constant = row.record->metric("constant_error"))
        largest = std::max(largest.value_or(0), *constant);
    if (largest) group.heading += fmt::format("; {}", constant_text(*largest));
  }
  for (const Layout::Group& group : layout.groups)
    if (const std::string text = uncertainty(group); !text.empty()) layout.shorthands.emplace_back("uncertain", text);

  layout.best = "best contender of its group";
  if (std::ranges::any_of(columns, [](const Column& c) { return c.log_time != nullptr; }))
    layout.best += "; of times, all that cannot be told apart from the best one";
  add_shorthands(layout, records, has_null);
  return layout;
}

}  // namespace gnomon
