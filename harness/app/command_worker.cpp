#include "app/app.h"
#include "measure/scene/import.h"

namespace gnomon::app {

void add_worker(Program& program) {
  struct Options {
    int socket = -1, threads = 0, descriptor = -1;
    std::string file;
  };
  auto options = std::make_shared<Options>();
  CLI::App* worker = program.cli.add_subcommand("worker", "Serve one technique to the program that started this")->group("");
  worker->add_option("socket", options->socket)->required();
  worker->add_option("threads", options->threads)->required();
  worker->callback(
      [&program, options] { program.chosen = [options] { return worker_main(options->socket, options->threads); }; });

  CLI::App* import = program.cli.add_subcommand("import-mesh", "Read a mesh file for the program that started this")->group("");
  import->add_option("file", options->file)->required();
  import->add_option("descriptor", options->descriptor)->required();
  import->callback([&program, options] { program.chosen = [options] { return import_child_main(options->file, options->descriptor);
};
}  // namespace gnomon::app
);
}

}  // namespace gnomon::app
