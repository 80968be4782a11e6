// SPDX-License-Identifier: Apache-2.0
#include "ostraka/segmentation/patches.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/cell_grid.hpp"
#include "ostraka/cloud/point_columns.hpp"
#include "ostraka/segmentation/region_growth.hpp"

namespace ostraka {
namespace {

void check_settings(const PointCloud& cloud, const PatchSettings& s) {
    if (cloud.normals.size() != cloud.size()) throw InvalidInput("patches need normals");
    if (!(s.sampling > 0.0 && s.reach > 0.0 && s.spacing > 0.0 && s.sweeps > 0) ||
        !std::isfinite(s.sampling)) {
        throw InvalidInput("patches: sampling, reach, spacing and sweeps must be positive");
    }
}

// Among `members`, the point nearest to where they are on average; the first of equals.
std::uint32_t most_central(const PointCloud& cloud, std::span<const std::uint32_t> members) {
    Vec3d mean = Vec3d::Zero();
    for (const std::uint32_t i : members) mean += cloud.points[i].cast<double>();
    mean /= static_cast<double>(members.size());
    std::uint32_t nearest = members.front();
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : members) {
        const double distance = (cloud.points[i].cast<double>() - mean).squaredNorm();
        if (distance < least) {
            least = distance;
            nearest = i;
        }
    }
    return nearest;
}

std::vector<std::uint32_t> first_seeds(const PointCloud& cloud, double cell) {
    const CellGrid grid(cloud.points, cell);
    std::vector<std::uint32_t> seeds;
    seeds.reserve(grid.cell_count());
    for (std::size_t c = 0; c < grid.cell_count(); ++c) {
        seeds.push_back(most_central(cloud, grid.members(c)));
    }
    return seeds;
}

SurfacePatch describe(const PointCloud& cloud, std::vector<std::uint32_t> indices) {
    SurfacePatch patch;
    Vec3d normal = Vec3d::Zero();
    for (const std::uint32_t i : indices) {
        patch.center += cloud.points[i].cast<double>();
        normal += cloud.normals[i].cast<double>();
    }
    const auto count = static_cast<double>(indices.size());
    patch.center /= count;
    // Normals that cancel say nothing: take one of them.
    const bool sound = normal.norm() > 1e-6 * count;
    patch.normal = (sound ? normal : cloud.normals[indices.front()].cast<double>()).normalized();
    double sum = 0.0;
    for (const std::uint32_t i : indices) {
        const double height = patch.normal.dot(cloud.points[i].cast<double>() - patch.center);
        sum += height * height;
    }
    patch.roughness = std::sqrt(sum / count);
    patch.indices = std::move(indices);
    return patch;
}

// One point's normal is too noisy to start from.
std::vector<std::uint32_t> with_neighbors(const ProximityGraph& graph, std::uint32_t point) {
    std::vector<std::uint32_t> near(graph.neighbors.begin() + graph.starts[point],
                                    graph.neighbors.begin() + graph.starts[point + 1]);
    near.push_back(point);
    return near;
}

// A cell has one seed, but may hold several components. What no patch reached becomes a patch for
// each component.
void adopt_leftovers(const ProximityGraph& graph, std::vector<std::uint32_t>& owner,
                     std::uint32_t regions) {
    std::vector<std::uint32_t> queue;
    for (std::uint32_t i = 0; i < owner.size(); ++i) {
        if (owner[i] != kNoIndex) continue;
        owner[i] = regions;
        queue.assign(1, i);
        for (std::size_t head = 0; head < queue.size(); ++head) {
            const std::uint32_t at = queue[head];
            for (std::uint32_t n = graph.starts[at]; n < graph.starts[at + 1]; ++n) {
                const std::uint32_t next = graph.neighbors[n];
                if (owner[next] != kNoIndex) continue;
                owner[next] = regions;
                queue.push_back(next);
            }
        }
        ++regions;
    }
}

std::vector<std::uint32_t> grow_patches(const PointCloud& cloud, const ProximityGraph& graph,
                                        const std::vector<std::uint32_t>& seeds,
                                        const std::vector<SurfacePatch>& cores,
                                        const PatchSettings& settings) {
    const double spacing = settings.spacing * settings.sampling;
    const auto per_area = static_cast<float>(1.0 / (spacing * spacing));
    const auto weight = static_cast<float>(settings.normal_weight);
    std::vector<Vec3f> centers;
    std::vector<Vec3f> normals;
    for (const SurfacePatch& core : cores) {
        centers.push_back(core.center.cast<float>());
        normals.push_back(core.normal.cast<float>());
    }
    std::vector<std::uint32_t> owner(cloud.size(), kNoIndex);
    for (std::uint32_t r = 0; r < seeds.size(); ++r) owner[seeds[r]] = r;
    grow_regions(graph, owner, [&](std::uint32_t i, std::uint32_t r) {
        const float apart = (cloud.points[i] - centers[r]).squaredNorm() * per_area;
        return apart + weight * (1.0F - cloud.normals[i].dot(normals[r]));
    });
    adopt_leftovers(graph, owner, static_cast<std::uint32_t>(seeds.size()));
    return owner;
}

// The patches by owner, without gaps in their numbers; `owner` is renumbered.
std::vector<SurfacePatch> collect(const PointCloud& cloud, std::vector<std::uint32_t>& owner) {
    std::vector<std::vector<std::uint32_t>> members;
    for (std::uint32_t i = 0; i < owner.size(); ++i) {
        if (owner[i] >= members.size()) members.resize(owner[i] + std::size_t{1});
        members[owner[i]].push_back(i);
    }
    std::vector<SurfacePatch> patches;
    patches.reserve(members.size());
    for (auto& indices : members) {
        if (indices.empty()) continue;
        for (const std::uint32_t i : indices) owner[i] = static_cast<std::uint32_t>(patches.size());
        patches.push_back(describe(cloud, std::move(indices)));
    }
    return patches;
}

std::vector<PatchContact> find_contacts(const PointCloud& cloud, const SurfacePatches& result) {
    std::vector<PatchContact> contacts;
    std::vector<std::vector<std::uint32_t>> of_patch(result.patches.size());  // with smaller number
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        const std::uint32_t a = result.patch_of[i];
        for (std::uint32_t n = result.graph.starts[i]; n < result.graph.starts[i + 1]; ++n) {
            const std::uint32_t j = result.graph.neighbors[n];
            const std::uint32_t b = result.patch_of[j];
            if (a >= b) continue;  // the pair is met from its other end, too
            auto& known = of_patch[a];
            const auto at = std::find_if(known.begin(), known.end(),
                                         [&](std::uint32_t c) { return contacts[c].b == b; });
            std::uint32_t c = 0;
            if (at == known.end()) {
                c = static_cast<std::uint32_t>(contacts.size());
                known.push_back(c);
                contacts.push_back({.a = a, .b = b});
            } else {
                c = *at;
            }
            ++contacts[c].pairs;
            contacts[c].middle += 0.5 * (cloud.points[i] + cloud.points[j]).cast<double>();
        }
    }
    for (PatchContact& contact : contacts) contact.middle /= contact.pairs;
    return contacts;
}

}  // namespace

std::vector<std::uint32_t> spatial_order(const PointCloud& cloud,
                                         std::span<const std::uint32_t> among, double sampling) {
    if (cloud.normals.size() != cloud.size()) throw InvalidInput("segmentation needs normals");
    if (!(sampling > 0.0)) throw InvalidInput("segmentation: sampling must be positive");
    std::vector<std::uint32_t> valid;
    std::vector<Vec3f> points;
    valid.reserve(among.size());
    points.reserve(among.size());
    for (const std::uint32_t i : among) {
        if (i >= cloud.size()) throw InvalidInput("segmentation: no point has such an index");
        if (!cloud.points[i].allFinite() || !cloud.normals[i].allFinite()) continue;
        valid.push_back(i);
        points.push_back(cloud.points[i]);
    }
    if (valid.empty()) return valid;
    const PointColumns columns(points, sampling);
    std::vector<std::uint32_t> order;
    order.reserve(valid.size());
    for (const std::uint32_t slot : columns.order()) order.push_back(valid[slot]);
    return order;
}

std::vector<std::uint32_t> spatial_order(const PointCloud& cloud, double sampling) {
    std::vector<std::uint32_t> all(cloud.size());
    std::iota(all.begin(), all.end(), 0U);
    return spatial_order(cloud, all, sampling);
}

SurfacePatches surface_patches(const PointCloud& cloud, const PatchSettings& settings) {
    check_settings(cloud, settings);
    SurfacePatches result;
    result.graph.starts.assign(1, 0);
    if (cloud.empty()) return result;
    result.graph = proximity_graph(cloud.points, settings.reach * settings.sampling);
    std::vector<std::uint32_t> seeds = first_seeds(cloud, settings.spacing * settings.sampling);
    std::vector<SurfacePatch> cores;
    for (const std::uint32_t seed : seeds) {
        cores.push_back(describe(cloud, with_neighbors(result.graph, seed)));
    }
    for (int sweep = 0; sweep < settings.sweeps; ++sweep) {
        if (sweep > 0) {
            seeds.clear();
            for (const SurfacePatch& patch : result.patches) {
                seeds.push_back(most_central(cloud, patch.indices));
            }
            cores = std::move(result.patches);
        }
        result.patch_of = grow_patches(cloud, result.graph, seeds, cores, settings);
        result.patches = collect(cloud, result.patch_of);
    }
    result.contacts = find_contacts(cloud, result);
    return result;
}

}  // namespace ostraka
