# The rooms of the house, lower floors first, and every arrow between them.
find_package(CLI11 REQUIRED)
find_package(Eigen3 REQUIRED)
find_package(LibArchive REQUIRED)
find_package(MPI REQUIRED COMPONENTS C)
find_package(HDF5 REQUIRED COMPONENTS C)
find_package(nanoflann REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(OpenSSL REQUIRED)
find_package(PNG REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(ZLIB REQUIRED)
find_library(TETGEN_LIBRARY tet REQUIRED)
find_path(TETGEN_INCLUDE tetgen.h REQUIRED)
set(json nlohmann_json::nlohmann_json)

heartgen_room(model FOLDER model
  SENTENCE "Plain data, the recipe and the mathematics that all machines share"
  LIBRARIES fmt::fmt ${json} sleef tomlplusplus::tomlplusplus)
heartgen_room(mesh_queries FOLDER model/mesh_queries
  SENTENCE "Questions to a mesh that others made: nearest faces, edges, feature curves, Laplace's equation"
  DEPENDS model LIBRARIES fmt::fmt)
heartgen_room(parallel FOLDER generator/parallel
  SENTENCE "Threads, vector instructions and the only MPI code: slabs, halo exchange, ordered reductions"
  DEPENDS model LIBRARIES MPI::MPI_C Threads::Threads fmt::fmt)
heartgen_room(adapters PARTS FOLDER generator/adapters
  SENTENCE "Foreign libraries behind free functions on plain types"
  DEPENDS model mesh_queries)
heartgen_room(tetgen_helper FOLDER generator/tetgen_helper
  SENTENCE "TetGen at work in a program of its own: the only part under the AGPL"
  DEPENDS model adapters LIBRARIES ${TETGEN_LIBRARY} fmt::fmt)
heartgen_room(image FOLDER generator/image
  SENTENCE "Distances, morphology, components and statistics of voxels"
  DEPENDS model parallel LIBRARIES fmt::fmt)
heartgen_room(pde FOLDER generator/pde
  SENTENCE "Filters, two-phase segmentation, snakes and level sets by partial differential equations"
  DEPENDS model parallel image LIBRARIES fmt::fmt)
heartgen_vectorise(pde generator/pde
  row_kernels.cpp flow_kernels.cpp curvature.cpp redistance.cpp fast_sweeping.cpp level_set_motion.cpp)
heartgen_room(anatomy FOLDER generator/anatomy
  SENTENCE "What a chest CT holds: blood, chambers, walls, body, airways and vessels"
  DEPENDS model mesh_queries parallel image pde LIBRARIES fmt::fmt)
heartgen_room(chest FOLDER generator/chest
  SENTENCE "What surrounds the heart: lungs, the room between them, spine and trachea"
  DEPENDS model parallel image LIBRARIES fmt::fmt)
heartgen_room(naming FOLDER generator/naming
  SENTENCE "Which piece of blood is which part of the heart: one labelling of all pieces at once"
  DEPENDS model parallel image chest LIBRARIES fmt::fmt)
heartgen_room(landmarks FOLDER generator/landmarks
  SENTENCE "Seeds, valve planes and the long axis found in a contrast-enhanced CT"
  DEPENDS model parallel image anatomy chest naming LIBRARIES fmt::fmt)
heartgen_room(labels FOLDER generator/labels
  SENTENCE "Label maps from elsewhere: numberings, names, repair, and what they replace"
  DEPENDS model parallel adapters image LIBRARIES heartgen_itk heartgen_ceres ${json} fmt::fmt)
heartgen_room(painting FOLDER generator/painting
  SENTENCE "Regions of the user's own, label images and closed surfaces, painted onto the cells of a mesh"
  DEPENDS model parallel adapters LIBRARIES heartgen_itk heartgen_vtk fmt::fmt)
heartgen_room(mesh_files FOLDER generator/mesh_files
  SENTENCE "Anybody's tetrahedral meshes, read into one structure"
  DEPENDS model adapters LIBRARIES heartgen_vtk fmt::fmt)
heartgen_room(ventricles FOLDER generator/ventricles
  SENTENCE "Any heart's ventricles: frame, openings, compact wall, coordinates through it"
  DEPENDS model mesh_queries parallel adapters image LIBRARIES Eigen3::Eigen nanoflann::nanoflann fmt::fmt)
heartgen_room(atlas FOLDER generator/atlas
  SENTENCE "The fibre atlas: readers, pose and registration to a patient's heart"
  DEPENDS model mesh_queries parallel adapters image mesh_files ventricles LIBRARIES heartgen_itk heartgen_vtk heartgen_ceres Eigen3::Eigen nanoflann::nanoflann ZLIB::ZLIB fmt::fmt)
heartgen_room(fibers FOLDER generator/fibers
  SENTENCE "Fibres on a patient's mesh: mapped from the atlas, by rules, and inpainted"
  DEPENDS model mesh_queries parallel adapters image ventricles atlas LIBRARIES Eigen3::Eigen nanoflann::nanoflann fmt::fmt)
heartgen_room(tetmesh FOLDER generator/tetmesh
  SENTENCE "A mutable tetrahedral mesh, its local operations, and the improvement of any mesh"
  DEPENDS model mesh_queries parallel mesh_files LIBRARIES fmt::fmt)
heartgen_vectorise(tetmesh generator/tetmesh smooth.cpp quality.cpp)
heartgen_room(stuffing FOLDER generator/stuffing
  SENTENCE "Tetrahedra of several materials from a graded lattice"
  DEPENDS model parallel tetmesh LIBRARIES fmt::fmt)
heartgen_room(surface_fit FOLDER generator/surface_fit
  SENTENCE "Surfaces of a mesh drawn onto level sets, with volumes kept and nothing crossing"
  DEPENDS model parallel tetmesh stuffing LIBRARIES fmt::fmt)
heartgen_room(distmesh FOLDER generator/distmesh
  SENTENCE "DistMesh in two and three dimensions"
  DEPENDS model parallel adapters tetmesh stuffing LIBRARIES heartgen_delaunay fmt::fmt)
heartgen_room(mesh FOLDER generator/mesh
  SENTENCE "Meshes of label maps: domain, sizes, back ends, repair of labels"
  DEPENDS model parallel adapters image pde tetmesh stuffing surface_fit distmesh LIBRARIES heartgen_cgal heartgen_tetgen fmt::fmt)
heartgen_room(validation FOLDER validation
  SENTENCE "Certificates: a mesh, a label map and fibres judged, with nothing of what made them"
  DEPENDS model mesh_queries parallel LIBRARIES ${json} fmt::fmt)
heartgen_room(report FOLDER validation/report
  SENTENCE "Pictures, charts and the page that shows a bundle"
  DEPENDS model parallel validation LIBRARIES PNG::PNG ZLIB::ZLIB ${json} fmt::fmt)
heartgen_room(exporters FOLDER exporters
  SENTENCE "Formats for solvers, and the bundle on disk: write, read, verify, pack"
  DEPENDS model mesh_queries parallel adapters LIBRARIES heartgen_vtk heartgen_itk ${HDF5_C_LIBRARIES} ${json} OpenSSL::Crypto LibArchive::LibArchive fmt::fmt)
heartgen_room(phantom FOLDER datasets/phantom
  SENTENCE "The analytic phantom: CT, truth, fibres and a stand-in atlas"
  DEPENDS model parallel LIBRARIES fmt::fmt)
heartgen_room(pipeline FOLDER generator/pipeline
  SENTENCE "A whole build: stages, cache, checks of inputs, progress"
  DEPENDS model parallel adapters image pde anatomy landmarks labels painting ventricles atlas fibers stuffing mesh validation report exporters phantom
  LIBRARIES heartgen_itk ${json} fmt::fmt)
heartgen_room(library FOLDER generator/library
  SENTENCE "The public face: the headers of include/heartgen and what they declare of their own"
  DEPENDS model mesh_queries parallel adapters pde anatomy landmarks labels mesh_files atlas fibers tetmesh mesh validation exporters phantom pipeline
  LIBRARIES heartgen_vtk fmt::fmt)
target_include_directories(heartgen_library PUBLIC ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/include)
heartgen_room(command_line FOLDER generator/command_line
  SENTENCE "What every program of ours does with its command line"
  DEPENDS model parallel phantom pipeline LIBRARIES CLI11::CLI11 fmt::fmt)
heartgen_room(app FOLDER generator/app
  SENTENCE "The commands of heartgen"
  DEPENDS model parallel adapters pde anatomy landmarks labels painting mesh_files fibers tetmesh mesh validation report exporters phantom pipeline library command_line
  LIBRARIES heartgen_itk heartgen_vtk CLI11::CLI11 ${json} fmt::fmt)
heartgen_room(benchmarks FOLDER benchmarks
  SENTENCE "Speeds of the stages and comparisons with other programs"
  DEPENDS model parallel adapters image pde anatomy landmarks tetmesh mesh validation exporters phantom
  LIBRARIES heartgen_itk heartgen_itk_chan_vese heartgen_cgal fmt::fmt)
heartgen_vectorise(benchmarks benchmarks measure.cpp)
heartgen_room(study FOLDER benchmarks/study
  SENTENCE "The thesis's analysis of the Chan-Vese model (chapter 5) in the plane: slow and clear"
  DEPENDS model parallel pde report phantom LIBRARIES fmt::fmt)
heartgen_vectorise(study benchmarks/study schemes.cpp two_phase.cpp global_minimum.cpp)
heartgen_room(lab FOLDER benchmarks/lab
  SENTENCE "The commands of heartgen-lab"
  DEPENDS model parallel adapters image pde anatomy naming landmarks labels atlas fibers mesh validation report phantom pipeline command_line benchmarks study
  LIBRARIES heartgen_itk CLI11::CLI11 ${json} fmt::fmt)

include(${PROJECT_SOURCE_DIR}/cmake/embedded.cmake)

add_executable(heartgen generator/app/main.cpp)
target_link_libraries(heartgen PRIVATE heartgen_app)
# TetGen's own program. Nothing else may link heartgen_tetgen_helper: it would be under the AGPL.
target_include_directories(heartgen_tetgen_helper SYSTEM PRIVATE ${TETGEN_INCLUDE})
add_executable(heartgen-tetgen generator/tetgen_helper/main.cpp)
target_include_directories(heartgen-tetgen PRIVATE ${PROJECT_BINARY_DIR}/include)
target_link_libraries(heartgen-tetgen PRIVATE heartgen_tetgen_helper)
add_dependencies(heartgen heartgen-tetgen)
add_executable(heartgen-lab benchmarks/lab/main.cpp)
target_link_libraries(heartgen-lab PRIVATE heartgen_lab)
