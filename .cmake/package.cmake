# SPDX-License-Identifier: MIT
# A Debian package, made by cpack in the build folder. Included by CMakeLists.txt at top level.

# The project has no address of its own for mail. Whoever distributes the package gives theirs.
set(SILT_PACKAGE_CONTACT "The Silt authors <maintainers@silt.invalid>" CACHE STRING
  "Maintainer of the Debian package")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME libsilt-dev)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_VENDOR "The Silt authors")
set(CPACK_PACKAGE_CONTACT ${SILT_PACKAGE_CONTACT})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "particle methods in C++20: granular and free-surface flow")
set(CPACK_PACKAGE_DESCRIPTION "\
Header-only C++20 library of templated particle methods in 2D and 3D: the
discrete element method (DEM) for granular flow, and the moving particle
semi-implicit method (MPS) for incompressible flow with a free surface.
.
A simulation consists of particles, a neighbour search, an interaction and an
integrator; each of them can be user-defined.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE
  GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4)")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "cmake (>= 3.24), pkg-config, libopenmpi-dev, libtrilinos-zoltan-dev, libhypre-dev")

# Debian's policy asks for these two files.
set(folder ${PROJECT_BINARY_DIR}/package)
file(READ LICENSE licence)
string(REGEX MATCH "Copyright \\(c\\) ([^\n]*)\n\n(.*)" found "${licence}")
set(holders ${CMAKE_MATCH_1})
string(STRIP "${CMAKE_MATCH_2}" terms)
string(REPLACE "\n\n" "\n.\n" terms "${terms}")
string(REPLACE "\n" "\n " terms "${terms}")
file(CONFIGURE OUTPUT ${folder}/copyright @ONLY CONTENT "\
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: Silt

Files: *
Copyright: ${holders}
License: Expat
 ${terms}
")
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(CONFIGURE OUTPUT ${folder}/changelog @ONLY CONTENT "\
silt (${PROJECT_VERSION}) unstable; urgency=medium

  * See docs/changelog.md of the sources.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
file(ARCHIVE_CREATE OUTPUT ${folder}/changelog.gz PATHS ${folder}/changelog FORMAT raw
  COMPRESSION GZip COMPRESSION_LEVEL 9)
install(FILES ${folder}/copyright ${folder}/changelog.gz
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_PACKAGE_NAME}
  COMPONENT debian EXCLUDE_FROM_ALL)
set(CPACK_INSTALL_CMAKE_PROJECTS
  "${PROJECT_BINARY_DIR};silt;Unspecified;/;${PROJECT_BINARY_DIR};silt;debian;/")

include(CPack)
