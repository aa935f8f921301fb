# Vulkan, where its headers and the compiler of shaders are there. Nothing is linked: the loader is opened by name when a row asks
# for it. Without, everything builds all the same, and rows of techniques that need Vulkan say what was missing. Sanitizers would find
# the leaks of drivers.
option(GNOMON_VULKAN "Build with Vulkan where libvulkan-dev and glslang-tools are there" ON)
pkg_check_modules(vulkan_headers QUIET vulkan>=1.2.162)  # the first with rays
find_program(GNOMON_GLSLANG glslangValidator)
mark_as_advanced(GNOMON_GLSLANG)
set(GNOMON_HAS_VULKAN OFF)
if(GNOMON_VULKAN AND vulkan_headers_FOUND AND GNOMON_GLSLANG AND NOT GNOMON_SANITIZE)
  set(GNOMON_HAS_VULKAN ON)
endif()

# gnomon_use_vulkan(files...): they call Vulkan where that is there; else they are compiled without GNOMON_VULKAN.
function(gnomon_use_vulkan)
  if(GNOMON_HAS_VULKAN)
    set(folders "${PROJECT_BINARY_DIR}/shaders" ${vulkan_headers_INCLUDE_DIRS})
    set_source_files_properties(${ARGN} PROPERTIES COMPILE_DEFINITIONS GNOMON_VULKAN INCLUDE_DIRECTORIES "${folders}")
  endif()
endfunction()

# gnomon_add_shaders(TARGET FOLDER files...): shaders become the headers FOLDER/NAME.STAGE.h with the array NAME_STAGE of words of
# SPIR-V, for files of the target that gnomon_use_vulkan names.
function(gnomon_add_shaders target folder)
  if(NOT GNOMON_HAS_VULKAN)
    return()
  endif()
  set(out "${PROJECT_BINARY_DIR}/shaders/${folder}")
  file(MAKE_DIRECTORY "${out}")
  foreach(shader IN LISTS ARGN)
    get_filename_component(name "${shader}" NAME)
    get_filename_component(at "${shader}" DIRECTORY)
    file(GLOB included CONFIGURE_DEPENDS "${at}/*.glsl")
    string(REPLACE "." "_" array "${name}")
    add_custom_command(OUTPUT "${out}/${name}.h"
      COMMAND ${GNOMON_GLSLANG} --quiet --target-env vulkan1.2 "-I${at}" --vn ${array} -o "${out}/${name}.h" "${shader}"
      DEPENDS "${shader}" ${included} VERBATIM)
    target_sources(${target} PRIVATE "${out}/${name}.h")
  endforeach()
endfunction()
