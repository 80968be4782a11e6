// SPDX-License-Identifier: Apache-2.0
// Stands in for open3d.cpp where Open3D isn't installed.
#include "benchmark.hpp"

namespace ostraka::bench {

std::vector<Benchmark> open3d_benchmarks() {
    return {};
}

}  // namespace ostraka::bench
