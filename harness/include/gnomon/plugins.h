#pragma once
#include <string>
#include <vector>

namespace gnomon {

/// A plugin that this process has loaded, and what it says of how it was built; empty where it does not.
struct PluginFacts {
  std::string path;  ///< as given: the origin of its techniques
  std::string file;  ///< to be opened: a bare name is a file here
  std::string build_type, flags, compiler;
  bool is_optimized = true;
};

/// Those that were loaded, in order; in the program itself those of which a worker told.
const std::vector<PluginFacts>& loaded_plugins();
void note_plugin(PluginFacts facts);

}  // namespace gnomon
