// A contact sheet: the error pictures that a run kept, one a row, in one picture.
#include <fstream>

#include "measure/score/error_picture.h"
#include "measure/score/record_causes.h"
#include "report/figure/figure_names.h"
#include "report/figure/figure_script.h"
#include "report/table/digits.h"

namespace gnomon {

namespace {

namespace fs = std::filesystem;

/// More pictures than these are too small to see anything in.
constexpr std::size_t most_pictures = 60;

/// Height of a PNG in pixels: bytes 20 to 23, the most significant first. Throws Error on a file that is none.
int png_height(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  char head[24] = {};
  if (!in.read(head, sizeof head) || std::string_view(head, 4) != "\x89PNG") throw Error("{} is no PNG", file.string());
  int height = 0;
  for (std::size_t k = 20; k < 24; ++k) height = height << 8 | static_cast<unsigned char>(head[k]);
  return height;
}

/// A picture without its legend, which lies below the rows of the view.
struct SheetPicture {
  const Record* record;
  fs::path file;
  int height;  ///< of the file, legend included
};

std::vector<SheetPicture> pictures_of(std::span<const Record> records) {
  std::vector<SheetPicture> pictures;
  std::size_t without = 0;
  for (const Record& r : records) {
    if (r.status != Status::ok || r.role == Role::reference) continue;
    if (!r.error_picture || !fs::exists(*r.error_picture)) {
      ++without;
      continue;
    }
    const fs::path file = fs::absolute(*r.error_picture);
    pictures.push_back({&r, file, png_height(file)});
    if (pictures.back().height < r.height)
      throw Error("{} has {} rows of pixels, fewer than its row of the run, {}", file.string(), pictures.back().height,
                  r.height);
  }
  if (pictures.empty())
    throw Error(
        "there is nothing to draw: no row has an error picture in its folder; `gnomon run --pictures all` keeps them ({} "
        "rows have none)",
        without);
  if (pictures.size() > most_pictures)
    throw Error("{} pictures are more than the {} that one sheet holds; --filter chooses among them", pictures.size(),
                most_pictures);
  return pictures;
}

/// "pcf=3, error 0.52 %", before it the place where the sheet has several. The error is not broken over lines.
std::string caption(const Record& record, const std::string& setting, std::span<const Place> places) {
  const std::optional<double> error = record.metric("error");
  return fmt::format("{}{}{}", places.size() > 1 ? title(place_of(record), places) + ": " : "", setting,
                     error ? fmt::format(", error\u00a0{}\u00a0%", measured(*error * 100)) : "");
}

/// The colors of the causes that some row has; of rows without causes those of false dark and false lit.
void add_legend(std::span<const SheetPicture> pictures, FigureScript& script) {
  std::vector<Record> shown;
  for (const SheetPicture& picture : pictures) shown.push_back(*picture.record);
  const auto add = [&](const Color& color, const std::string& label) {
    // In a frame, which shows white on white.
    script.legend.push_back({fmt::format("with boxes fc rgb '#{:02x}{:02x}{:02x}' fs solid 1 border lc rgb '#666666'", color[0],
                                         color[1], color[2]),
                             label});
  };
  const bool has_causes = std::ranges::any_of(shown, [](const Record& r) { return r.causes.has_value(); });
  if (!has_causes)
    for (const ErrorKind& kind : error_kinds(false)) add(kind.color, kind.label);
  else
    for (const CauseInfo& info : causes_of(shown))
      if (std::ranges::any_of(shown,
                              [&](const Record& r) { return quantity(r, fmt::format("cause.{}", info.name)).value_or(0) > 0; }))
        add(info.color, with_blanks(info.name));
}

}  // namespace

void draw_sheet(std::span<const Record> records, FigureScript& script) {
  const std::vector<SheetPicture> pictures = pictures_of(records);
  std::vector<Place> places;
  PanelFrame frame{.titles = {}, .most_columns = 4, .is_bare = true};
  double tallest = 0;
  std::vector<std::string> settings;
  for (const SheetPicture& picture : pictures) {
    settings.push_back(setting_name(*picture.record));
    add_once(places, place_of(*picture.record));
    tallest = std::max(tallest, static_cast<double>(picture.record->height) / picture.record->width);
  }
  const ShortNames names = without_shared(settings);
  script.heading = names.heading;
  for (std::size_t k = 0; k < pictures.size(); ++k)
    frame.titles.push_back(caption(*pictures[k].record, names.names[k], places));
  frame.most_columns = std::min<std::size_t>(4, static_cast<std::size_t>(std::ceil(std::sqrt(pictures.size()))));
  frame.height_per_width = tallest;
  add_legend(pictures, script);
  script.shows = fmt::format("error pictures of {}", places.size() == 1 ? title(places.front(), places) : "several places");
  const PanelGrid grid = open_panels(script, frame);
  script.add("unset tics; unset border; unset grid; unset colorbox; set size ratio -1");
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const auto& [record, file, height] = pictures[k];
    open_panel(script, grid, k, frame.titles[k], "");
    // gnuplot counts rows from the bottom.
    script.add("set xrange [-0.5:{}]; set yrange [{}:{}]", record->width - 0.5, height - record->height - 0.5, height - 0.5);
    PlotCommand plot;
    plot.add(frame.titles[k], "{} binary filetype=png with rgbimage notitle", FigureScript::quoted(file.string()));
    plot.into(script);
  }
  script.add("set size noratio");
  close_panels(script);
}

}  // namespace gnomon
