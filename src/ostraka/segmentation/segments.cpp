// SPDX-License-Identifier: Apache-2.0
#include "ostraka/segmentation/segments.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/clusters.hpp"

namespace ostraka {
namespace {

using Indices = std::vector<std::uint32_t>;

constexpr double kSmoothGap = 2.0;     // sampling distances between points of a smooth region
constexpr double kHeldByParent = 0.9;  // of a plane

std::size_t overlap(const Indices& a, const Indices& b) {
    std::size_t common = 0;
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        if (a[i] == b[j]) ++common;
        const bool step_a = a[i] <= b[j];
        const bool step_b = b[j] <= a[i];
        i += step_a ? 1 : 0;
        j += step_b ? 1 : 0;
    }
    return common;
}

bool same(const Indices& a, const Indices& b, double least) {
    const auto [small, large] = std::minmax({a.size(), b.size()});
    if (static_cast<double>(small) <= least * static_cast<double>(large)) return false;
    const std::size_t common = overlap(a, b);
    const std::size_t all = a.size() + b.size() - common;
    return static_cast<double>(common) > least * static_cast<double>(all);
}

// The owner that more than half of the points have, and of how many; if there is none, any.
std::pair<std::uint32_t, std::size_t> majority(const Indices& owner, const Indices& points) {
    std::uint32_t leader = kNoIndex;
    std::size_t lead = 0;
    for (const std::uint32_t i : points) {  // Boyer, Moore. MJRTY. 1981
        if (lead == 0) leader = owner[i];
        lead = owner[i] == leader ? lead + 1 : lead - 1;
    }
    const auto held = std::count_if(points.begin(), points.end(),
                                    [&](std::uint32_t i) { return owner[i] == leader; });
    return {leader, static_cast<std::size_t>(held)};
}

bool larger(const Indices& a, const Indices& b) {
    return a.size() != b.size() ? a.size() > b.size() : a < b;
}

// The segments found so far. Those that are like an earlier one are not taken in.
class Forest {
  public:
    Forest(const SegmentationSettings& settings, const Indices& order, std::size_t cloud_size)
        : settings_(settings), order_(order) {
        owners_.fill(Indices(cloud_size, kNoIndex));
    }

    /// @param pieces  indices into the ordered cloud.
    void add(SegmentKind kind, Clusters pieces) {
        for (Indices& piece : pieces) {
            for (std::uint32_t& i : piece) i = order_[i];
            std::sort(piece.begin(), piece.end());
        }
        std::sort(pieces.begin(), pieces.end(), larger);
        std::size_t added = 0;
        for (Indices& piece : pieces) {
            if (added == settings_.max_of_kind) break;
            if (piece.size() < settings_.min_points || known(piece)) continue;
            for (const std::uint32_t i : piece) {
                owners_.at(static_cast<std::size_t>(kind))[i] =
                    static_cast<std::uint32_t>(segments_.size());
            }
            segments_.push_back({std::move(piece), kNoIndex, kind});
            segments_.back().parent = parent_of(segments_.back());
            ++added;
        }
    }

    std::vector<Segment> take() { return std::move(segments_); }

  private:
    bool known(const Indices& piece) const {
        return std::any_of(segments_.begin(), segments_.end(), [&](const Segment& segment) {
            return same(segment.indices, piece, settings_.same);
        });
    }

    // The segment of the finest coarser kind that holds it. Joined parts overlap, and have no
    // children: the convex parts in them are nearer.
    std::uint32_t parent_of(const Segment& segment) const {
        const double share = segment.kind == SegmentKind::plane ? kHeldByParent : 1.0;
        const auto least = share * static_cast<double>(segment.indices.size());
        for (const SegmentKind kind :
             {SegmentKind::smooth, SegmentKind::convex, SegmentKind::cluster}) {
            if (kind >= segment.kind) continue;
            const auto& owner = owners_.at(static_cast<std::size_t>(kind));
            const auto [holder, held] = majority(owner, segment.indices);
            if (holder != kNoIndex && static_cast<double>(held) >= least) return holder;
        }
        return kNoIndex;
    }

    const SegmentationSettings& settings_;
    const Indices& order_;  // of the ordered cloud: index in the given one
    std::vector<Segment> segments_;
    std::array<Indices, 5> owners_;  // of each kind: the segment that holds a point of the cloud
};

Clusters joined_parts(const ConvexParts& convex, const SegmentationSettings& settings) {
    Clusters joined;
    for (const PartContact& contact : convex.contacts) {  // longest first
        if (joined.size() == settings.max_of_kind || contact.pairs < settings.min_contact) break;
        Indices both;
        std::set_union(convex.parts[contact.a].begin(), convex.parts[contact.a].end(),
                       convex.parts[contact.b].begin(), convex.parts[contact.b].end(),
                       std::back_inserter(both));
        joined.push_back(std::move(both));
    }
    return joined;
}

// Each part by itself, so that regions don't leak through a blended crease.
Clusters smooth_regions(const PointCloud& cloud, const Clusters& parts,
                        const SegmentationSettings& settings) {
    const SmoothnessSettings smoothness{.tolerance = kSmoothGap * settings.patches.sampling,
                                        .max_angle = settings.smooth_angle,
                                        .max_curvature = settings.smooth_curvature,
                                        .min_size = settings.min_points};
    Clusters regions;
    for (const Indices& part : parts) {
        for (Indices& region : smooth_clusters(select(cloud, part), smoothness)) {
            for (std::uint32_t& i : region) i = part[i];
            regions.push_back(std::move(region));
        }
    }
    return regions;
}

Clusters plane_sets(const PointCloud& cloud, const SurfacePatches& surface,
                    const SegmentationSettings& settings) {
    PlanePieceSettings planes = settings.planes;
    planes.min_points = settings.min_points;
    Clusters sets;
    for (PlanePiece& piece : find_planes(cloud, surface, settings.patches.sampling, planes)) {
        sets.push_back(std::move(piece.indices));
    }
    return sets;
}

}  // namespace

std::string_view name_of(SegmentKind kind) {
    switch (kind) {
        case SegmentKind::cluster:
            return "cluster";
        case SegmentKind::convex:
            return "convex";
        case SegmentKind::joined:
            return "joined";
        case SegmentKind::smooth:
            return "smooth";
        case SegmentKind::plane:
            return "plane";
    }
    return "";
}

std::vector<Segment> segment_hierarchy(const PointCloud& cloud,
                                       std::span<const std::uint32_t> foreground,
                                       const SegmentationSettings& settings) {
    if (settings.gap < settings.patches.reach) {
        throw InvalidInput("segments: the gap between clusters must not be less than the reach");
    }
    const double sampling = settings.patches.sampling;
    const Indices order = spatial_order(cloud, foreground, sampling);
    const PointCloud ordered = select(cloud, order);
    const SurfacePatches surface = surface_patches(ordered, settings.patches);
    ConvexSettings convexity = settings.convex;
    convexity.min_points = settings.min_points;
    const ConvexParts convex = convex_parts(surface, sampling, convexity);

    Forest forest(settings, order, cloud.size());
    forest.add(SegmentKind::cluster,
               euclidean_clusters(ordered.points, settings.gap * sampling, settings.min_points));
    forest.add(SegmentKind::convex, convex.parts);
    forest.add(SegmentKind::joined, joined_parts(convex, settings));
    forest.add(SegmentKind::smooth, smooth_regions(ordered, convex.parts, settings));
    forest.add(SegmentKind::plane, plane_sets(ordered, surface, settings));
    return forest.take();
}

}  // namespace ostraka
