# Embree 3 (Debian 12) or 4 (Ubuntu 24.04): one imported name, and the version as a definition.
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_package(embree 3 REQUIRED)
endif()
add_library(ostraka_embree INTERFACE)
target_link_libraries(ostraka_embree INTERFACE embree)
target_compile_definitions(ostraka_embree INTERFACE OSTRAKA_EMBREE_MAJOR=${embree_VERSION_MAJOR})
