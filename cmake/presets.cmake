# built_in_texts(ROOM HEADER TYPE FUNCTION FILES): the texts of config files become rows {name, text} of FUNCTION(),
# declared in HEADER, so that an installed program has them.
function(built_in_texts room header type function pattern)
  file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${pattern})
  set(rows "")
  foreach(file ${files})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    get_filename_component(name ${file} NAME_WE)
    file(READ ${file} text)
    string(APPEND rows "    {\"${name}\", R\"text(${text})text\"},\n")
  endforeach()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${function}.cpp @ONLY CONTENT [[
#include "@header@"

namespace povslam {

namespace {
constexpr @type@ kRows[] = {
@rows@};
}

std::span<const @type@> @function@() { return kRows; }

}  // namespace povslam
]])
  target_sources(povslam_${room} PRIVATE ${PROJECT_BINARY_DIR}/${function}.cpp)
endfunction()
