#include "app/app.h"
#include "report/table.h"

namespace gnomon::app {

void add_table(Program& program) {
  struct Options {
    std::string dir, format = "terminal";
    TableOptions table;
  };
  CLI::App* command = program.cli.add_subcommand("table", "The comparison table of a run, in any format, on stdout");
  auto options = std::make_shared<Options>();
  command->add_option("dir", options->dir, "Folder of the run")->required();
  command->add_option("--format", options->format, "terminal, md, csv, tex or json")->capture_default_str();
  command->add_option("--columns", options->table.columns, "Names of columns in their order; 'list' prints them all")
      ->delimiter(',');
  command->add_option("--caption", options->table.caption, "Caption of the LaTeX table");
  command->callback([&program, options] {
    program.chosen = [options] {
      const Format format = format_named(options->format);
      const std::vector<Record> records = read_records(options->dir);
      if (options->table.columns == std::vector<std::string>{"list"}) {
        for (const std::string& name : column_names(records)) fmt::print("{}\n", name);
        return 0;
      }
      options->table.width = terminal_width();
      fmt::print("{}", render_table(records, format, options->table));
      return 0;
    };
  });
}

}  // namespace gnomon::app
