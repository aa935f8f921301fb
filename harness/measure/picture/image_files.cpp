#include "measure/picture/image_files.h"

#include <dlfcn.h>
#include <gnomon/error.h>

namespace gnomon {

const ImageFiles& image_files() {
  static const ImageFiles& files = [&]() -> const ImageFiles& {
    // Found by the program's own search path, beside the kit.
    void* module = dlopen("libgnomon_images.so", RTLD_NOW | RTLD_LOCAL);
    if (!module) throw Error("the image module cannot be loaded: {}", dlerror());
    return *static_cast<const ImageFiles*>(dlsym(module, "gnomon_image_files"));
  }();
  return files;
}

}  // namespace gnomon
