#include "app/app.h"
#include "measure/scene/import.h"

namespace gnomon::app {

void add_worker(Program& program) {
  struct Options {
    int socket = -1, threads = 0, descriptor = -1;
    std::string file;
  };
  auto options = std::make_shared<Options>();
  Command worker = program.line.command("worker", "Serve one technique to the program that started this").hide();
  worker.option("socket", &options->socket).required();
  worker.option("threads", &options->threads).required();
  worker.action([options] { return worker_main(options->socket, options->threads); });

  Command import = program.line.command("import-mesh", "Read a mesh file for the program that started this").hide();
  import.option("file", &options->file).required();
  import.option("descriptor", &options->descriptor).required();
  import.action([options] { return import_child_main(options->file, options->descriptor);
});
}  // namespace gnomon::app

}  // namespace gnomon::app
