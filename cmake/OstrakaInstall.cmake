# `find_package(ostraka)` gives ostraka::ostraka: all modules behind one name.
include(CMakePackageConfigHelpers)
get_property(modules GLOBAL PROPERTY OSTRAKA_MODULES)
add_library(ostraka INTERFACE)
add_library(ostraka::ostraka ALIAS ostraka)
target_link_libraries(ostraka INTERFACE ${modules})
target_sources(ostraka INTERFACE FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}/src"
                                 FILES "${PROJECT_SOURCE_DIR}/src/ostraka/ostraka.hpp")
install(TARGETS ostraka ${modules} EXPORT ostrakaTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
