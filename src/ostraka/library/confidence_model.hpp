// SPDX-License-Identifier: Apache-2.0
// The probability that a report is right, from what verification found of it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace ostraka {

/// What a verified hypothesis is judged by. All are about 0 to 2.
enum class Feature : std::uint8_t {
    constant,   ///< 1
    clearness,  ///< support as a share of what can be judged; to a power that falls with the noise:
                ///< where there is hardly any, 0.97 is much better than 0.9
    surplus,    ///< what the scan's deviation from the model exceeds the one expected of noise and
                ///< detail by, as a share of that; at most 2
    turned,     ///< mean of 1 - cosine between the normals of scan and model
    visible,    ///< logarithm of percent of the silhouette that the scan shows, at most of 50
    area,       ///< logarithm of what supports, as an area in squared diameters
    cells,      ///< logarithm of what supports, as cells of the range map
    grip,       ///< how well what supports holds the model in place; 0: a plane
    sharpness,  ///< how much worse normals agree when the pose is moved a little
    open,       ///< share of the outline where the scan's surface goes on
    level,      ///< share of the silhouette's outline where the scan is as high beyond
    folded,     ///< share of it where the scan's surface bends away and goes on
    joined,     ///< share of the outline where something in front begins at the surface
    fenced,     ///< share of the outline, beyond a half, along which something nearer begins
    ended,      ///< logarithm of the cells of outline where the scan ends, too
    sunk,       ///< share of the surface that would be below the table
    solid,   ///< logarithm of what contradicts in one piece, as cells of the range map, or of the
             ///< points of a merged scan deep inside
    blank,   ///< logarithm of what was not measured in one piece, as cells of the range map
    hollow,  ///< logarithm of cells of holes that the model lacks
    rival,   ///< logarithm of 1 + the odds that other models have to be what explains the same
    count    // how many there are
};
inline constexpr std::size_t kFeatures = static_cast<std::size_t>(Feature::count);
using Features = std::array<double, kFeatures>;

std::string_view feature_name(Feature feature);

/// A logistic function of the features.
struct ConfidenceModel {
    Features weights{};
    double confidence(const Features& features) const;
};

/// What is known of free space decides what counts.
enum class ScanKind : std::uint8_t {
    one_viewpoint,
    merged  ///< of several viewpoints, or from nobody knows where
};

/// Fitted to simulated scenes of shipped and other parts; one that is fitted to a library's own
/// models knows which of them are easily mistaken.
const ConfidenceModel& general_confidence();

/// The same for merged scans: where nothing is known of free space, other things count.
const ConfidenceModel& merged_confidence();

}  // namespace ostraka
