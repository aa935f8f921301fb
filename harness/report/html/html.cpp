#include "report/html/html.h"

#include <gnomon/error.h>

#include "analysis/in_order.h"
#include "report/html/html_parts.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// The template with its slots filled; what is filled in is not looked at again.
std::string filled(std::string_view page, std::span<const std::pair<std::string_view, std::string_view>> slots) {
  std::size_t size = page.size();
  for (const auto& [slot, text] : slots) size += text.size();
  std::string html;
  html.reserve(size);
  for (const auto& [slot, text] : slots) {
    const std::size_t at = page.find(slot);
    if (at == page.npos) throw Error("the page of the report has no slot {} where it is wanted", slot);
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
  const fs::path folder = dir.has_filename() ? dir.filename() : dir.parent_path().filename();
  return folder.string();
}

}  // namespace

Report make_report(const fs::path& dir, std::span<const Record> records, bool with_pictures) {
  if (page_template().empty())
    throw Error("this program was built without the report's page (GNOMON_REPORT=OFF); `gnomon table` has the same numbers");
  if (records.empty()) throw Error("{} holds no records; a report wants at least one", dir.string());

  const Layout layout = lay_out(records, column_names(records));

  Report report;
  Json data = report_data(layout, records);
  data["title"] = title_of(dir, records);
  PictureSet pictures;
  if (with_pictures)
    pictures = collect_pictures(dir, layout);
  else
    pictures.notes.push_back("pictures were left out on demand");
  for (std::size_t k = 0; k < pictures.groups.size(); ++k) data["groups"][k]["pictures"] = pictures.groups[k];
  for (std::size_t k = 0; k < pictures.rows.size(); ++k) data["rows"][k]["pictures"] = pictures.rows[k];
  data["notes"] = pictures.notes;
  report.notes = pictures.notes;

  std::string blobs;
  for (std::size_t k = 0; k < pictures.blobs.size(); ++k) {
    blobs += fmt::format("<script type=\"text/plain\" id=\"blob{}\">", k);
    blobs += pictures.blobs[k];
    blobs += "</script>\n";
    pictures.blobs[k] = {};  // a long run's pictures fill memory once
  }
  const std::string title = html_text(data["title"].get<std::string>()), json = script_text(data);
  const std::pair<std::string_view, std::string_view> slots[] = {
      {title_slot, title}, {data_slot, json}, {pictures_slot, blobs}};
  report.html = filled(page_template(), slots);
  return report;
}

}  // namespace gnomon
