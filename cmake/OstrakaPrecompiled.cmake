# Reading Eigen, fmt and the standard library costs half of a typical compilation: they are compiled
# once. Sources still include what they use: OSTRAKA_PRECOMPILED=OFF (presets dev and tidy) shows it.
set(OSTRAKA_COMMON_HEADERS
    <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <numeric>
    <optional> <span> <string> <string_view> <vector>
    <Eigen/Core> <Eigen/Geometry> <Eigen/Eigenvalues> <fmt/format.h>)

# ostraka_precompile(TARGET OWNER [headers...])
# The first target of a kind (same flags) owns the precompiled header; the others share it.
function(ostraka_precompile TARGET OWNER)
  if(NOT OSTRAKA_PRECOMPILED)
    return()
  endif()
  if("${TARGET}" STREQUAL "${OWNER}")
    target_precompile_headers(${TARGET} PRIVATE ${OSTRAKA_COMMON_HEADERS} ${ARGN})
  else()
    target_precompile_headers(${TARGET} REUSE_FROM ${OWNER})
  endif()
endfunction()
