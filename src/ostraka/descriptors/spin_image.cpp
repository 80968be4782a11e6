// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/spin_image.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/local_checks.hpp"
#include "ostraka/descriptors/spin_image_row.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kChunk = 8;  // keypoints that share scratch memory
constexpr int kWidest = 64;

void require_settings(const SpinImageSettings& settings) {
    require_radius(settings.radius, "spin image");
    if (settings.width < 1 || settings.width > kWidest) {
        throw InvalidInput(
            fmt::format("spin image: width {}, must be 1 to {}", settings.width, kWidest));
    }
    if (!(settings.support_cosine >= 0.0F) || !(settings.support_cosine <= 1.0F)) {
        throw InvalidInput(fmt::format("spin image: support_cosine {:g}, must be 0 to 1",
                                       settings.support_cosine));
    }
}

}  // namespace

LocalDescriptors describe_spin_images(const PointCloud& cloud, std::span<const Vec3f> keypoints,
                                      std::span<const Vec3f> axes,
                                      const SpinImageSettings& settings) {
    require_settings(settings);
    require_surfels(cloud, "spin image");
    require_keypoints(keypoints, "spin image");
    if (axes.size() != keypoints.size()) {
        throw InvalidInput(
            fmt::format("spin image: {} axes for {} keypoints", axes.size(), keypoints.size()));
    }
    const std::size_t length = spin_image_length(settings);
    LocalDescriptors result;
    result.rows.assign(keypoints.size() * length, 0.0F);
    // Without a limit on the normals' angle points count whether they have a normal or not.
    const bool with_normals = settings.support_cosine > 0.0F;
    const SurfelGrid grid(
        cloud.points,
        with_normals ? std::span<const Vec3f>(cloud.normals) : std::span<const Vec3f>(),
        settings.radius);
    parallel_for((keypoints.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
        SurfelColumns around;
        SpinScratch scratch;
        const std::size_t end = std::min(keypoints.size(), (chunk + 1) * kChunk);
        for (std::size_t k = chunk * kChunk; k < end; ++k) {
            if (!axes[k].allFinite()) continue;
            grid.gather(keypoints[k], around);
            const SpinCylinder cylinder{.center = keypoints[k],
                                        .axis = axes[k],
                                        .bin = settings.radius / settings.width / std::sqrt(2.0),
                                        .width = settings.width,
                                        .support_cosine = settings.support_cosine};
            draw_spin_image(around, cylinder, scratch,
                            std::span(result.rows).subspan(k * length, length));
        }
    });
    return result;
}

LocalDescriptors describe_spin_images(const PointCloud& cloud, const KdTree& tree,
                                      std::span<const Vec3f> keypoints, std::span<const Vec3f> axes,
                                      const SpinImageSettings& settings) {
    require_tree(cloud, tree, "spin image");
    return describe_spin_images(cloud, keypoints, axes, settings);
}

LocalDescriptors describe_spin_images(const PointCloud& cloud, const KdTree& tree,
                                      std::span<const Vec3f> keypoints,
                                      const SpinImageSettings& settings) {
    require_tree(cloud, tree, "spin image");
    require_surfels(cloud, "spin image");
    require_keypoints(keypoints, "spin image");
    const Vec3f none = Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());
    std::vector<Vec3f> axes(keypoints.size(), none);
    std::vector<Neighbor> nearest;
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
        tree.nearest(keypoints[k], 1, nearest);
        if (!nearest.empty()) axes[k] = cloud.normals[nearest.front().index];
    }
    return describe_spin_images(cloud, keypoints, axes, settings);
}

}  // namespace ostraka
