// SPDX-License-Identifier: Apache-2.0
#include "index_methods.hpp"

namespace ostraka::bench {

std::vector<SearchMethod> faiss_methods(const IndexRows&, int) {
    return {};
}

}  // namespace ostraka::bench
