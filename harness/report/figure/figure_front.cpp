// Error against cost: every setting a mark with its interval, the front a staircase. A panel for each kind of light.
#include "measure/counted.h"
#include "report/figure/figure_axis.h"

namespace gnomon {

namespace {

/// Settings with a color of their own, and marks with a number, are at most so many.
constexpr std::size_t most_named = 16;

/// What all panels share.
struct FrontLegend {
  bool is_named = false;                ///< each setting has a color of its own; else each technique
  std::vector<std::string> names;       ///< of contenders, that have colors
  std::vector<std::string> references;  ///< that have crosses
  std::vector<std::string> numbered;    ///< settings on a front, numbered where they are too many to name them all
  bool has_front = false, has_floor = false, has_constant = false;

  const std::string& name_of(const Candidate& c) const { return is_named ? c.setting : c.technique; }
};

/// What is drawn of one field, in the units that people see. The data go into the script before the panels are opened, the axes
/// after.
class FrontPanel {
 public:
  FrontPanel(const Field& field, const AnalysisOptions& options)
      : field_(field),
        options_(options),
        error_column_(quantity_column(options.metric)),
        cost_column_(quantity_column(options.cost == Cost::bytes ? "bytes" : "resolve_ms")),
        is_higher_better_(better(options.metric) == "higher") {
    const std::vector<FrontEntry> stands = find_front(field, better(options.metric));
    for (std::size_t i = 0; i < field.candidates.size(); ++i) {
      const Candidate& c = field.candidates[i];
      if (c.role == Role::baseline || !c.cost || c.cost->value <= 0) continue;
      require_not_negative(c.error, options.metric);
      shown_.push_back(&c);
      if (stands[i].standing == Standing::front) front_.push_back(&c);
      if (c.error > 0) errors_.add(c.error * error_column_.shown_scale);
      if (c.floor) floor_ = std::max(floor_, *c.floor * error_column_.shown_scale);
      has_zero_ = has_zero_ || c.error <= 0;
      costs_.add(c.cost->low * cost_column_.shown_scale);
      costs_.add(c.cost->high * cost_column_.shown_scale);
    }
    if ((options.metric == "error" || options.metric == "coverage_error_mean") && field.constant)
      constant_ = *field.constant * error_column_.shown_scale;
    for (const double level : {floor_, constant_})
      if (level > 0) errors_.add(level);
    std::sort(front_.begin(), front_.end(), [](const auto* a, const auto* b) { return a->cost->value < b->cost->value; });
    const double greatest_error = std::max(errors_.greatest, 0.0);
    is_log_ = greatest_error > 0 && !is_higher_better_;
    zero_ = is_log_ ? errors_.least / 4 : 0;
    top_ = is_log_ ? greatest_error * 2 : greatest_error * 1.08;
  }

  void add_data(FigureScript& script, FrontLegend& legend) {
    add_staircase(script, legend);
    add_level(script, floor_, 3, "error floor", legend.has_floor);
    add_level(script, constant_, 2, "best constant mask", legend.has_constant);
    add_series(script, legend);
    number_front(legend);
  }

  std::string x_label(bool is_only) const {
    const std::string over = field_.place ? "" : ", geometric mean over " + counted(field_.places, "place{s}");
    return fmt::format("{} ({}){}", sentence(options_.cost), cost_column_.shown_unit, is_only ? over : "");
  }
  std::string y_label() const { return axis_label(error_column_) + (field_.place ? "" : ", mean"); }

  void set_axes(FigureScript& script, const PanelGrid& grid) const {
    const auto [left, right] = x_ends();
    script.add("set logscale x; set xtics {}; set xrange [{}:{}]", log_tics(left, right, grid.x_labels()), left, right);
    if (is_log_) {
      script.add("set logscale y; set ytics {}; set yrange [{}:{}]", y_tics(grid), bottom(), top_);
      if (has_zero_) script.add("set ytics add ('0' {})", zero_);
    } else {
      script.add("unset logscale y; set ytics autofreq; set yrange [0:{}]", top_ > 0 ? top_ : 1);
    }
    script.add("unset label");
    write_numbers(script, grid);
  }

  /// Of a logarithmic axis.
  std::string y_tics(const PanelGrid& grid) const {
    return is_log_ ? log_tics(has_zero_ ? errors_.least / 1.5 : bottom(), top_, grid.y_labels()) : "";
  }

  const std::vector<const Candidate*>& shown() const { return shown_; }
  const Field& field() const { return field_; }

  PlotCommand plot;

 private:
  /// The front, from the top to the right edge.
  void add_staircase(FigureScript& script, FrontLegend& legend) {
    if (front_.empty()) return;
    std::vector<std::string> lines{fmt::format("{}\t{}", x(*front_.front()), is_higher_better_ ? 0 : top_)};
    for (const Candidate* c : front_) lines.push_back(fmt::format("{}\t{}", x(*c), y(*c)));
    lines.push_back(fmt::format("{}\t{}", costs_.greatest * 1.3, y(*front_.back())));
    const std::string style = fmt::format("lw 1.6 lc rgb '{}'", faint_color);
    plot.add("front", "{} using 1:2 with steps {} notitle", script.data(lines), style);
    if (std::exchange(legend.has_front, true)) return;
    script.legend.push_back({"with lines " + style, "front"});
  }

  /// A line at an error that others are read against; none at 0.
  void add_level(FigureScript& script, double level, int dashes, const char* name, bool& is_said) {
    if (level <= 0) return;
    const std::vector<std::string> lines{fmt::format("{}\t{}", costs_.least / 1.3, level),
                                         fmt::format("{}\t{}", costs_.greatest * 1.3, level)};
    const std::string style = fmt::format("with lines dt {} lw 1.2 lc rgb '{}'", dashes, ink_color);
    plot.add(name, "{} using 1:2 {} notitle", script.data(lines), style);
    if (std::exchange(is_said, true)) return;
    script.legend.push_back({style, name});
  }

  void add_series(FigureScript& script, FrontLegend& legend) {
    // Marks of one color: of one setting while these are few, of a technique otherwise.
    std::vector<std::pair<std::string, std::vector<const Candidate*>>> all;
    for (const Candidate* c : shown_) value_of_key(all, legend.name_of(*c)).push_back(c);
    for (const auto& [name, candidates] : all) {
      std::vector<std::string> lines;
      for (const Candidate* c : candidates)
        lines.push_back(fmt::format("{}\t{}\t{}\t{}", x(*c), y(*c), c->cost->low * cost_column_.shown_scale,
                                    c->cost->high * cost_column_.shown_scale));
      const bool is_contender = candidates.front()->role == Role::contender;
      std::vector<std::string>& known = is_contender ? legend.names : legend.references;
      const std::size_t k = index_of(known, name);
      const bool is_new = k == known.size();
      if (is_new) known.push_back(name);
      if (is_contender) require_series(known.size(), "techniques");
      const std::string style = is_contender ? fmt::format("pt {} ps {} lc rgb '{}'", series_style(k).mark,
                                                           legend.is_named ? 1.0 : 0.6, series_style(k).color)
                                             : fmt::format("pt {} ps 0.9 lw 1.4 lc rgb '{}'", reference_mark(k), ink_color);
      plot.add(name, "{} using 1:2:3:4 with xerrorbars {} notitle", script.data(lines), style);
      if (is_new) script.legend.push_back({"with points " + style, name + (is_contender ? "" : " (reference)")});
    }
  }

  /// Where settings are too many to name them all, those on the front have a number that the legend explains.
  void number_front(FrontLegend& legend) {
    if (legend.is_named || front_.size() > most_named) return;
    for (const Candidate* c : front_) {
      add_once(legend.numbered, c->setting);
      numbers_.push_back(fmt::format("{}", index_of(legend.numbered, c->setting) + 1));
    }
  }

  std::pair<double, double> x_ends() const { return {costs_.least / 1.3, costs_.greatest * 1.3}; }
  double bottom() const { return has_zero_ ? zero_ / 1.5 : errors_.least / 2; }

  /// Where a mark lies in its panel; an axis without a known end is not looked at.
  PanelPoint place(const Candidate& c, const PanelGrid& grid) const {
    const auto [left, right] = x_ends();
    const double across = std::log(x(c) / left) / std::log(right / left);
    const double up = is_log_ ? std::log(y(c) / bottom()) / std::log(top_ / bottom()) : y(c) / (top_ > 0 ? top_ : 1);
    return {across * grid.width_cm, up * grid.height_cm};
  }

  void write_numbers(FigureScript& script, const PanelGrid& grid) const {
    if (numbers_.empty()) return;
    std::vector<PanelPoint> marks, all;
    for (const Candidate* c : front_) marks.push_back(place(*c, grid));
    for (const Candidate* c : shown_) all.push_back(place(*c, grid));
    const std::vector<PanelPoint> offsets = label_offsets(marks, numbers_, all, grid);
    for (std::size_t k = 0; k < numbers_.size(); ++k)
      script.add("set label '{}' at {},{} center offset graph {:.4f},graph {:.4f} textcolor rgb '#222222'", numbers_[k],
                 x(*front_[k]), y(*front_[k]), offsets[k].x / grid.width_cm, offsets[k].y / grid.height_cm);
  }

  double x(const Candidate& c) const { return c.cost->value * cost_column_.shown_scale; }
  /// A logarithmic axis has no zero: an error of 0 is drawn below the least, at `zero_`.
  double y(const Candidate& c) const { return is_log_ && c.error <= 0 ? zero_ : c.error * error_column_.shown_scale; }

  const Field& field_;
  const AnalysisOptions& options_;
  Column error_column_, cost_column_;
  bool is_higher_better_;
  std::vector<const Candidate*> shown_;  ///< those with a cost but the baseline
  std::vector<const Candidate*> front_;  ///< by cost
  bool is_log_ = false, has_zero_ = false;
  Extent errors_, costs_;  ///< errors above 0
  double floor_ = 0;       ///< what the reference's own noise makes; 0: there is none to draw
  double constant_ = 0;    ///< error of the best constant mask; the same
  double zero_ = 0, top_ = 0;
  std::vector<std::string> numbers_;  ///< beside the marks of `front_`
};

/// Over which places, where there are two panels.
std::string title_of(const Field& field, std::span<const Place> places) {
  return field.place ? title(*field.place, places)
                     : fmt::format("{} under {}", counted(field.places, "place{s}"), lights_text(field.answer));
}

}  // namespace

void draw_front(std::span<const Record> records, FigureScript& script) {
  const AnalysisOptions& wanted = script.options.analysis;
  require_drawable(records, quantity_column(wanted.metric));
  require_drawable_times(records);
  const std::vector<Field> all = find_fields(records, {.error = wanted.metric, .cost = wanted.cost});
  std::vector<FrontPanel> panels;
  std::vector<std::string> settings;
  std::vector<Place> places;
  for (const Field* field : overall_fields(all)) {
    panels.emplace_back(*field, wanted);
    if (panels.back().shown().empty()) {
      panels.pop_back();
      continue;
    }
    for (const Candidate* c : panels.back().shown()) add_once(settings, c->setting);
    if (field->place) places.push_back(*field->place);
  }
  if (panels.empty()) throw Error("there is nothing to draw: no contender has {} and {}", wanted.metric, sentence(wanted.cost));
  FrontLegend legend{.is_named = settings.size() <= most_named, .names = {}, .references = {}, .numbered = {}};
  for (FrontPanel& panel : panels) panel.add_data(script, legend);
  for (std::size_t k = 0; k < legend.numbered.size(); ++k)
    script.legend.push_back({"with points pt 0 lc rgb '#ffffff'", fmt::format("{}: {}", k + 1, legend.numbered[k])});
  const bool is_only = panels.size() == 1;
  PanelFrame frame{.titles = {}, .x_label = panels.front().x_label(is_only), .y_label = panels.front().y_label()};
  for (const FrontPanel& panel : panels) frame.titles.push_back(is_only ? "" : title_of(panel.field(), places));
  script.shows = fmt::format("{} against {}", frame.y_label, frame.x_label);
  const PanelGrid room = panel_grid(frame, script.options.width_cm);
  for (const FrontPanel& panel : panels)
    std::ranges::move(names_of_tics(panel.y_tics(room)), std::back_inserter(frame.y_names));
  const PanelGrid grid = open_panels(script, frame);
  for (std::size_t k = 0; k < panels.size(); ++k) {
    open_panel(script, grid, k, frame.titles[k], panels[k].y_label());
    panels[k].set_axes(script, grid);
    panels[k].plot.into(script);
  }
  close_panels(script);
}

}  // namespace gnomon
