#include "report/analysis/analysis_table.h"

#include "report/analysis/analysis_table_parts.h"
#include "report/table/layout.h"

namespace gnomon {

std::vector<std::string> analysis_kinds() { return {"growth", "front", "best", "map", "motion", "sweep"}; }

Column quantity_column(const std::string& quantity) {
  for (const Column& column : all_columns({}))
    if (column.name == quantity) {
      Column copy = column;
      copy.cell = {};
      copy.interval = {};
      return copy;
    }
  // A metric that another version measured.
  return {.name = quantity, .unit = "", .heading = quantity, .shown_unit = "", .cell = {}};
}

std::string analyze(std::span<const Record> records, const std::string& kind, const AnalysisOptions& options, Format format,
                    const TableOptions& table) {
  require_word("there is no analysis", kind, analysis_kinds());
  if (kind == "map") return analysis::map_text(records, options, format, table);
  if (kind == "sweep") return analysis::sweep_text(records, options, format, table);
  AnalysisOptions here = options;
  // Programs sort out for themselves what they want.
  here.all = here.all || format == Format::csv || format == Format::json;
  Grid grid = kind == "growth"  ? analysis::growth_grid(records, here)
              : kind == "front" ? analysis::front_grid(records, here)
              : kind == "best"  ? analysis::best_grid(records, here)
                                : analysis::motion_grid(records, here);
  grid.provenance = provenance(records);
  return render_grid(grid, format, table);
}

}  // namespace gnomon
