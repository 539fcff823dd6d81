# `make deb`: Debian packages by CPack. The manual and the completion are made from what --help is made of.
add_executable(heartgen_manual EXCLUDE_FROM_ALL packaging/manual.cpp)
target_link_libraries(heartgen_manual PRIVATE heartgen_app CLI11::CLI11 fmt::fmt)
set(manual ${PROJECT_BINARY_DIR}/manual)
add_custom_command(OUTPUT ${manual}/completions/heartgen DEPENDS heartgen_manual heartgen-tetgen
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${manual}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${manual}/man ${manual}/completions
  COMMAND $<TARGET_FILE:heartgen-tetgen> --help > ${manual}/tetgen_help.txt
  COMMAND heartgen_manual ${manual} ${manual}/tetgen_help.txt
  COMMAND gzip -9n ${manual}/man/*.1
  COMMENT "Manual from the help")
add_custom_target(manual ALL DEPENDS ${manual}/completions/heartgen)
install(DIRECTORY ${manual}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program OPTIONAL)
install(FILES ${manual}/completions/heartgen DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  COMPONENT program OPTIONAL)

# `make docs`: what the recipe reference is made of.
add_executable(heartgen_default_recipe EXCLUDE_FROM_ALL docs/site/default_recipe.cpp)
target_link_libraries(heartgen_default_recipe PRIVATE heartgen_model)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME heartgen)
set(CPACK_PACKAGE_VENDOR "heartgen")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGE_CONTACT "The heartgen developers <heartgen@example.org>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program runtime dev)
if(TARGET heartgen_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/packaging/prepare_deb.cmake)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
# New libraries are found from then on.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/triggers)
set(exactly "(= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")

# heartgen_deb(COMPONENT PACKAGE SECTION section DEPENDS "..." ONE "first line of the description" MORE "the rest")
function(heartgen_deb component package)
  cmake_parse_arguments(deb "" "SECTION;DEPENDS;SUGGESTS;ONE;MORE" "" ${ARGN})
  string(TOUPPER ${component} part)
  set(CPACK_DEBIAN_${part}_PACKAGE_NAME ${package} PARENT_SCOPE)
  set(CPACK_DEBIAN_${part}_PACKAGE_SECTION ${deb_SECTION} PARENT_SCOPE)
  set(CPACK_DEBIAN_${part}_PACKAGE_DEPENDS "${deb_DEPENDS}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${part}_PACKAGE_SUGGESTS "${deb_SUGGESTS}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${part}_DESCRIPTION "${deb_ONE}\n${deb_MORE}" PARENT_SCOPE)
endfunction()
heartgen_deb(program heartgen SECTION science
  ONE "simulation-ready heart models from a CT"
  MORE "From a contrast-enhanced CT, or a segmentation of it, to tetrahedral meshes of\nthe heart with fibres, labelled surfaces and a certificate of quality, exports\nfor solvers of electrophysiology, mechanics and flow.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "openmpi-bin")
heartgen_deb(runtime libheartgen${soversion} SECTION libs
  ONE "heart models from a CT: shared library"
  MORE "The functions of heartgen as a library: filters by partial differential\nequations, segmentation, meshes of label maps, fibres, checks and exports.")
heartgen_deb(dev libheartgen-dev SECTION libdevel DEPENDS "libheartgen${soversion} ${exactly}"
  ONE "heart models from a CT: headers"
  MORE "The functions of heartgen as a library: headers, files for CMake and\npkg-config, and examples.")
heartgen_deb(python python3-heartgen SECTION python
  DEPENDS "libheartgen${soversion} ${exactly}, ${HEARTGEN_PYTHONS}, python3-numpy"
  SUGGESTS "python3-meshio, python3-vtk9, python3-dolfinx"
  ONE "heart models from a CT: Python module"
  MORE "import heartgen: bundles and meshes as arrays without copies, filters and\nsegmentation on arrays, meshes of label maps, fibres, checks and exports.")
include(CPack)
