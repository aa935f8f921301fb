// Of the program only what the importer starts: enough for the unit tests of what reads files, where the program is not built.
#include <cstdio>
#include <cstring>
#include <string>

#include "measure/scene/import.h"

int main(int argc, char** argv) {
  if (argc == 4 && std::strcmp(argv[1], "import-mesh") == 0) return gnomon::import_child_main(argv[2], std::stoi(argv[3]));
  std::fprintf(stderr, "gnomon: of the program only import-mesh is here\n");
  return 2;
}
