// SPDX-License-Identifier: Apache-2.0
// Checks a placed model against the scan by casting rays from the scan's own viewpoint
// (method, 3.6). Aldoma, Tombari, Di Stefano, Vincze. A Global Hypotheses Verification Method for
// 3D Object Recognition. ECCV 2012 (support, occlusion, clutter).
#pragma once

#include "ostraka/recognition/cell_check.hpp"
#include "ostraka/recognition/hypothesis.hpp"
#include "ostraka/recognition/outline.hpp"

namespace ostraka {

/// A hypothesis after verification. Areas count cells of the range map (cell_check.hpp).
struct Verified {
    Hypothesis hypothesis;
    std::size_t silhouette = 0;  ///< cells that the placed model covers
    std::size_t support = 0;     ///< of these: the scan agrees, in distance and normal
    std::size_t hidden = 0;      ///< of these: something is in front
    std::size_t violation = 0;   ///< of these: the scan saw through, or the surface faces elsewhere
    std::size_t backdrop = 0;    ///< of these: the scan's surface is a plane larger than the model
    std::size_t missing = 0;     ///< of these: nothing was measured
    std::size_t unsure = 0;      ///< of these: nothing can be said
    std::size_t solid = 0;       ///< of violation and backdrop: solid_contradiction()
    std::size_t inside = 0;      ///< points of a merged scan deep inside, beyond what noise puts
                                 ///< there; 0 unless merged
    std::size_t blank = 0;       ///< of missing: solid_blank()
    std::size_t hollow = 0;      ///< in holes of the scan's surface: hollow_contradiction()
    double sunk = 0.0;           ///< share of the surface that would be below the table, seen or
                                 ///< not
    OutlineEvidence outline;     ///< whether the scan's surface ends where the model does
    double inlier_rms = 0.0;     ///< of the distances of supporting cells, along the normal; scan's
                                 ///< unit
    double expected_rms = 0.0;   ///< of the same: what noise and the model's detail account for
    double noise = 0.0;          ///< expected_rms in sampling distances
    double turned = 0.0;         ///< mean of 1 - cosine between the normals of supporting cells
    double grip = 0.0;           ///< how well the support holds the model in place: smallest
                                 ///< eigenvalue of its normals' scatter, times 3; 0: a plane
    double sharpness = 0.0;      ///< sharpness() of the supporting points; 0 unless merged
    double depth_fit = 0.0;  ///< sum over the silhouette of how well each cell's own depths agree:
                             ///< finer than support, to tell apart poses that are nearly equal
    double area = 0.0;       ///< of the support, across the line of sight, in diameters squared
    double visible_fraction = 0.0;     ///< support / silhouette
    double confidence = 0.0;           ///< 0 to 1
    std::vector<std::uint32_t> cells;  ///< the supporting cells, ascending

    /// Support, less what contradicts it, as a share of what can be judged; 0 to 1.
    double agreement() const;
};

/// What verify() found in each cell of the range map around a placed model.
struct CellVerdicts {
    std::vector<std::uint32_t> cells;  ///< ascending
    std::vector<CellVerdict> verdicts;
};

/// Of `inlier_rms`: what the scan's noise, the model's detail, resampling and registration account
/// for.
double expected_deviation(const Scan& scan, const ModelProbe& probe);

/// All but the confidence.
/// @param tolerance  distance along the normal that counts as agreement, in the scan's unit.
/// @param detail  also gets the verdict of each cell, if given.
Verified verify(const Scan& scan, const ModelProbe& probe, const Hypothesis& hypothesis,
                double tolerance, CellVerdicts* detail = nullptr);

}  // namespace ostraka
