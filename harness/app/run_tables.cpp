#include "app/run_tables.h"

#include <algorithm>

#include "measure/scene/blob.h"
#include "report/table/table.h"

namespace gnomon::app {

namespace fs = std::filesystem;

void write_tables(const fs::path& folder, std::span<const Record> records) {
  if (records.empty()) return;
  for (const auto& [format, file] : {std::pair(Format::markdown, "table.md"), std::pair(Format::csv, "table.csv"),
                                     std::pair(Format::latex, "table.tex"), std::pair(Format::json, "table.json")})
    write_file(folder / file, render_table(records, format));
}

void print_contents(const fs::path& folder) {
  fmt::print(
      "{0}/records.jsonl  every raw repetition and metric\n{0}/masks/         visibility masks, EXR\n"
      "{0}/errors/        error pictures, PNG\n{0}/shaded/        shaded pictures, PNG\n"
      "{0}/table.*        this table as md, csv, tex, json\n",
      folder.string());
}

std::string count_text(std::span<const Record> records) {
  const auto count = [&](Status status) {
    return std::ranges::count_if(records, [&](const Record& r) { return r.status == status; });
  };
  return fmt::format("{} rows: {} ok, {} unsupported, {} failed", records.size(), count(Status::ok), count(Status::unsupported),
                     count(Status::failed));
}

}  // namespace gnomon::app
