# `find_package(ostraka)` gives ostraka::ostraka: all modules behind one name. Each module is there
# alone, too: ostraka::base, ostraka::cloud and so on.
include(CMakePackageConfigHelpers)
get_property(modules GLOBAL PROPERTY OSTRAKA_MODULES)
add_library(ostraka INTERFACE)
add_library(ostraka::ostraka ALIAS ostraka)
target_link_libraries(ostraka INTERFACE ${modules})
target_sources(ostraka INTERFACE FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}/src"
                                 FILES "${PROJECT_SOURCE_DIR}/src/ostraka/ostraka.hpp")

# The modules are static, so their hidden libraries come along at link time. Embree's two versions
# hide behind a target of ours, which is therefore exported as well.
set_target_properties(ostraka_embree PROPERTIES EXPORT_NAME embree)
set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/ostraka")
install(TARGETS ostraka ostraka_embree ${modules} EXPORT ostrakaTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(EXPORT ostrakaTargets NAMESPACE ostraka:: DESTINATION ${package_folder}
        COMPONENT development)

configure_package_config_file(
  "${PROJECT_SOURCE_DIR}/cmake/ostrakaConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/ostrakaConfig.cmake" INSTALL_DESTINATION ${package_folder})
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/ostrakaConfigVersion.cmake"
                                 COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/ostrakaConfig.cmake"
              "${PROJECT_BINARY_DIR}/ostrakaConfigVersion.cmake"
        DESTINATION ${package_folder} COMPONENT development)
