# The words of place recognition: vocabulary.bin becomes part of the program (pipeline/frontend/vocabulary_data).
set(vocabulary_file ${PROJECT_SOURCE_DIR}/pipeline/frontend/vocabulary.bin)
set_property(SOURCE ${PROJECT_SOURCE_DIR}/pipeline/frontend/vocabulary_data.cpp PROPERTY COMPILE_DEFINITIONS
             POVSLAM_VOCABULARY_FILE="${vocabulary_file}")
set_property(SOURCE ${PROJECT_SOURCE_DIR}/pipeline/frontend/vocabulary_data.cpp PROPERTY OBJECT_DEPENDS ${vocabulary_file})
