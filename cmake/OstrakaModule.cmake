# ostraka_module(NAME HEADERS ... SOURCES ... DEPENDS modules... HIDDEN libraries...)
# One static library a module. DEPENDS is public (other Ostraka modules); HIDDEN libraries are
# used by .cpp files only and never appear in a public header.
function(ostraka_module NAME)
  cmake_parse_arguments(M "" "" "HEADERS;SOURCES;DEPENDS;HIDDEN" ${ARGN})
  set(target ostraka_${NAME})
  add_library(${target} STATIC ${M_SOURCES})
  add_library(ostraka::${NAME} ALIAS ${target})
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}/src"
                                  FILES ${M_HEADERS})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC Eigen3::Eigen)
  foreach(dependency IN LISTS M_DEPENDS)
    target_link_libraries(${target} PUBLIC ostraka_${dependency})
  endforeach()
  target_link_libraries(${target} PRIVATE fmt::fmt ${M_HIDDEN})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${NAME})
  set_property(GLOBAL APPEND PROPERTY OSTRAKA_MODULES ${target})
endfunction()
