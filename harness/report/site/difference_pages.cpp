// Machines side by side: numbers to the last bit, times as ratios with intervals.
#include <cmath>

#include "analysis/machines.h"
#include "report/html/html_parts.h"
#include "report/site/site_parts.h"
#include "report/table/digits.h"

namespace gnomon::site {

namespace {

/// What two rows of the same setting at the same place differ by.
struct Difference {
  bool is_same = false;                    ///< every metric against either truth, to the last bit, and every cause
  std::vector<std::string> what;           ///< names of metrics that differ, "causes"
  std::optional<ValueWithInterval> ratio;  ///< time of the first over that of the second
};

Difference difference_of(const Record& first, const Record& second) {
  Difference found;
  for (const Truth truth : {Truth::shape, Truth::mesh}) {
    const auto a = first.metrics.find(truth), b = second.metrics.find(truth);
    if (a == first.metrics.end() || b == second.metrics.end()) continue;
    for (const auto& [name, value] : a->second)
      if (const auto other = b->second.find(name); other != b->second.end() && other->second != value)
        if (std::ranges::find(found.what, name) == found.what.end()) found.what.push_back(name);
  }
  if (first.causes && second.causes && *first.causes != *second.causes) found.what.emplace_back("causes");
  found.is_same = found.what.empty();
  const Sample a = sample_of(first, parts_of(Cost::light)), b = sample_of(second, parts_of(Cost::light));
  if (a.is_timed() && b.is_timed() && b.value() > 0)
    found.ratio =
        bootstrap(std::vector{a, b}, [](std::span<const double> times) { return times[0] / std::max(times[1], 1e-9); });
  return found;
}

/// How many rows two entries have in common, and what of them is the same.
struct Summary {
  std::size_t rows = 0, same = 0, timed = 0;
  double log_ratio = 0;  ///< sum
};

class DifferencePage {
 public:
  DifferencePage(const Pages& pages, std::vector<const Entry*> entries)
      : pages_(pages),
        entries_(std::move(entries)),
        path_(Pages::differences_path(*entries_.front())),
        summaries_(entries_.size()) {
    for (const Entry* const entry : entries_) runs_.push_back({entry->dir, entry->records});
    table_.heads = {{"row", "", true}, {"error of A", "%"}};
    for (std::size_t k = 1; k < entries_.size(); ++k)
      for (const char* const what : {"numbers of", "error of", "time of A /", "pixels of"})
        table_.heads.push_back({fmt::format("{} {}", what, letter(k)), std::string_view(what) == "error of" ? "%" : "",
                                std::string_view(what) == "numbers of"});
    for (const MachineRow& row : rows_by_machine(runs_)) add(row);
  }

  bool is_empty() const { return table_.rows.empty(); }

  Page page() const {
    std::string legend = "<ul>\n";
    for (std::size_t k = 0; k < entries_.size(); ++k)
      legend += fmt::format("<li>{}: {}{}</li>\n", letter(k),
                            link_html(path_, Pages::table_path(*entries_[k]), full_title(*entries_[k])),
                            k == 0 ? "" : html_text(summary_text(summaries_[k])));
    legend += "</ul>\n";
    return {.path = path_,
            .title = fmt::format("{}: differences between machines", entries_.front()->suite),
            .kicker = "Differences",
            .body = section_html("machines", "Machines", legend) +
                    section_html(
                        "rows", "Rows",
                        paragraph(
                            "Numbers are the same where every metric and every cause is, to the last bit. Times are those of "
                            "relight and resolve: a ratio above 1 says that A is slower. Its interval is that of 95 %, by a "
                            "bootstrap over processes. Pixels: those whose visibility is another than A's by more than half a "
                            "step of eight bits, where both folders have masks.") +
                            table_.html())};
  }

 private:
  static std::string letter(std::size_t k) {
    return k < 26 ? std::string(1, static_cast<char>('A' + k)) : fmt::format("M{}", k + 1);
  }

  static std::string summary_text(const Summary& summary) {
    std::string text = fmt::format("; {} of {} rows have the same numbers as A", summary.same, summary.rows);
    if (summary.timed > 0)
      text += fmt::format("; A takes {} times as long, the geometric mean of {} rows",
                          rounded(std::exp(summary.log_ratio / static_cast<double>(summary.timed)), 3), summary.timed);
    return text;
  }

  std::optional<std::size_t> differing(const Record& first, const Record& second, std::size_t run) const {
    try {
      const auto lights = differing_pixels(first, runs_.front().dir, second, runs_[run].dir);
      if (!lights) return std::nullopt;
      std::size_t count = 0;
      for (const DifferingPixels& light : *lights) count += light.pixels.size();
      return count;
    } catch (const Error& error) {
      pages_.folder.notes.push_back(fmt::format("masks not compared: {}", error.what()));
      return std::nullopt;
    }
  }

  void add(const MachineRow& row) {
    const Record* const first = row.front();
    if (!first || first->status != Status::ok) return;
    const auto is_done = [](const Record* r) { return r && r->status == Status::ok; };
    if (std::ranges::count_if(row, is_done) < 2) return;
    const Column error = error_column(), ratio = number_column("ratio", "", "ratio");
    std::vector<HtmlTable::Cell> cells{
        linked_cell(link_html(path_, Pages::row_path(*entries_.front(), *first), title(*first)), title(*first)),
        number_html_cell(error, first->metric("error"))};
    for (std::size_t k = 1; k < row.size(); ++k) {
      if (!is_done(row[k])) {
        cells.resize(cells.size() + 4, {.html = "-"});
        continue;
      }
      const Difference found = difference_of(*first, *row[k]);
      Summary& summary = summaries_[k];
      ++summary.rows;
      summary.same += found.is_same;
      if (found.ratio && found.ratio->value > 0) {
        ++summary.timed;
        summary.log_ratio += std::log(found.ratio->value);
      }
      const std::string what = joined(std::span(found.what).first(std::min<std::size_t>(found.what.size(), 8)), ", ");
      cells.push_back(found.is_same
                          ? text_html_cell("same")
                          : linked_cell(fmt::format("<span title=\"{}\">differ: {}</span>", html_text(what), found.what.size()),
                                        fmt::format("differ {}", found.what.size())));
      cells.push_back(number_html_cell(error, row[k]->metric("error")));
      cells.push_back(
          found.ratio ? HtmlTable::Cell{.html = html_text(value_text(ratio, *found.ratio)), .sort = exact(found.ratio->value)}
                      : HtmlTable::Cell{.html = "-"});
      const auto pixels = differing(*first, *row[k], k);
      cells.push_back(pixels ? HtmlTable::Cell{.html = fmt::format("{}", *pixels), .sort = fmt::format("{}", *pixels)}
                             : HtmlTable::Cell{.html = "-"});
    }
    table_.rows.push_back(std::move(cells));
  }

  const Pages& pages_;
  std::vector<const Entry*> entries_;
  std::string path_;
  std::vector<MachineRun> runs_;
  std::vector<Summary> summaries_;
  HtmlTable table_{.caption = "Rows that two machines did", .heads = {}, .rows = {}, .has_filter = true};
};

}  // namespace

void add_differences(Pages& pages) {
  for (const std::string& suite : pages.suites) {
    const std::vector<const Entry*> entries = pages.entries_of(suite);
    if (entries.size() < 2) continue;
    const DifferencePage differences(pages, entries);
    if (differences.is_empty()) continue;
    const Page page = differences.page();
    pages.folder.add(page);
    pages.folder.index(page.path, page.title, "differences");
    pages.with_differences.insert(suite);
  }
}

}  // namespace gnomon::site
