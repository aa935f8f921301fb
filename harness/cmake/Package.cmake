# `cpack -G DEB` in the build folder: one package with the program and with what plugins are built against.
set(CPACK_PACKAGE_NAME gnomon)
set(CPACK_PACKAGE_VENDOR "The Gnomon project")
set(CPACK_PACKAGE_CONTACT "The Gnomon project <gnomon@gnomon.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "comparative testbed of shadow techniques")
set(CPACK_PACKAGE_DESCRIPTION "Gnomon measures what shadow techniques cost and where each one is wrong, pixel by pixel,
against a ray-traced reference that is itself certified by an exact oracle.
With it come the headers, libraries and CMake functions that techniques
outside of it are built with.")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES OFF)  # stripped of their symbols, the static libraries link nothing
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
# Libraries that are linked are found by dpkg-shlibdeps; the rest is opened when it is needed: OpenGL without a display and the
# font of legends. What builds plugins, draws figures and unpacks fetched scenes is recommended.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${PROJECT_BINARY_DIR}")
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libegl1, libgl1, libgl1-mesa-dri, fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "g++, cmake, ninja-build | make, pkg-config, libglm-dev, libfmt-dev, libembree-dev, libtbb-dev, libassimp-dev, nlohmann-json3-dev, libtomlplusplus-dev, libcli11-dev, zlib1g-dev, libbenchmark-dev, libxxhash-dev, libgmp-dev, libboost-dev, libpng-dev, libopenexr-dev, libfreetype-dev, libopenimageio-dev, libepoxy-dev, libegl-dev, libglfw3-dev, libimgui-dev, libcmark-gfm-dev, libcmark-gfm-extensions-dev, python3-numpy, unzip, gnuplot-nox")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "npm")
include(CPack)
