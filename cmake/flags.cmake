# Language, warnings and machine: one portable build, kernels pick wider vectors at run time.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
find_program(CCACHE ccache)
if(CCACHE) # paths hashed relative to the tree: checkouts beside each other share what was compiled
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1
                                  ${CCACHE})
endif()

set(CMAKE_CXX_FLAGS_RELEASE "-O3 -g1")
set(CMAKE_CXX_FLAGS_DEBUG "-Og -g")
add_compile_options(-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor
                    -Woverloaded-virtual -Wcast-align -Wnull-dereference -Werror)
# GCC 12 sees false overflows and null pointers inside inlined library code when optimising.
add_compile_options(-Wno-error=null-dereference -Wno-error=array-bounds -Wno-error=stringop-overflow
                    -Wno-error=maybe-uninitialized -Wno-error=restrict)
add_compile_options(-ffp-contract=off) # same bits from the same source on every machine
add_compile_definitions(POVSLAM_VERSION="${PROJECT_VERSION}")
if(POVSLAM_NATIVE)
  add_compile_options(-march=native)
else()
  add_compile_options(-march=x86-64-v2)
endif()
if(POVSLAM_SANITIZE)
  add_compile_options(-fsanitize=${POVSLAM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=undefined)
  add_link_options(-fsanitize=${POVSLAM_SANITIZE})
  # Under AddressSanitizer Eigen would align memory by itself, and Ceres, which is built without, would free what it got.
  add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()
