#include "measure/images/image_files.h"

#include <dlfcn.h>

namespace gnomon {

const ImageFiles& image_files() {
  static const ImageFiles& files = []() -> const ImageFiles& {
    // Found by the program's own search path, beside the kit.
    void* module = dlopen("libgnomon_images.so", RTLD_NOW | RTLD_LOCAL);
    if (!module) throw Error("the image module cannot be loaded: {}", dlerror());
    return *static_cast<const ImageFiles*>(dlsym(module, "gnomon_image_files"));
  }();
  return files;
}

std::vector<float> read_exr(const std::filesystem::path& path, const std::string& channel, int width, int height) {
  return image_files().read_exr(path, channel, width, height);
}

}  // namespace gnomon
