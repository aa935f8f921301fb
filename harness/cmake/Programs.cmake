# Techniques that are programs of their own: techniques/ID.toml, with its files in techniques/ID.
option(GNOMON_ENGINES "Build the renderers of engines whose libraries are there" ON)

# gnomon_add_renderer(ID libraries...): the program gnomon_ID beside `gnomon`, between an engine's library and its adapter in
# Python, of the .cpp files in techniques/ID; techniques/renderers has what such programs share. Libraries are targets; where one is missing, the technique says what to install.
# No package has it: it would need the engine. `cmake --install BUILD --component engines` installs it.
function(gnomon_add_renderer id)
  file(GLOB sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/techniques/${id}/*.cpp")
  if(NOT sources OR NOT GNOMON_ENGINES OR GNOMON_SANITIZE)
    return()
  endif()
  foreach(library IN LISTS ARGN)
    if(NOT TARGET ${library})
      return()
    endif()
  endforeach()
  add_executable(gnomon_${id} ${sources})
  target_include_directories(gnomon_${id} PRIVATE ${PROJECT_SOURCE_DIR}/techniques/renderers)
  target_compile_definitions(gnomon_${id} PRIVATE ENGINE_VERSION="${${id}_VERSION}")
  target_link_libraries(gnomon_${id} PRIVATE ${ARGN} nlohmann_json::nlohmann_json)
  install(TARGETS gnomon_${id} COMPONENT engines EXCLUDE_FROM_ALL)
endfunction()

# gnomon_install_programs(FOLDER DESTINATION): the programs of a folder, without sources and what npm has put there. Their folders are
# those that have their id, and those that their commands lead into, which several may share.
function(gnomon_install_programs folder destination)
  file(GLOB descriptions CONFIGURE_DEPENDS "${folder}/*.toml")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${descriptions})
  install(FILES ${descriptions} DESTINATION ${destination})
  foreach(description IN LISTS descriptions)
    get_filename_component(id "${description}" NAME_WE)
    list(APPEND ids "${id}")
    file(STRINGS "${description}" command REGEX "^command = ")
    string(REGEX MATCHALL "\"[a-z0-9_]+/" words "${command}")
    string(REGEX REPLACE "[\"/]" "" words "${words}")
    list(APPEND ids ${words})
  endforeach()
  list(REMOVE_DUPLICATES ids)
  foreach(id IN LISTS ids)
    if(IS_DIRECTORY "${PROJECT_SOURCE_DIR}/${folder}/${id}")
      install(DIRECTORY ${folder}/${id} DESTINATION ${destination} PATTERN "*.cpp" EXCLUDE PATTERN "*.h" EXCLUDE
              PATTERN "node_modules" EXCLUDE PATTERN ".gitignore" EXCLUDE PATTERN "__pycache__" EXCLUDE)
    endif()
  endforeach()
endfunction()
