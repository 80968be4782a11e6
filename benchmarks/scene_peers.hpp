// SPDX-License-Identifier: Apache-2.0
// Others' ways to find models in a scan, behind one face. They are told which models are there and
// how often; they get the scan resampled, with normals and without its table.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ostraka/evaluation/scenes.hpp"

namespace ostraka::bench {

struct PeerSettings {
    int threads = 1;
    double opencv_step = 0.04;  ///< between OpenCV's points, in model diameters
    std::uint64_t seed = 0;
};

struct ScenePeer {
    std::string name;
    std::string settings;         ///< what was chosen for it, one line
    std::function<void()> train;  ///< whatever is done once for all scenes
    /// Whatever is done once for a scene. @param scan  must outlive the calls of find.
    std::function<void(const PointCloud& scan)> look;
    /// Refined poses T_scene_model of one object. @param taken  points of the scan that are
    /// explained already: one flag a point.
    std::function<std::vector<Pose>(std::uint32_t model, const std::vector<bool>& taken)> find;
};

/// Empty where the library wasn't found when the program was built. `library` must outlive them.
std::vector<ScenePeer> open3d_scene_peers(const ModelLibrary& library,
                                          const PeerSettings& settings);
std::vector<ScenePeer> opencv_scene_peers(const ModelLibrary& library,
                                          const PeerSettings& settings);

/// The scan as peers get it: at the library's sampling distance, without its table.
PointCloud peer_scan(const PointCloud& scan, const ModelLibrary& library);

/// How often each model is there, of objects that are visible enough to count.
std::vector<int> told_counts(const TestScene& scene, std::size_t models);

/// One pose for each object there. Of a peer's poses the one that explains most of the scan is
/// taken; its points are then out of the search for further objects of the same model.
std::vector<RecognizedObject> find_told(const ScenePeer& peer, const ModelLibrary& library,
                                        const PointCloud& scan, const std::vector<int>& counts);

/// The points that aren't taken, with their normals.
PointCloud free_points(const PointCloud& scan, const std::vector<bool>& taken);

}  // namespace ostraka::bench
