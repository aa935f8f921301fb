# The page that `gnomon report` fills: report/html/web bundled into one template, which becomes a source file of gnomon_report. The
# scripts and the style of `gnomon site`, from report/site/web, become another one.
option(GNOMON_REPORT "Build the pages of `gnomon report` and `gnomon site`; needs npm, and the network once" ON)

set(web ${CMAKE_CURRENT_SOURCE_DIR}/report/html/web)
set(site_web ${CMAKE_CURRENT_SOURCE_DIR}/report/site/web)
set(page_dir ${PROJECT_BINARY_DIR}/report_page)
set(instead "configure with -DGNOMON_REPORT=OFF to build the program without it: all but `gnomon report` and `gnomon site` works then")

if(NOT GNOMON_REPORT)
  target_sources(gnomon_report PRIVATE ${web}/no_page.cpp ${site_web}/no_site.cpp)
  return()
endif()

find_program(GNOMON_NODE NAMES node nodejs)
find_program(GNOMON_NPM npm)
mark_as_advanced(GNOMON_NODE GNOMON_NPM)
if(NOT GNOMON_NODE OR NOT GNOMON_NPM)
  message(FATAL_ERROR "The report's page needs Node.js and npm (Debian: nodejs npm). Install them with scripts/setup, or ${instead}.")
endif()

# Packages in the versions of the lock file, installed into the build folder when the lists of packages have changed.
set(without "")
if(NOT GNOMON_TESTS)
  set(without --omit=dev)  # what drives the browser in tests
endif()
set(lists ${web}/package.json ${web}/package-lock.json)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${lists})
set(wanted "${without}")
foreach(list IN LISTS lists)
  file(SHA256 ${list} hash)
  string(APPEND wanted " ${hash}")
endforeach()
set(stamp ${page_dir}/installed)
set(installed "")
if(EXISTS ${stamp})
  file(READ ${stamp} installed)
endif()
if(NOT installed STREQUAL wanted)
  message(STATUS "Installing the packages of the report's page")
  file(REMOVE ${stamp})
  file(COPY ${lists} DESTINATION ${page_dir})
  execute_process(
    COMMAND ${GNOMON_NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline --fetch-retries=1 --fetch-retry-mintimeout=1000 ${without}
    WORKING_DIRECTORY ${page_dir} RESULT_VARIABLE status OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "The packages of the report's page could not be installed (npm ci: ${status}). Without a network, ${instead}. npm says:\n${said}")
  endif()
  file(WRITE ${stamp} "${wanted}")
endif()

file(GLOB web_files CONFIGURE_DEPENDS ${web}/*.js ${web}/*.css ${web}/*.html)
add_custom_command(OUTPUT ${page_dir}/page.cpp
  COMMAND ${GNOMON_NODE} ${web}/bundle.js ${page_dir}/node_modules ${page_dir}/page.cpp
  DEPENDS ${web_files} ${stamp}
  COMMENT "Bundling the report's page" VERBATIM)
file(GLOB site_files CONFIGURE_DEPENDS ${site_web}/*.js ${site_web}/*.mjs ${site_web}/*.css)
add_custom_command(OUTPUT ${page_dir}/site.cpp
  COMMAND ${GNOMON_NODE} ${site_web}/bundle.mjs ${page_dir}/node_modules ${page_dir}/site.cpp
  DEPENDS ${site_files} ${web_files} ${stamp}
  COMMENT "Bundling the scripts of the site" VERBATIM)
target_sources(gnomon_report PRIVATE ${page_dir}/page.cpp ${page_dir}/site.cpp)
set_source_files_properties(${page_dir}/page.cpp ${page_dir}/site.cpp PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
