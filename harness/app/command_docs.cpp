#include "app/app.h"
#include "measure/paths.h"
#include "report/pages.h"

namespace gnomon::app {

namespace {

struct Options {
  std::string out;
  bool check = false;
};

int write_docs(const Options& options) {
  const std::filesystem::path dir = options.out.empty() ? data_root() / "docs/techniques" : std::filesystem::path(options.out);
  if (options.check) {
    const std::vector<std::string> stale = stale_pages(dir);
    for (const std::string& page : stale) fmt::print("stale: {}\n", (dir / page).string());
    return stale.empty() ? 0 : 1;
  }
  write_pages(dir);
  fmt::print("{}\n", dir.string());
  return 0;
}

}  // namespace

void add_docs(Program& program) {
  auto [command, options] =
      program.line.command<Options>("docs", "Write docs/techniques from the techniques themselves", write_docs);
  command.flag("--check", &options.check, "Write nothing; exit 1 when a page is stale");
  command.option("--out", &options.out, "Folder of the pages; docs/techniques by default");
}

}  // namespace gnomon::app
