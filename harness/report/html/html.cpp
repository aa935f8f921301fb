#include "report/html/html.h"

#include <gnomon/error.h>

#include "analysis/in_order.h"
#include "report/figure/figure_style.h"
#include "report/html/html_parts.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// The template with its slots filled, in their order. Slots in the inserted texts stay as they are.
std::string filled(std::string_view page, std::initializer_list<std::pair<std::string_view, std::string_view>> slots) {
  std::size_t size = page.size();
  for (const auto& [slot, text] : slots) size += text.size();
  std::string html;
  html.reserve(size);
  for (const auto& [slot, text] : slots) {
    const std::size_t at = page.find(slot);
    if (at == page.npos) throw Error("the page of the report has no slot {} where it is required", slot);
    html.append(page.substr(0, at)).append(text);
    page.remove_prefix(at + slot.size());
  }
  return html.append(page);
}

std::string title_of(const fs::path& dir, std::span<const Record> records) {
  std::vector<std::string> suites;
  for (const Record& r : records)
    if (!r.suite.empty()) add_once(suites, r.suite);
  if (!suites.empty()) return joined(suites, ", ");
  return (dir.has_filename() ? dir : dir.parent_path()).filename().string();
}

}  // namespace

Report make_report(const fs::path& dir, std::span<const Record> records, bool with_pictures, bool with_all_frames) {
  if (page_template().empty())
    throw Error("this program was built without the report's page (GNOMON_REPORT=OFF); `gnomon table` has the same numbers");
  if (records.empty()) throw Error("{} holds no records; a report needs at least one", dir.string());

  const Layout layout = lay_out(records, column_names(records));
  const std::string title = title_of(dir, records);
  Json data = report_data(layout, records);
  data["title"] = title;
  PictureSet pictures = with_pictures ? collect_pictures(dir, layout) : PictureSet();
  if (!with_pictures) pictures.notes.push_back("pictures were left out on demand");
  const Json frames = collect_frames(dir, layout, with_pictures, with_all_frames, pictures);
  for (std::size_t k = 0; k < pictures.groups.size(); ++k) data["groups"][k]["pictures"] = pictures.groups[k];
  for (std::size_t k = 0; k < pictures.rows.size(); ++k) data["rows"][k]["pictures"] = pictures.rows[k];
  for (std::size_t k = 0; k < frames.size(); ++k)
    if (!frames[k].is_null()) data["rows"][k]["kept_frames"] = frames[k];
  data["notes"] = pictures.notes;

  std::string blobs;
  for (std::size_t k = 0; k < pictures.blobs.size(); ++k) {
    blobs.append(fmt::format("<script type=\"text/plain\" id=\"blob{}\">", k)).append(pictures.blobs[k]).append("</script>\n");
    pictures.blobs[k] = {};  // a long run's pictures fill memory once
  }
  return {.html = filled(page_template(), {{title_slot, html_text(title)},
                                           {colors_slot, color_variables()},
                                           {data_slot, script_text(data)},
                                           {pictures_slot, blobs}}),
          .notes = pictures.notes};
}

}  // namespace gnomon
