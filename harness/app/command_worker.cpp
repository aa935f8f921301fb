#include "app/app.h"
#include "measure/scene/import.h"

namespace gnomon::app {

namespace {

struct ServeOptions {
  int socket = -1, threads = 0;
};
struct ImportOptions {
  std::string file;
  int descriptor = -1;
};

int serve(const ServeOptions& options) { return worker_main(options.socket, options.threads); }
int import_mesh(const ImportOptions& options) { return import_child_main(options.file, options.descriptor); }

}  // namespace

void add_worker(Program& program) {
  auto [worker, to_serve] =
      program.line.command<ServeOptions>("worker", "Serve one technique to the program that started this", serve);
  worker.hide();
  worker.option("socket", &to_serve.socket).required();
  worker.option("threads", &to_serve.threads).required();

  auto [mesh, to_import] =
      program.line.command<ImportOptions>("import-mesh", "Read a mesh file for the program that started this", import_mesh);
  mesh.hide();
  mesh.option("file", &to_import.file).required();
  mesh.option("descriptor", &to_import.descriptor).required();
}

}  // namespace gnomon::app
