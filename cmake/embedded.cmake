# Texts that become parts of the program.

# The version, for programs and for users' own: from project() in the CMakeLists.txt above.
configure_file(${PROJECT_SOURCE_DIR}/include/heartgen/version.hpp.in ${PROJECT_BINARY_DIR}/include/heartgen/version.hpp @ONLY)
target_include_directories(heartgen_pipeline PRIVATE ${PROJECT_BINARY_DIR}/include)

# The report's script (its files in this order) and style sheet become string constants.
set(web ${PROJECT_SOURCE_DIR}/validation/report/web)
set(REPORT_SCRIPT "")
foreach(name data colors scene draw pick viewer hands panel slices page)
  file(READ ${web}/${name}.js text)
  string(APPEND REPORT_SCRIPT "${text}")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${web}/${name}.js)
endforeach()
file(READ ${web}/report.css REPORT_CSS)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${web}/report.css)
configure_file(${web}/web_assets.hpp.in ${PROJECT_BINARY_DIR}/generated/web_assets.hpp @ONLY)
target_include_directories(heartgen_report PRIVATE ${PROJECT_BINARY_DIR}/generated)

# The decks as they lie in exporters/decks/FORMAT/ become a table.
set(decks_folder ${PROJECT_SOURCE_DIR}/exporters/decks)
file(GLOB_RECURSE decks RELATIVE ${decks_folder} CONFIGURE_DEPENDS ${decks_folder}/*)
foreach(deck ${decks})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${decks_folder}/${deck})
  file(READ ${decks_folder}/${deck} text)
  string(REGEX REPLACE "^([^/]+)/(.*)$" "{\"\\1\", \"\\2\"," place ${deck})
  string(APPEND deck_table "${place} R\"DECK(${text})DECK\"},\n")
endforeach()
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/exporters/deck_files.inc CONTENT "@deck_table@" @ONLY)
target_include_directories(heartgen_exporters PRIVATE ${PROJECT_BINARY_DIR}/generated)
target_include_directories(heartgen_exporters SYSTEM PRIVATE ${HDF5_INCLUDE_DIRS})

# What `heartgen selftest` expects: `heartgen selftest --list > generator/app/selftest_expected.txt` after every change
# of results.
set(expected ${PROJECT_SOURCE_DIR}/generator/app/selftest_expected.txt)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${expected})
file(READ ${expected} selftest_expected)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/selftest_expected.inc CONTENT "R\"LIST(@selftest_expected@)LIST\"" @ONLY)
target_include_directories(heartgen_app PRIVATE ${PROJECT_BINARY_DIR}/generated)

# Found again for their version numbers alone: they go into every bundle's manifest.
find_package(ITK QUIET COMPONENTS ITKCommon)
find_package(VTK QUIET COMPONENTS CommonCore)
find_package(CGAL QUIET)
find_package(Ceres QUIET)
set_source_files_properties(${PROJECT_SOURCE_DIR}/generator/pipeline/versions.cpp TARGET_DIRECTORY heartgen_pipeline
  PROPERTIES COMPILE_DEFINITIONS
  "HEARTGEN_ITK_VERSION=\"${ITK_VERSION}\";HEARTGEN_VTK_VERSION=\"${VTK_VERSION}\";HEARTGEN_CGAL_VERSION=\"${CGAL_VERSION}\";HEARTGEN_CERES_VERSION=\"${CERES_VERSION}\";HEARTGEN_HDF5_VERSION=\"${HDF5_VERSION}\"")
