// SPDX-License-Identifier: Apache-2.0
#include "ostraka/segmentation/plane_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/segmentation/plane_region.hpp"
#include "ostraka/segmentation/rectangle.hpp"
#include "ostraka/segmentation/region_growth.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kMinSeedPoints = 6;  // of a patch that a plane can start from

// A connected set of patches on one plane.
struct Region {
    PlaneRegion plane;
    std::vector<std::uint32_t> patches;
    std::vector<std::uint32_t> sure;  // points of these that are on it beyond doubt
};

class PlaneGrowth {
  public:
    PlaneGrowth(const PointCloud& cloud, const SurfacePatches& surface, double sampling,
                const PlanePieceSettings& settings)
        : cloud_(cloud),
          surface_(surface),
          settings_(settings),
          tolerance_(settings.tolerance * sampling),
          min_cosine_(std::cos(settings.max_angle)),
          taken_(surface.patches.size(), false),
          touching_(surface.patches.size()) {
        for (const PatchContact& contact : surface.contacts) {
            touching_[contact.a].push_back(contact.b);
            touching_[contact.b].push_back(contact.a);
        }
    }

    std::vector<Region> regions() {
        std::vector<bool> useless(surface_.patches.size(),
                                  false);  // as a seed: it bends around here
        std::vector<Region> found;
        for (const std::uint32_t seed : flattest_first()) {
            if (taken_[seed] || useless[seed]) continue;
            Region region = grow(seed);
            const bool is_plane = accept(region, found);
            for (const std::uint32_t p : region.patches) {
                if (is_plane) {
                    taken_[p] = true;
                } else {
                    useless[p] = true;
                }
            }
            if (is_plane) found.push_back(std::move(region));
        }
        unite(found);
        return found;
    }

  private:
    bool flat(const SurfacePatch& patch) const { return patch.roughness < 0.7 * tolerance_; }

    std::vector<std::uint32_t> flattest_first() const {
        std::vector<std::uint32_t> order;
        for (std::uint32_t p = 0; p < surface_.patches.size(); ++p) {
            const SurfacePatch& patch = surface_.patches[p];
            if (patch.indices.size() >= kMinSeedPoints && flat(patch)) order.push_back(p);
        }
        std::sort(order.begin(), order.end(), [&](std::uint32_t p, std::uint32_t q) {
            const double a = surface_.patches[p].roughness;
            const double b = surface_.patches[q].roughness;
            return a != b ? a < b : p < q;
        });
        return order;
    }

    bool fits(const SurfacePatch& patch, const PlaneRegion& plane) const {
        return flat(patch) && std::abs(plane.height(patch.center)) < tolerance_ &&
               plane.normal().dot(patch.normal) > min_cosine_;
    }

    Region grow(std::uint32_t seed) const {
        const SurfacePatch& first = surface_.patches[seed];
        Region region{PlaneRegion(first.center), {seed}, {}};
        region.plane.add(cloud_, first.indices);
        region.plane.fit(first.normal);
        std::vector<bool> inside(surface_.patches.size(), false);
        inside[seed] = true;
        for (std::size_t head = 0; head < region.patches.size(); ++head) {
            for (const std::uint32_t next : touching_[region.patches[head]]) {
                const SurfacePatch& patch = surface_.patches[next];
                if (inside[next] || taken_[next] || !fits(patch, region.plane)) continue;
                inside[next] = true;
                region.patches.push_back(next);
                region.plane.add(cloud_, patch.indices);
                region.plane.fit(region.plane.normal());
            }
        }
        return region;
    }

    // Points of some patches that lie near the plane, their normals within an angle of its own.
    void append_near(const PlaneRegion& plane, std::span<const std::uint32_t> patches,
                     double min_cosine, std::vector<std::uint32_t>& indices) const {
        const Vec3f normal = plane.normal().cast<float>();
        const auto offset = static_cast<float>(plane.normal().dot(plane.center()));
        const auto tolerance = static_cast<float>(tolerance_);
        const auto least = static_cast<float>(min_cosine);
        for (const std::uint32_t p : patches) {
            for (const std::uint32_t i : surface_.patches[p].indices) {
                const float height = normal.dot(cloud_.points[i]) - offset;
                if (std::abs(height) < tolerance && normal.dot(cloud_.normals[i]) > least) {
                    indices.push_back(i);
                }
            }
        }
    }

    // Whether the surface bends, judged beyond the region's own patches: of a curved surface these
    // are a strip so narrow that it looks flat.
    bool bends(const Region& region) const {
        std::vector<bool> seen(surface_.patches.size(), false);
        std::vector<std::uint32_t> wide = region.patches;
        for (const std::uint32_t p : region.patches) seen[p] = true;
        for (const std::uint32_t p : region.patches) {
            for (const std::uint32_t next : touching_[p]) {
                if (!seen[next]) wide.push_back(next);
                seen[next] = true;
            }
        }
        std::vector<std::uint32_t> indices;
        append_near(region.plane, wide, std::cos(settings_.edge_angle), indices);
        return bend_of(cloud_, indices, region.plane) > settings_.max_bend;
    }

    // Refits the region to what is sure to be on it. False: too small, not flat, or a bit of a
    // plane that is known already.
    bool accept(Region& region, const std::vector<Region>& found) const {
        append_near(region.plane, region.patches, min_cosine_, region.sure);
        // At an edge, points whose normals are blended come later; half is enough for now.
        if (2 * region.sure.size() < settings_.min_points || region.sure.size() < 3) return false;
        PlaneRegion plane(region.plane.center());
        plane.add(cloud_, region.sure);
        plane.fit(region.plane.normal());
        region.plane = plane;
        if (bends(region)) return false;
        return std::none_of(found.begin(), found.end(), [&](const Region& other) {
            return std::abs(other.plane.height(plane.center())) < tolerance_ &&
                   other.plane.normal().dot(plane.normal()) > min_cosine_ && touch(region, other);
        });
    }

    // Regions of one plane that don't touch patch by patch become one: points may connect them yet.
    void unite(std::vector<Region>& regions) const {
        std::vector<Region> united;
        for (Region& region : regions) {
            const auto like = std::find_if(united.begin(), united.end(), [&](const Region& other) {
                return std::abs(other.plane.height(region.plane.center())) < 0.5 * tolerance_ &&
                       std::abs(region.plane.height(other.plane.center())) < 0.5 * tolerance_ &&
                       other.plane.normal().dot(region.plane.normal()) > min_cosine_;
            });
            if (like == united.end()) {
                united.push_back(std::move(region));
            } else {
                like->sure.insert(like->sure.end(), region.sure.begin(), region.sure.end());
            }
        }
        regions = std::move(united);
    }

    bool touch(const Region& region, const Region& other) const {
        std::vector<bool> inside(surface_.patches.size(), false);
        for (const std::uint32_t p : other.patches) inside[p] = true;
        return std::any_of(region.patches.begin(), region.patches.end(), [&](std::uint32_t p) {
            return std::any_of(touching_[p].begin(), touching_[p].end(),
                               [&](std::uint32_t next) { return inside[next]; });
        });
    }

    const PointCloud& cloud_;
    const SurfacePatches& surface_;
    PlanePieceSettings settings_;
    double tolerance_;  // in the cloud's unit
    double min_cosine_;
    std::vector<bool> taken_;
    std::vector<std::vector<std::uint32_t>> touching_;
};

// Every plane keeps the points that are sure to be on it; the others go to the plane they suit best
// among those that reach them.
std::vector<std::uint32_t> settle_points(const PointCloud& cloud, const ProximityGraph& graph,
                                         const std::vector<Region>& regions, double tolerance,
                                         double edge_angle) {
    std::vector<std::uint32_t> owner(cloud.size(), kNoIndex);
    std::vector<Vec3f> normals;
    std::vector<float> offsets;
    for (std::uint32_t r = 0; r < regions.size(); ++r) {
        const PlaneRegion& plane = regions[r].plane;
        normals.push_back(plane.normal().cast<float>());
        offsets.push_back(static_cast<float>(plane.normal().dot(plane.center())));
        for (const std::uint32_t i : regions[r].sure) owner[i] = r;
    }
    const auto per_distance = static_cast<float>(1.0 / tolerance);
    const auto per_turn = static_cast<float>(1.0 / (1.0 - std::cos(edge_angle)));
    grow_regions(graph, owner, [&](std::uint32_t i, std::uint32_t r) {
        const float away = std::abs(normals[r].dot(cloud.points[i]) - offsets[r]) * per_distance;
        const float turned = (1.0F - normals[r].dot(cloud.normals[i])) * per_turn;
        return away < 1.0F && turned < 1.0F ? away + turned : kNever;
    });
    return owner;
}

struct Group {
    std::uint32_t owner = 0;
    std::vector<std::uint32_t> indices;  // ascending
};

// The points of each owner in connected groups.
std::vector<Group> connected_groups(const ProximityGraph& graph,
                                    const std::vector<std::uint32_t>& owner) {
    std::vector<std::uint32_t> group_of(owner.size(), kNoIndex);
    std::vector<Group> groups;
    std::vector<std::uint32_t> queue;
    for (std::uint32_t i = 0; i < owner.size(); ++i) {
        if (owner[i] == kNoIndex || group_of[i] != kNoIndex) continue;
        const auto number = static_cast<std::uint32_t>(groups.size());
        group_of[i] = number;
        queue.assign(1, i);
        for (std::size_t head = 0; head < queue.size(); ++head) {
            const std::uint32_t at = queue[head];
            for (std::uint32_t n = graph.starts[at]; n < graph.starts[at + 1]; ++n) {
                const std::uint32_t next = graph.neighbors[n];
                if (group_of[next] != kNoIndex || owner[next] != owner[i]) continue;
                group_of[next] = number;
                queue.push_back(next);
            }
        }
        groups.push_back({owner[i], {}});
        groups.back().indices.reserve(queue.size());
    }
    for (std::uint32_t i = 0; i < owner.size(); ++i) {
        if (group_of[i] != kNoIndex) groups[group_of[i]].indices.push_back(i);
    }
    return groups;
}

PlanePiece describe(const PointCloud& cloud, std::vector<std::uint32_t> indices,
                    const PlaneRegion& plane) {
    PlanePiece piece;
    const Vec3d to_eye = cloud.viewpoint.cast<double>() - plane.center();
    piece.normal = plane.normal().dot(to_eye) < 0.0 ? Vec3d(-plane.normal()) : plane.normal();
    piece.offset = piece.normal.dot(plane.center());
    piece.roughness = plane.roughness();
    const Vec3d u = piece.normal.unitOrthogonal();
    const Vec3d v = piece.normal.cross(u);
    std::vector<Vec2d> flat;
    flat.reserve(indices.size());
    for (const std::uint32_t i : indices) {
        const Vec3d offset = cloud.points[i].cast<double>() - plane.center();
        flat.emplace_back(u.dot(offset), v.dot(offset));
    }
    const Rectangle rectangle = smallest_rectangle(std::move(flat));
    const Vec3d x = rectangle.along.x() * u + rectangle.along.y() * v;
    piece.T_cloud_piece.linear().col(0) = x;
    piece.T_cloud_piece.linear().col(1) = piece.normal.cross(x);
    piece.T_cloud_piece.linear().col(2) = piece.normal;
    piece.T_cloud_piece.translation() =
        plane.center() + rectangle.center.x() * u + rectangle.center.y() * v;
    piece.extents = rectangle.extents;
    piece.indices = std::move(indices);
    return piece;
}

void sort_largest_first(std::vector<PlanePiece>& pieces) {
    std::sort(pieces.begin(), pieces.end(), [](const PlanePiece& a, const PlanePiece& b) {
        if (a.indices.size() != b.indices.size()) return a.indices.size() > b.indices.size();
        return a.indices.front() < b.indices.front();
    });
}

}  // namespace

std::vector<PlanePiece> find_planes(const PointCloud& cloud, const SurfacePatches& patches,
                                    double sampling, const PlanePieceSettings& settings) {
    if (patches.patch_of.size() != cloud.size()) {
        throw InvalidInput("planes: the patches are of another cloud");
    }
    PlaneGrowth growth(cloud, patches, sampling, settings);
    const std::vector<Region> regions = growth.regions();
    const std::vector<std::uint32_t> owner = settle_points(
        cloud, patches.graph, regions, settings.tolerance * sampling, settings.edge_angle);
    std::vector<PlanePiece> pieces;
    for (Group& group : connected_groups(patches.graph, owner)) {
        if (group.indices.size() < std::max<std::size_t>(3, settings.min_points)) continue;
        const PlaneRegion& near = regions[group.owner].plane;
        PlaneRegion plane(near.center());
        plane.add(cloud, group.indices);
        plane.fit(near.normal());
        if (bend_of(cloud, group.indices, plane) > settings.max_bend) continue;
        PlanePiece piece = describe(cloud, std::move(group.indices), plane);
        if (piece.extents.y() < settings.min_width * sampling) continue;
        pieces.push_back(std::move(piece));
    }
    sort_largest_first(pieces);
    return pieces;
}

std::vector<PlanePiece> find_planes(const PointCloud& cloud, const PatchSettings& patches,
                                    const PlanePieceSettings& settings) {
    const std::vector<std::uint32_t> order = spatial_order(cloud, patches.sampling);
    const PointCloud ordered = select(cloud, order);
    auto pieces =
        find_planes(ordered, surface_patches(ordered, patches), patches.sampling, settings);
    for (PlanePiece& piece : pieces) {
        for (std::uint32_t& i : piece.indices) i = order[i];
        std::sort(piece.indices.begin(), piece.indices.end());
    }
    sort_largest_first(pieces);
    return pieces;
}

}  // namespace ostraka
