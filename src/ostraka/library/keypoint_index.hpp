// SPDX-License-Identifier: Apache-2.0
// Nearest local descriptors: which point of each model looks most like a point of a scan.
#pragma once

#include <span>
#include <vector>

#include "ostraka/library/model_library.hpp"
#include "ostraka/library/row_table.hpp"

namespace ostraka {

/// Rows nearest to a scene keypoint that are looked at where there is a graph.
inline constexpr std::size_t kGraphMatches = 32;

/// Local descriptors of points spread over a scan or a piece of one.
struct SceneKeypoints {
    std::vector<Vec3f> points;       ///< scene frame, library unit
    std::vector<Mat3f> frames;       ///< R_scene_keypoint
    std::vector<std::uint8_t> rows;  ///< size() rows of kShotLength: quantize_row() of SHOT
    std::size_t size() const { return points.size(); }
};

/// A scene keypoint and the point of a model that looks most like it.
struct Correspondence {
    Vec3f scene_point;
    Vec3f model_point;
    Mat3f R_scene_model;         ///< turns the model keypoint's frame into the scene keypoint's
    std::int32_t distance = -1;  ///< squared, between quantized rows; -1: no match
    bool matched() const { return distance >= 0; }
};

/// SHOT at points about `spacing` apart.
/// @param cloud    with normals, at the library's sampling distance, library unit.
/// @param spacing  in sampling distances.
/// @param most     at most so many, thinned out evenly.
SceneKeypoints scene_keypoints(const PointCloud& cloud, const LibrarySettings& settings,
                               double spacing, std::size_t most);

/// The keypoints of all models, ready to be searched. As distances are integers, the same on every
/// machine; const and safe from many threads. The library must outlive it. Exact, unless the
/// library has a keypoint graph: then each scene keypoint has matches with those models only that
/// hold one of the kGraphMatches rows nearest to it, about 99 % of which are found
/// (docs/approximate_search.md).
class KeypointIndex {
  public:
    explicit KeypointIndex(const ModelLibrary& library);

    /// For each model of the library, the best match of each scene keypoint, in their order, some
    /// of them perhaps not matched(); no matches at all for a model without keypoints.
    std::vector<std::vector<Correspondence>> match(const SceneKeypoints& scene) const;

  private:
    void match_exactly(const SceneKeypoints& scene,
                       std::vector<std::vector<Correspondence>>& matches) const;
    void match_by_graph(const SceneKeypoints& scene,
                        std::vector<std::vector<Correspondence>>& matches) const;

    const ModelLibrary* library_;
    std::vector<RowTable> rows_;             // of each model; none with a graph
    std::vector<std::uint8_t> bytes_;        // of all models, with a graph
    std::vector<std::uint32_t> first_rows_;  // of each model among bytes_, and the end
};

}  // namespace ostraka
