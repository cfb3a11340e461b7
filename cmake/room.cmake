# room(NAME FOLDER USES rooms… LINKS libs… PRIVATE_LINKS libs…): a static library of all sources in FOLDER.
# USES are the rooms it may include (the linker's half of the rule; .ci/check_rooms.py holds the includes).
function(room name folder)
  cmake_parse_arguments(ROOM "" "" "USES;LINKS;PRIVATE_LINKS" ${ARGN})
  if(name STREQUAL "pipeline")
    file(GLOB sources CONFIGURE_DEPENDS ${folder}/*.cpp) # its sub-folders are rooms of their own
  else()
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${folder}/*.cpp)
  endif()
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$|\\.kernel\\.cpp$") # kernels: isa_kernels() below
  list(TRANSFORM ROOM_USES PREPEND povslam_ OUTPUT_VARIABLE uses)
  if(sources)
    add_library(povslam_${name} STATIC ${sources})
    target_include_directories(povslam_${name} PUBLIC ${PROJECT_SOURCE_DIR})
    target_link_libraries(povslam_${name} PUBLIC ${uses} ${ROOM_LINKS} PRIVATE ${ROOM_PRIVATE_LINKS})
  else()
    add_library(povslam_${name} INTERFACE)
    target_include_directories(povslam_${name} INTERFACE ${PROJECT_SOURCE_DIR})
    target_link_libraries(povslam_${name} INTERFACE ${uses} ${ROOM_LINKS})
  endif()
endfunction()

# isa_kernels(ROOM FOLDER): compiles each FOLDER/*.kernel.cpp three times, for x86-64-v2, AVX2 and AVX-512; the
# source puts itself into namespace POVSLAM_ISA, and a dispatcher in the room picks one at run time.
function(isa_kernels room folder)
  file(GLOB kernels CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.kernel.cpp)
  foreach(source ${kernels})
    get_filename_component(stem ${source} NAME_WE)
    foreach(isa v2 v3 v4)
      set(copy ${CMAKE_CURRENT_BINARY_DIR}/kernels/${room}_${stem}_${isa}.cpp)
      file(CONFIGURE OUTPUT ${copy} CONTENT "#define POVSLAM_ISA isa_${isa}\n#include \"${source}\"\n")
      target_sources(povslam_${room} PRIVATE ${copy})
      set(machine $<$<NOT:$<BOOL:${POVSLAM_NATIVE}>>:-march=x86-64-${isa}>)
      set_property(SOURCE ${copy} PROPERTY COMPILE_OPTIONS ${machine} -fopenmp-simd -fno-math-errno -mprefer-vector-width=256 -Wno-psabi)
    endforeach()
  endforeach()
endfunction()
