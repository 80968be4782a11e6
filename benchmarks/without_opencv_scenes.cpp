// SPDX-License-Identifier: Apache-2.0
#include "scene_peers.hpp"

namespace ostraka::bench {

std::vector<ScenePeer> opencv_scene_peers(const ModelLibrary&, const PeerSettings&) {
    return {};
}

}  // namespace ostraka::bench
