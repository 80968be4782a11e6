// SPDX-License-Identifier: Apache-2.0
#include "ostraka/segmentation/convex_parts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "ostraka/base/error.hpp"
#include "ostraka/segmentation/part_merging.hpp"

namespace ostraka {
namespace {

constexpr double kParallel = 0.5;  // radians between normals above which an offset is no step

double angle_between(const Vec3d& a, const Vec3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Difference of the heights of a contact above the planes of its two patches. On a crease or a
// curved surface it lies on both, or as far from either.
double step_at(const SurfacePatch& a, const SurfacePatch& b, const Vec3d& contact) {
    return std::abs(a.normal.dot(contact - a.center) - b.normal.dot(contact - b.center));
}

// Equations 5 and 6: the steeper the crease, the more the line between the patches must cross it.
bool touches_in_corner(const SurfacePatch& a, const SurfacePatch& b, const Vec3d& line, double turn,
                       double sanity_angle) {
    constexpr double kSlope = 0.25 * 180.0 / kPi;  // a, per radian
    constexpr double kOffset = 25.0 * kPi / 180.0;
    const Vec3d crease = a.normal.cross(b.normal);
    const double across = angle_between(line, crease);
    const double least = sanity_angle / (1.0 + std::exp(-kSlope * (turn - kOffset)));
    return std::min(across, kPi - across) < least;
}

// Convex with one of two patches, and not concave with the other.
bool confirms(Bend one, Bend other) {
    return (one == Bend::convex && (other == Bend::convex || other == Bend::singular)) ||
           (one == Bend::singular && other == Bend::convex);
}

// Which contacts may carry a merge: convex, and confirmed by a common neighbor (section 3.2).
std::vector<bool> confirmed(const SurfacePatches& surface, const std::vector<Bend>& bends) {
    std::vector<std::map<std::uint32_t, Bend>> around(surface.patches.size());
    for (std::size_t c = 0; c < bends.size(); ++c) {
        around[surface.contacts[c].a][surface.contacts[c].b] = bends[c];
        around[surface.contacts[c].b][surface.contacts[c].a] = bends[c];
    }
    std::vector<bool> good(bends.size(), false);
    for (std::size_t c = 0; c < bends.size(); ++c) {
        if (bends[c] != Bend::convex) continue;
        bool any_common = false;
        const auto& others = around[surface.contacts[c].b];
        for (const auto& [k, bend] : around[surface.contacts[c].a]) {
            const auto same = others.find(k);
            if (same == others.end()) continue;
            any_common = true;
            if (confirms(bend, same->second)) good[c] = true;
        }
        if (!any_common) good[c] = true;
    }
    return good;
}

PartMerging start_merging(const SurfacePatches& surface, const std::vector<Bend>& bends) {
    std::vector<std::uint32_t> sizes;
    for (const SurfacePatch& patch : surface.patches) {
        sizes.push_back(static_cast<std::uint32_t>(patch.indices.size()));
    }
    PartMerging merging(std::move(sizes));
    for (std::size_t c = 0; c < bends.size(); ++c) {
        Border border;
        const PatchContact& contact = surface.contacts[c];
        switch (bends[c]) {
            case Bend::convex:
                border.convex = contact.pairs;
                break;
            case Bend::concave:
            case Bend::step:
                border.concave = contact.pairs;
                break;
            case Bend::singular:
                border.singular = contact.pairs;
                break;
        }
        merging.add_border(contact.a, contact.b, border);
    }
    return merging;
}

void merge_convex(const SurfacePatches& surface, const std::vector<Bend>& bends, double max_share,
                  PartMerging& merging) {
    const std::vector<bool> good = confirmed(surface, bends);
    std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> order;  // turn, patches
    for (std::size_t c = 0; c < bends.size(); ++c) {
        if (!good[c]) continue;
        const auto& [a, b] = std::pair(surface.contacts[c].a, surface.contacts[c].b);
        order.emplace_back(angle_between(surface.patches[a].normal, surface.patches[b].normal), a,
                           b);
    }
    std::sort(order.begin(), order.end());
    // A border that was too concave at first may not be any more when its groups have grown.
    for (bool merged = true; merged;) {
        merged = false;
        for (const auto& [turn, a, b] : order) {
            const std::uint32_t g = merging.group(a);
            const std::uint32_t h = merging.group(b);
            if (g == h) continue;
            const Border& border = merging.border(g, h);
            if (border.concave > max_share * (border.concave + border.convex)) continue;
            merging.merge(g, h);
            merged = true;
        }
    }
}

ConvexParts collect(const SurfacePatches& surface, PartMerging& merging, std::size_t min_points) {
    std::vector<std::vector<std::uint32_t>> members(surface.patches.size());
    for (std::uint32_t i = 0; i < surface.patch_of.size(); ++i) {
        members[merging.group(surface.patch_of[i])].push_back(i);
    }
    std::vector<std::uint32_t> order;
    for (std::uint32_t g = 0; g < members.size(); ++g) {
        if (!members[g].empty() && members[g].size() >= min_points) order.push_back(g);
    }
    std::sort(order.begin(), order.end(), [&](std::uint32_t g, std::uint32_t h) {
        if (members[g].size() != members[h].size()) return members[g].size() > members[h].size();
        return members[g].front() < members[h].front();
    });
    ConvexParts result;
    std::vector<std::uint32_t> part_of(members.size(), kNoIndex);
    for (const std::uint32_t g : order) {
        part_of[g] = static_cast<std::uint32_t>(result.parts.size());
        result.parts.push_back(std::move(members[g]));
    }
    for (const std::uint32_t g : order) {
        for (const auto& [other, border] : merging.borders(g)) {
            if (part_of[other] == kNoIndex || part_of[g] > part_of[other]) continue;
            result.contacts.push_back({part_of[g], part_of[other], border.pairs(), border.concave});
        }
    }
    return result;
}

void sort_contacts(std::vector<PartContact>& contacts) {
    std::sort(contacts.begin(), contacts.end(), [](const PartContact& p, const PartContact& q) {
        return std::tuple(q.pairs, p.a, p.b) < std::tuple(p.pairs, q.a, q.b);
    });
}

// The parts of an ordered cloud with the indices of the original one, in its order.
ConvexParts renamed(ConvexParts ordered, const std::vector<std::uint32_t>& order) {
    for (auto& part : ordered.parts) {
        for (std::uint32_t& i : part) i = order[i];
        std::sort(part.begin(), part.end());
    }
    std::vector<std::uint32_t> rank(ordered.parts.size());
    std::iota(rank.begin(), rank.end(), 0U);
    std::sort(rank.begin(), rank.end(), [&](std::uint32_t p, std::uint32_t q) {
        const auto& a = ordered.parts[p];
        const auto& b = ordered.parts[q];
        return a.size() != b.size() ? a.size() > b.size() : a.front() < b.front();
    });
    ConvexParts result;
    std::vector<std::uint32_t> new_of(rank.size());
    for (std::uint32_t r = 0; r < rank.size(); ++r) {
        new_of[rank[r]] = r;
        result.parts.push_back(std::move(ordered.parts[rank[r]]));
    }
    for (const PartContact& c : ordered.contacts) {
        const auto [low, high] = std::minmax(new_of[c.a], new_of[c.b]);
        result.contacts.push_back({low, high, c.pairs, c.concave});
    }
    sort_contacts(result.contacts);
    return result;
}

}  // namespace

Bend bend_between(const SurfacePatch& a, const SurfacePatch& b, const PatchContact& contact,
                  double sampling, const ConvexSettings& settings) {
    const Vec3d line = (a.center - b.center).normalized();
    const double turn = angle_between(a.normal, b.normal);
    if (turn < kParallel && step_at(a, b, contact.middle) > settings.max_step * sampling) {
        return Bend::step;
    }
    // Equation 2: outward if b's normal leans away from a more than a's own does.
    const bool outward = a.normal.dot(line) >= b.normal.dot(line);
    if (!outward && turn > settings.max_concavity) return Bend::concave;
    // Between almost parallel patches the crease has no direction.
    const bool corner =
        turn > settings.max_concavity && touches_in_corner(a, b, line, turn, settings.sanity_angle);
    return corner ? Bend::singular : Bend::convex;
}

ConvexParts convex_parts(const SurfacePatches& patches, double sampling,
                         const ConvexSettings& settings) {
    if (!(sampling > 0.0)) throw InvalidInput("convex parts: sampling must be positive");
    std::vector<Bend> bends;
    bends.reserve(patches.contacts.size());
    for (const PatchContact& contact : patches.contacts) {
        bends.push_back(bend_between(patches.patches[contact.a], patches.patches[contact.b],
                                     contact, sampling, settings));
    }
    PartMerging merging = start_merging(patches, bends);
    merge_convex(patches, bends, settings.max_share, merging);
    merging.absorb_small(settings.min_points);
    ConvexParts result = collect(patches, merging, settings.min_points);
    sort_contacts(result.contacts);
    return result;
}

ConvexParts convex_parts(const PointCloud& cloud, const PatchSettings& patches,
                         const ConvexSettings& settings) {
    const std::vector<std::uint32_t> order = spatial_order(cloud, patches.sampling);
    const PointCloud ordered = select(cloud, order);
    return renamed(convex_parts(surface_patches(ordered, patches), patches.sampling, settings),
                   order);
}

}  // namespace ostraka
