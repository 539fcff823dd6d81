# heartgen_room(NAME FOLDER folder SENTENCE "what it knows" DEPENDS room... [LIBRARIES foreign target...] [PARTS])
# A room is one folder, one namespace and one library, heartgen_NAME. DEPENDS lists every room whose headers it includes,
# and no other: tests/architecture compares. PARTS: its
# folder's CMakeLists.txt makes a library for each of its parts, so that nobody links what it does not use.
function(heartgen_room name)
  cmake_parse_arguments(room "PARTS" "FOLDER;SENTENCE" "DEPENDS;LIBRARIES" ${ARGN})
  if(room_PARTS)
    add_library(heartgen_${name} INTERFACE)
    add_subdirectory(${PROJECT_SOURCE_DIR}/${room_FOLDER} ${PROJECT_BINARY_DIR}/${room_FOLDER})
    return()
  endif()
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${room_FOLDER}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  add_library(heartgen_${name} STATIC ${sources})
  target_link_libraries(heartgen_${name} PUBLIC heartgen_options)
  foreach(other ${room_DEPENDS})
    target_link_libraries(heartgen_${name} PUBLIC heartgen_${other})
  endforeach()
  target_link_libraries(heartgen_${name} PRIVATE ${room_LIBRARIES})
endfunction()

# Lets the vectoriser use square roots and selections; results keep their bits (no reassociation, no contraction).
function(heartgen_vectorise room folder)
  list(TRANSFORM ARGN PREPEND ${PROJECT_SOURCE_DIR}/${folder}/ OUTPUT_VARIABLE paths)
  set_source_files_properties(${paths} TARGET_DIRECTORY heartgen_${room}
    PROPERTIES COMPILE_OPTIONS "-O3;-fno-math-errno;-fno-trapping-math")
endfunction()
