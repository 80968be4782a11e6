// SPDX-License-Identifier: Apache-2.0
#include "index_methods.hpp"

namespace ostraka::bench {

std::vector<SearchMethod> hnswlib_methods(const IndexRows&) {
    return {};
}

}  // namespace ostraka::bench
