// Error against cost: every setting a mark with its interval, the front a staircase.
#include <algorithm>
#include <cmath>

#include "report/figure/figure_script.h"

namespace gnomon {

namespace {

/// Settings with a color of their own, and marks with a number, are at most so many.
constexpr std::size_t most_named = 16;

/// What is drawn, in the units that people see. The data go into the script before the panel is opened, its axes after.
class FrontFigure {
 public:
  /// Throws Error where no contender has a cost.
  FrontFigure(const Field& field, const AnalysisOptions& options);

  void add_staircase(FigureScript& script);
  void add_series(FigureScript& script);
  void number_front(FigureScript& script);
  void set_axes(FigureScript& script) const;

  PlotCommand plot;

 private:
  double x(const Candidate& c) const { return c.cost->value * cost_column_.shown_scale; }
  /// No error at all has no place on a logarithmic axis: it stands below the least, at `zero_`.
  double y(const Candidate& c) const { return is_log_ && c.error <= 0 ? zero_ : c.error * error_column_.shown_scale; }

  const Field& field_;
  const AnalysisOptions& options_;
  Column error_column_, cost_column_;
  bool is_higher_better_;
  std::vector<const Candidate*> shown_;  ///< those with a cost but the baseline
  std::vector<const Candidate*> front_;  ///< by cost
  bool is_named_ = false;                ///< each setting has a color of its own
  bool is_log_ = false, has_zero_ = false;
  Extent errors_, costs_;  ///< errors above 0
  double zero_ = 0, top_ = 0;
  std::vector<std::string> numbers_;  ///< commands that write numbers beside marks
};

FrontFigure::FrontFigure(const Field& field, const AnalysisOptions& options)
    : field_(field),
      options_(options),
      error_column_(quantity_column(options.metric)),
      cost_column_(quantity_column(options.cost == Cost::bytes ? "bytes" : "resolve_ms")),
      is_higher_better_(better(options.metric) == "higher") {
  const std::vector<FrontEntry> stands = find_front(field, better(options.metric));
  for (std::size_t i = 0; i < field.candidates.size(); ++i) {
    const Candidate& c = field.candidates[i];
    if (c.role == Role::baseline || !c.cost || c.cost->value <= 0) continue;
    shown_.push_back(&c);
    if (stands[i].standing == Standing::front) front_.push_back(&c);
    if (c.error > 0) errors_.add(c.error * error_column_.shown_scale);
    has_zero_ = has_zero_ || c.error <= 0;
    costs_.add(c.cost->low * cost_column_.shown_scale);
    costs_.add(c.cost->high * cost_column_.shown_scale);
  }
  if (shown_.empty())
    throw Error("there is nothing to draw: no contender has {} and {}", options.metric, sentence(options.cost));
  std::sort(front_.begin(), front_.end(), [](const auto* a, const auto* b) { return a->cost->value < b->cost->value; });
  is_named_ = shown_.size() <= most_named;
  const double greatest_error = std::max(errors_.greatest, 0.0);
  is_log_ = greatest_error > 0 && !is_higher_better_;
  zero_ = is_log_ ? errors_.least / 4 : 0;
  top_ = is_log_ ? greatest_error * 2 : greatest_error * 1.08;
}

/// The front, from the top to the right edge.
void FrontFigure::add_staircase(FigureScript& script) {
  if (front_.empty()) return;
  std::vector<std::string> lines{fmt::format("{}\t{}", x(*front_.front()), is_higher_better_ ? 0 : top_)};
  for (const Candidate* c : front_) lines.push_back(fmt::format("{}\t{}", x(*c), y(*c)));
  lines.push_back(fmt::format("{}\t{}", costs_.greatest * 1.3, y(*front_.back())));
  plot.add("{} using 1:2 with steps lw 1.6 lc rgb '#bbbbbb' notitle", script.data(lines));
  script.legend.push_back({"with lines lw 1.6 lc rgb '#bbbbbb'", "front"});
}

void FrontFigure::add_series(FigureScript& script) {
  // Marks of one color: of one setting while these are few, of a technique otherwise.
  std::vector<std::pair<std::string, std::vector<const Candidate*>>> all;
  for (const Candidate* c : shown_) value_of_key(all, is_named_ ? c->setting : c->technique).push_back(c);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto& [name, candidates] = all[k];
    std::vector<std::string> lines;
    for (const Candidate* c : candidates)
      lines.push_back(fmt::format("{}\t{}\t{}\t{}", x(*c), y(*c), c->cost->low * cost_column_.shown_scale,
                                  c->cost->high * cost_column_.shown_scale));
    const bool is_contender = candidates.front()->role == Role::contender;
    const std::string style =
        is_contender ? fmt::format("pt {} ps {} lc rgb '{}'", series_mark(k), is_named_ ? 1.0 : 0.6, series_color(k))
                     : "pt 2 ps 0.9 lw 1.4 lc rgb '#555555'";
    plot.add("{} using 1:2:3:4 with xerrorbars {} notitle", script.data(lines), style);
    script.legend.push_back({"with points " + style, name + (is_contender ? "" : " (reference)")});
  }
}

/// Where settings are too many to name them all, those on the front have a number that the legend explains.
void FrontFigure::number_front(FigureScript& script) {
  if (is_named_ || front_.size() > most_named) return;
  for (std::size_t k = 0; k < front_.size(); ++k) {
    numbers_.push_back(fmt::format("set label '{}' at {},{} right offset -0.3,-0.7 textcolor rgb '#222222'", k + 1,
                                   x(*front_[k]), y(*front_[k])));
    script.legend.push_back({"with points pt 0 lc rgb '#ffffff'", fmt::format("{}: {}", k + 1, front_[k]->setting)});
  }
}

void FrontFigure::set_axes(FigureScript& script) const {
  const std::string over = field_.place ? "" : fmt::format(", geometric mean over {} places", field_.places);
  script.add("set xlabel {}",
             FigureScript::quoted(fmt::format("{} ({}){}", sentence(options_.cost), cost_column_.shown_unit, over)));
  script.add("set ylabel {}", FigureScript::quoted(axis_label(error_column_) + (field_.place ? "" : ", mean")));
  const double left = costs_.least / 1.3, right = costs_.greatest * 1.3;
  script.add("set logscale x; set xtics {}; set xrange [{}:{}]", log_tics(left, right, 8), left, right);
  if (is_log_) {
    const double bottom = has_zero_ ? zero_ / 1.5 : errors_.least / 2;
    const double first_tic = has_zero_ ? errors_.least / 1.5 : bottom;
    script.add("set logscale y; set ytics {}; set yrange [{}:{}]", log_tics(first_tic, top_, 8), bottom, top_);
    if (has_zero_) script.add("set ytics add ('0' {})", zero_);
  } else {
    script.add("set yrange [0:{}]", is_higher_better_ ? "*" : fmt::format("{}", top_ > 0 ? top_ : 1));
  }
  for (const std::string& number : numbers_) script.add("{}", number);
}

}  // namespace

void draw_front(std::span<const Record> records, FigureScript& script) {
  const AnalysisOptions& wanted = script.options.analysis;
  const std::vector<Field> fields = find_fields(records, {.error = wanted.metric, .cost = wanted.cost});
  FrontFigure figure(fields.back(), wanted);  // over all places, or the only one
  figure.add_staircase(script);
  figure.add_series(script);
  figure.number_front(script);
  open_panels(script, 1, 1, script.options.width_cm * 0.55);
  figure.set_axes(script);
  figure.plot.into(script);
  close_panels(script);
}

}  // namespace gnomon
