// SPDX-License-Identifier: Apache-2.0
// Protocol S: segments cut out of scenes by ground truth, classified by their nearest entries
// (method, section 5).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ostraka/evaluation/intervals.hpp"
#include "ostraka/evaluation/test_scenes.hpp"
#include "ostraka/library/retrieval.hpp"

namespace ostraka {

struct SegmentSettings {
    double min_visible = 0.10;          ///< least visible fraction of a segment
    double max_visible = 0.85;          ///< greatest; 0.85 to 1 are "light" occlusions
    std::vector<std::size_t> ks = {1};  ///< numbers of nearest entries that vote, each at least 1
};

/// A piece of a scene that shows one object.
struct LabeledSegment {
    std::uint32_t model = 0;  ///< index into the library's models
    double visible_fraction = 0.0;
    PointCloud cloud;       ///< as the sensor saw it; viewpoint set
    std::size_t scene = 0;  ///< position in its set
};

/// The labeled points of each object that is as visible as asked for. @param number  of the scene.
std::vector<LabeledSegment> segments_of(const TestScene& scene, std::size_t number,
                                        const SegmentSettings& settings);

/// What a library made of one segment.
struct SegmentTrial {
    std::size_t scene = 0;
    std::uint32_t model = 0;
    double visible_fraction = 0.0;
    /// By method: the first-ranked model for each of the settings' ks; kNoIndex: none.
    std::map<std::string, std::vector<std::uint32_t>> answers;

    bool right(const std::string& method, std::size_t k_index) const {
        return answers.at(method)[k_index] == model;
    }
};

/// The methods of a library: each of its descriptors, "bag_of_words" if it has a codebook,
/// "keypoints" and "fused".
std::vector<std::string> methods_of(const ModelLibrary& library);

/// Classifies a segment by every method. A segment of fewer than 10 points after preparation has no
/// answer.
SegmentTrial try_segment(const EntryIndex& index, const LabeledSegment& segment,
                         std::span<const std::size_t> ks);

/// Share of trials that are right, by scenes resampled. @param k_index  into the settings' ks.
Interval recognition_rate(std::span<const SegmentTrial> trials, const std::string& method,
                          std::size_t k_index);

/// The rate of `trials` minus that of `baseline`, which tried the same segments.
/// @throws InvalidInput if they are not the same segments in the same order.
Interval recognition_gain(std::span<const SegmentTrial> trials,
                          std::span<const SegmentTrial> baseline, const std::string& method,
                          std::size_t k_index);

/// matrix[true model * (models + 1) + answer]; the last column counts trials without an answer.
std::vector<double> confusion_matrix(std::span<const SegmentTrial> trials,
                                     const std::string& method, std::size_t k_index,
                                     std::size_t models);

}  // namespace ostraka
