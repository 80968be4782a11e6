// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/backdrop.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/cloud/normals.hpp"
#include "ostraka/cloud/resample.hpp"

namespace ostraka {
namespace {

constexpr double kCoarse = 4.0;  // sampling distances between points of the thinned scan
constexpr std::size_t kMostPoints = 60'000;  // of the scan that are looked at
constexpr double kParallel = 0.998;          // cosine between the normals of coplanar pieces
constexpr double kBehind = 3.0;              // sampling distances beyond a plane that are behind it
constexpr double kMaxBehindShare = 0.1;      // of the scan's points, behind a wall
constexpr double kNoiseSlack = 2.5;          // deviations of noise

PointCloud thinned(const PointCloud& scan, double spacing) {
    PointCloud some;
    some.viewpoint = scan.viewpoint;
    const std::size_t stride = 1 + scan.size() / kMostPoints;
    for (std::size_t i = 0; i < scan.size(); i += stride) some.points.push_back(scan.points[i]);
    PointCloud coarse = resample(some, spacing);
    coarse.normals = estimate_normals_within(coarse, kNormalRadius * spacing);
    return remove_invalid(coarse);
}

// Normals of one plane must agree; any viewpoint that isn't on it will do.
PointCloud seen_from_afar(const PointCloud& scan) {
    PointCloud seen;
    seen.points = scan.points;
    Vec3f low = scan.points.front();
    Vec3f high = low;
    for (const Vec3f& point : scan.points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    const Vec3f oblique = Vec3f(0.41F, 0.53F, 0.74F);  // hardly parallel to anybody's table
    seen.viewpoint = (low + high) / 2.0F + 10.0F * (high - low).norm() * oblique;
    return seen;
}

// Its normal toward where more of the scan lies.
void turn_to_front(PlanePiece& piece, const PointCloud& coarse) {
    std::ptrdiff_t balance = 0;
    const double slack = piece.roughness + 1e-9;
    for (const Vec3f& point : coarse.points) {
        const double height = piece.normal.dot(point.cast<double>()) - piece.offset;
        if (std::abs(height) > 3.0 * slack) balance += height > 0.0 ? 1 : -1;
    }
    if (balance >= 0) return;
    piece.normal = -piece.normal;
    piece.offset = -piece.offset;
    piece.T_cloud_piece = piece.T_cloud_piece * Eigen::AngleAxisd(kPi, Vec3d::UnitX());
}

bool coplanar(const PlanePiece& a, const PlanePiece& b, double distance) {
    if (a.normal.dot(b.normal) < kParallel) return false;
    const auto off = [](const PlanePiece& plane, const PlanePiece& other) {
        return std::abs(plane.normal.dot(other.T_cloud_piece.translation()) - plane.offset);
    };
    return std::max(off(a, b), off(b, a)) < distance;
}

bool is_last(const PointCloud& coarse, const PlanePiece& plane, double distance) {
    const auto behind =
        std::count_if(coarse.points.begin(), coarse.points.end(), [&](const Vec3f& point) {
            return plane.normal.dot(point.cast<double>()) - plane.offset < -distance;
        });
    return static_cast<double>(behind) < kMaxBehindShare * static_cast<double>(coarse.size());
}

std::array<Vec3d, 4> corners_of(const PlanePiece& piece) {
    std::array<Vec3d, 4> corners;
    for (int i = 0; i < 4; ++i) {
        const double x = (i % 2 == 0 ? -0.5 : 0.5) * piece.extents.x();
        const double y = (i / 2 == 0 ? -0.5 : 0.5) * piece.extents.y();
        corners[static_cast<std::size_t>(i)] = piece.T_cloud_piece * Vec3d(x, y, 0.0);
    }
    return corners;
}

double extent_of(const PlanePiece& a, const PlanePiece& b) {
    double extent = 0.0;
    for (const Vec3d& p : corners_of(a)) {
        for (const Vec3d& q : corners_of(b)) extent = std::max(extent, (p - q).norm());
    }
    return extent;
}

// Extent and share of the surface that a piece is part of.
FlatPiece with_surface(const PlanePiece& piece, const std::vector<PlanePiece>& all,
                       const PointCloud& coarse, double sampling, double slack) {
    // The longer side: of a disk, too, no more than it is.
    FlatPiece flat{.plane = piece,
                   .T_piece_cloud = piece.T_cloud_piece.inverse(Eigen::Isometry),
                   .extent = piece.extents.maxCoeff()};
    flat.last = is_last(coarse, piece, kBehind * sampling);
    std::size_t points = 0;
    for (const PlanePiece& other : all) {
        if (&other == &piece) {
            points += other.indices.size();
        } else if (flat.last && coplanar(piece, other, slack)) {
            points += other.indices.size();
            flat.extent = std::max(flat.extent, extent_of(piece, other));
        }
    }
    flat.share = static_cast<double>(points) / static_cast<double>(coarse.size());
    return flat;
}

}  // namespace

double Backdrop::extent_at(const Vec3f& point) const {
    double extent = 0.0;
    for (const FlatPiece& piece : pieces) {
        const double height = piece.plane.normal.dot(point.cast<double>()) - piece.plane.offset;
        if (std::abs(height) > slack || piece.extent <= extent) continue;
        const Vec3d at = piece.T_piece_cloud * point.cast<double>();
        const double margin = kCoarse * slack;
        if (std::abs(at.x()) < 0.5 * piece.plane.extents.x() + margin &&
            std::abs(at.y()) < 0.5 * piece.plane.extents.y() + margin) {
            const double here =
                piece.extents ? piece.extents->at(point.cast<double>()) : piece.extent;
            extent = std::max(extent, std::min(here, piece.extent));
        }
    }
    return extent;
}

const FlatPiece* Backdrop::table(double extent) const {
    const FlatPiece* best = nullptr;
    for (const FlatPiece& piece : pieces) {
        if (!piece.last || piece.extent < extent) continue;
        if (best == nullptr || piece.share > best->share) best = &piece;
    }
    return best;
}

Backdrop find_backdrop(const PointCloud& scan, const BackdropSettings& settings) {
    const double sampling = settings.sampling;
    Backdrop backdrop;
    backdrop.slack = std::max(sampling, kNoiseSlack * settings.noise.deviation);
    const PointCloud coarse = settings.merged ? thinned(seen_from_afar(scan), kCoarse * sampling)
                                              : thinned(scan, kCoarse * sampling);
    if (coarse.size() < 3) return backdrop;
    PatchSettings patches;
    patches.sampling = kCoarse * sampling;
    PlanePieceSettings planes;
    // A plane of the thinned scan is as flat as its noise lets it be.
    planes.tolerance = std::max(0.25, backdrop.slack / patches.sampling);
    planes.min_points = 30;
    std::vector<PlanePiece> pieces = find_planes(coarse, patches, planes);
    if (settings.merged) {
        for (PlanePiece& piece : pieces) turn_to_front(piece, coarse);
    }
    for (const PlanePiece& piece : pieces) {
        FlatPiece flat = with_surface(piece, pieces, coarse, sampling, backdrop.slack);
        if (flat.extent < settings.least) continue;
        if (!flat.last && !settings.merged && flat.extent > settings.wall &&
            settings.noise.pitch > 0.0) {
            flat.extents.emplace(piece, scan, settings.noise.pitch, backdrop.slack);
        }
        backdrop.pieces.push_back(std::move(flat));
    }
    return backdrop;
}

}  // namespace ostraka
