# libheartgen: the public functions of include/heartgen in one shared library, and how it is installed.
if(CMAKE_LIBRARY_ARCHITECTURE AND NOT CMAKE_INSTALL_LIBDIR)
  set(CMAKE_INSTALL_LIBDIR lib/${CMAKE_LIBRARY_ARCHITECTURE})  # where Debian looks, below any prefix
endif()
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Before 1.0.0 a new minor version may change the interface: it is a part of the soname.
set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

# Rooms whose own headers the public ones show: every function of them is in the library. Of the others, what these need.
set(shown model parallel image pde landmarks mesh_files atlas fibers tetmesh mesh validation exporters phantom pipeline library)
list(TRANSFORM shown REPLACE "(.+)" "$<TARGET_OBJECTS:heartgen_\\1>" OUTPUT_VARIABLE shown_objects)
add_library(heartgen_shared SHARED ${shown_objects} $<TARGET_OBJECTS:heartgen_itk>)
set_target_properties(heartgen_shared PROPERTIES
  OUTPUT_NAME heartgen EXPORT_NAME heartgen VERSION ${PROJECT_VERSION} SOVERSION ${soversion} LINKER_LANGUAGE CXX
  LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/libheartgen.map)
target_compile_features(heartgen_shared INTERFACE cxx_std_20)
target_include_directories(heartgen_shared INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
  $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>)
target_link_libraries(heartgen_shared PRIVATE heartgen_library)
# What is not heartgen's own stays inside: templates of other libraries, and the mathematics under the C library's names,
# which a program may want to take from elsewhere.
target_link_options(heartgen_shared PRIVATE -Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/libheartgen.map -Wl,--no-undefined)

# ---- program ----
install(TARGETS heartgen heartgen-tetgen RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(FILES LICENSE README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY datasets/recipes DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)

# ---- library and what programs are built with ----
install(TARGETS heartgen_shared EXPORT heartgen
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT dev)
install(EXPORT heartgen FILE heartgenTargets.cmake NAMESPACE heartgen::
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/heartgen COMPONENT dev)
configure_package_config_file(cmake/heartgenConfig.cmake.in ${PROJECT_BINARY_DIR}/heartgenConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/heartgen)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/heartgenConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/heartgenConfig.cmake ${PROJECT_BINARY_DIR}/heartgenConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/heartgen COMPONENT dev)
file(RELATIVE_PATH prefix_from_pc /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(cmake/heartgen.pc.in ${PROJECT_BINARY_DIR}/heartgen.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/heartgen.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT dev)
# The public headers, and below heartgen/ those of ours that they show.
install(CODE "set(source \"${PROJECT_SOURCE_DIR}\")\nset(binary \"${PROJECT_BINARY_DIR}\")\nset(folder \"${CMAKE_INSTALL_INCLUDEDIR}\")"
  COMPONENT dev)
install(SCRIPT cmake/install_headers.cmake COMPONENT dev)
