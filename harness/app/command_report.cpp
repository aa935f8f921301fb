#include "app/app.h"
#include "measure/scene/blob.h"
#include "report/html/html.h"

namespace gnomon::app {

namespace {

struct Options {
  std::string dir, out;
  bool without_pictures = false;
};

void make_page(const Options& options) {
  const std::filesystem::path out =
      options.out.empty() ? std::filesystem::path(options.dir) / "report.html" : std::filesystem::path(options.out);
  if (std::filesystem::is_directory(out)) throw Error("--out {} is a folder; the name of a file is wanted", out.string());
  const std::vector<Record> records = read_records(options.dir);
  const Report report = make_report(options.dir, records, {.with_pictures = !options.without_pictures});
  write_file(out, report.html);
  for (const std::string& note : report.notes) fmt::print(stderr, "{}\n", note);
  fmt::print("{}\n", out.string());
}

}  // namespace

void add_report(Program& program) {
  auto [command, options] =
      program.line.command<Options>("report", "One HTML page of a run: table, plots and pictures to compare", make_page);
  command.option("dir", &options.dir, "Folder of the run").required();
  command.option("--out", &options.out, "The page; report.html in the run's folder unless given").type_name("FILE");
  command.flag("--no-pictures", &options.without_pictures, "Leave out the pictures: a small page without the comparer");
}

}  // namespace gnomon::app
