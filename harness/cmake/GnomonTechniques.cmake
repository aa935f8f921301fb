# The roll-call: one C-linkage function per technique and scene file, called in alphabetical order from one generated source.
# It survives static libraries, the order is fixed, and a wrong stem is a link error that names it.

# gnomon_write_roll(PATH FUNCTION TECHNIQUES SCENES [FACTS]): writes PATH, which defines `void FUNCTION(gnomon::Registry&)`;
# TECHNIQUES and SCENES are lists of files. FACTS are lines of C++ more.
function(gnomon_write_roll path function techniques scenes)
  set(declarations "")
  set(calls "")
  foreach(kind technique scene)
    set(files "${${kind}s}")
    list(SORT files)
    foreach(file IN LISTS files)
      get_filename_component(stem "${file}" NAME_WE)
      string(APPEND declarations "extern \"C\" void gnomon_${kind}_${stem}(gnomon::Registry&);\n")
      string(APPEND calls "  gnomon_${kind}_${stem}(registry);\n")
    endforeach()
  endforeach()
  file(GENERATE OUTPUT "${path}" CONTENT
"// Written by the build from the names of the files in techniques/ and scenes/.
#include <gnomon/registry.h>
${declarations}
extern \"C\" const int gnomon_plugin_abi = gnomon::abi_version;
${ARGN}extern \"C\" void ${function}([[maybe_unused]] gnomon::Registry& registry) {
${calls}}
")
endfunction()

# gnomon_default_flags(NAME): where neither build type nor flags of the project choose an optimization, the target gets the
# program's own; an installed package stores it. Without it CMake compiles without any.
function(gnomon_default_flags name)
  if(GNOMON_BUILD_FLAGS AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES AND NOT CMAKE_CXX_FLAGS MATCHES "(^| )-O")
    separate_arguments(flags NATIVE_COMMAND "${GNOMON_BUILD_FLAGS}")
    target_compile_options(${name} PRIVATE ${flags})
  endif()
endfunction()

# gnomon_write_build_facts(NAME PATH): a header with the build type and the flags of a target.
function(gnomon_write_build_facts name path)
  set(flags "${CMAKE_CXX_FLAGS}")
  foreach(config IN LISTS CMAKE_BUILD_TYPE CMAKE_CONFIGURATION_TYPES)
    string(TOUPPER "${config}" upper)
    string(APPEND flags "$<$<CONFIG:${config}>: ${CMAKE_CXX_FLAGS_${upper}}>")
  endforeach()
  set(type "$<CONFIG>")
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(type "${GNOMON_BUILD_TYPE}")
    if(NOT GNOMON_BUILD_FLAGS OR CMAKE_CXX_FLAGS MATCHES "(^| )-O")
      set(type "")
    endif()
  endif()
  file(GENERATE OUTPUT "${path}" CONTENT
"#define GNOMON_PLUGIN_BUILD_TYPE R\"gnomon(${type})gnomon\"
#define GNOMON_PLUGIN_FLAGS R\"gnomon(${flags} $<JOIN:$<TARGET_PROPERTY:${name},COMPILE_OPTIONS>, >)gnomon\"
")
endfunction()

# gnomon_find_helpers(OUT files...): the .cpp files in the private folders of techniques and scenes: of techniques/ID.cpp those in
# techniques/ID.
function(gnomon_find_helpers out)
  set(helpers "")
  foreach(file IN LISTS ARGN)
    get_filename_component(folder "${file}" DIRECTORY)
    get_filename_component(stem "${file}" NAME_WE)
    file(GLOB found CONFIGURE_DEPENDS "${folder}/${stem}/*.cpp")
    list(APPEND helpers ${found})
  endforeach()
  set(${out} "${helpers}" PARENT_SCOPE)
endfunction()

# gnomon_add_program(NAME TECHNIQUES files... SCENES files...): the testbed with these techniques and scenes built in.
function(gnomon_add_program name)
  cmake_parse_arguments(arg "" "" "TECHNIQUES;SCENES" ${ARGN})
  set(roll "${CMAKE_CURRENT_BINARY_DIR}/${name}_roll.cpp")
  gnomon_write_roll("${roll}" gnomon_roll_call "${arg_TECHNIQUES}" "${arg_SCENES}")
  gnomon_find_helpers(helpers ${arg_TECHNIQUES} ${arg_SCENES})
  add_library(${name}_content OBJECT "${roll}" ${arg_TECHNIQUES} ${arg_SCENES} ${helpers})
  target_link_libraries(${name}_content PUBLIC gnomon::gnomon)
  gnomon_default_flags(${name}_content)
  target_compile_options(${name}_content PRIVATE -fno-semantic-interposition)  # what is called within a file may be put into its caller
  get_target_property(kit gnomon::gnomon ALIASED_TARGET)
  if(kit)  # in the project itself; an installed kit has none
    target_precompile_headers(${name}_content REUSE_FROM ${kit})
  else()
    target_precompile_headers(${name}_content PRIVATE <gnomon/registry.h> <algorithm>)
  endif()
  add_executable(${name} "${GNOMON_MAIN}")
  gnomon_default_flags(${name})
  target_link_libraries(${name} PRIVATE ${name}_content gnomon::app)
endfunction()

# gnomon_add_program_from(NAME TECHNIQUES_FOLDER SCENES_FOLDER): all .cpp files of the two folders. A file that comes or goes is
# seen at the next build: nothing else is edited.
function(gnomon_add_program_from name techniques scenes)
  get_filename_component(techniques "${techniques}" ABSOLUTE)
  get_filename_component(scenes "${scenes}" ABSOLUTE)
  file(GLOB technique_files CONFIGURE_DEPENDS "${techniques}/*.cpp")
  file(GLOB scene_files CONFIGURE_DEPENDS "${scenes}/*.cpp")
  gnomon_add_program(${name} TECHNIQUES ${technique_files} SCENES ${scene_files})
endfunction()

# gnomon_add_plugin(NAME files...): the same files as a plugin for `gnomon run --plugin NAME.so`. All are techniques. It says how it
# was built: records of its rows have that beside what they say of the program. And of which files: `gnomon pack` reads that.
function(gnomon_add_plugin name)
  set(files "")
  foreach(file IN LISTS ARGN)
    get_filename_component(absolute "${file}" ABSOLUTE)
    list(APPEND files "${absolute}")
  endforeach()
  set(roll "${CMAKE_CURRENT_BINARY_DIR}/${name}_roll.cpp")
  set(facts "${CMAKE_CURRENT_BINARY_DIR}/${name}_build")
  gnomon_find_helpers(helpers ${files})
  string(JOIN "\n" sources "gnomon plugin sources:" ${files} "" ${helpers} "${CMAKE_CURRENT_SOURCE_DIR}/CMakeLists.txt" "")
  gnomon_write_roll("${roll}" gnomon_plugin_roll_call "${files}" "" "#include \"build_CXX.h\"
extern \"C\" const char gnomon_plugin_build_type[] = GNOMON_PLUGIN_BUILD_TYPE, gnomon_plugin_flags[] = GNOMON_PLUGIN_FLAGS;
extern \"C\" const char gnomon_plugin_sources[] = R\"gnomon(${sources})gnomon\";
#ifdef __clang__
extern \"C\" const char gnomon_plugin_compiler[] = __VERSION__;
#else
extern \"C\" const char gnomon_plugin_compiler[] = \"g++ \" __VERSION__;
#endif
#ifdef __OPTIMIZE__
extern \"C\" const bool gnomon_plugin_is_optimized = true;
#else
extern \"C\" const bool gnomon_plugin_is_optimized = false;
#endif
")
  set_source_files_properties("${roll}" PROPERTIES INCLUDE_DIRECTORIES "${facts}/$<CONFIG>")
  add_library(${name} MODULE "${roll}" ${files} ${helpers})
  set_target_properties(${name} PROPERTIES PREFIX "")
  target_link_libraries(${name} PRIVATE gnomon::gnomon)
  get_target_property(kit gnomon::gnomon ALIASED_TARGET)
  if(kit)  # in the project itself
    target_precompile_headers(${name} REUSE_FROM ${kit})
  endif()
  gnomon_default_flags(${name})
  gnomon_write_build_facts(${name} "${facts}/$<CONFIG>/build_$<COMPILE_LANGUAGE>.h")
endfunction()
