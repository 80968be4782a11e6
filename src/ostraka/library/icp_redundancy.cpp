// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/icp_redundancy.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>

#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/kdtree.hpp"
#include "ostraka/cloud/principal_frame.hpp"
#include "ostraka/library/selection.hpp"
#include "ostraka/registration/cloud_icp.hpp"

namespace ostraka {
namespace {

// A thinned-out cloud made ready to be compared.
struct Piece {
    PointCloud cloud;
    PrincipalFrame frame;
    KdTree tree = KdTree({});
    double spacing = 0.0;  // between its points
    IcpTarget target;
};

std::unique_ptr<Piece> make_piece(const PointCloud& cloud, double sampling,
                                  const IcpRedundancySettings& settings) {
    PointCloud thinned = select(cloud, thin_out(cloud.size(), settings.points));
    IcpTarget target(thinned);
    auto piece = std::make_unique<Piece>(
        Piece{.cloud = {}, .frame = principal_frame(cloud), .target = std::move(target)});
    // Of a surface, a share s of the points is 1 / sqrt(s) times as far apart.
    const auto thinning = static_cast<double>(cloud.size()) / static_cast<double>(thinned.size());
    piece->spacing = sampling * std::sqrt(thinning);
    piece->tree = KdTree(thinned.points);
    piece->cloud = std::move(thinned);
    return piece;
}

bool alike(const PrincipalFrame& a, const PrincipalFrame& b, double ratio, double sampling) {
    for (int axis = 0; axis < 3; ++axis) {
        const double x = a.deviations[axis] + 0.5 * sampling;  // thin pieces differ by noise
        const double y = b.deviations[axis] + 0.5 * sampling;
        if (x > ratio * y || y > ratio * x) return false;
    }
    return true;
}

double share_near(const Piece& source, const Piece& target, const Pose& T_target_source,
                  float distance) {
    std::size_t near = 0;
    for (const Vec3f& point : source.cloud.points) {
        const Vec3f moved = (T_target_source * point.cast<double>()).cast<float>();
        const Neighbor nearest = target.tree.nearest(moved);
        if (nearest.squared_distance <= distance * distance) ++near;
    }
    return static_cast<double>(near) / static_cast<double>(source.cloud.size());
}

bool match(const Piece& source, const Piece& target, const IcpRedundancySettings& settings) {
    const double distance = settings.max_distance * std::max(source.spacing, target.spacing);
    const CloudIcpSettings icp{.max_distance = 4.0 * distance, .iterations = 10};
    for (const Pose& T_source_frame : possible_frames(source.frame)) {
        const Pose guess = target.frame.T_cloud_frame * T_source_frame.inverse();
        const Pose pose =
            align_clouds(target.target, source.cloud.points, guess, icp).T_target_source;
        const auto near = static_cast<float>(distance);
        if (share_near(source, target, pose, near) >= settings.min_match &&
            share_near(target, source, pose.inverse(), near) >= settings.min_match) {
            return true;
        }
    }
    return false;
}

}  // namespace

std::vector<std::uint32_t> drop_by_icp(std::span<const PointCloud> clouds, double sampling,
                                       const IcpRedundancySettings& settings) {
    std::vector<std::uint32_t> kept;
    std::vector<std::unique_ptr<Piece>> pieces;
    for (std::uint32_t i = 0; i < clouds.size(); ++i) {
        std::unique_ptr<Piece> piece = make_piece(clouds[i], sampling, settings);
        std::atomic<bool> redundant = false;  // whichever thread finds it: the answer is the same
        parallel_for(
            pieces.size(),
            [&](std::size_t j) {
                if (redundant) return;
                if (!alike(piece->frame, pieces[j]->frame, settings.max_deviation_ratio,
                           sampling)) {
                    return;
                }
                if (match(*piece, *pieces[j], settings)) redundant = true;
            },
            8);
        if (redundant) continue;
        kept.push_back(i);
        pieces.push_back(std::move(piece));
    }
    return kept;
}

}  // namespace ostraka
