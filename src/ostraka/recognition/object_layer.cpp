// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/object_layer.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "ostraka/base/parallel.hpp"
#include "ostraka/views/ray_scene.hpp"

namespace ostraka {
namespace {

constexpr double kLeastCosine = 0.25;  // between ray and normal: limits the tolerance along rays
constexpr int kBorder = 6;             // pixels around a silhouette, for its outline
constexpr int kVoteRadius = 2;         // pixels around each that vote on agreement
constexpr float kFar = 1e9F;

// What the rays through an area's pixels hit.
struct ModelImage {
    Rectangle area;
    std::vector<float> depth;      // along the camera's z axis; 0: no hit
    std::vector<float> tolerance;  // along the ray's depth
};

// The pixels that a placed model can cover; the whole picture if it reaches behind the camera.
Rectangle projected_area(const TriangleMesh& mesh, const Pose& T_camera_model,
                         const PictureCamera& camera) {
    const Rectangle all{0, 0, camera.pinhole.width, camera.pinhole.height};
    Vec2d low(1e9, 1e9);
    Vec2d high(-1e9, -1e9);
    for (const Vec3f& vertex : mesh.vertices) {
        const Vec3d point = T_camera_model * vertex.cast<double>();
        if (!(point.z() > 1e-9)) return all;
        const Vec2d pixel = camera.pinhole.project(point);
        low = low.cwiseMin(pixel);
        high = high.cwiseMax(pixel);
    }
    low = low.cwiseMax(-1e6).cwiseMin(1e6);
    high = high.cwiseMax(-1e6).cwiseMin(1e6);
    const int x = static_cast<int>(std::floor(low.x())) - kBorder;
    const int y = static_cast<int>(std::floor(low.y())) - kBorder;
    return intersection({x, y, static_cast<int>(std::ceil(high.x())) + kBorder + 1 - x,
                         static_cast<int>(std::ceil(high.y())) + kBorder + 1 - y},
                        all);
}

ModelImage cast_model(const RayScene& model, const Pose& T_camera_model,
                      const PictureCamera& camera, double tolerance) {
    ModelImage image;
    image.area = projected_area(model.mesh(0), T_camera_model, camera);
    const auto width = static_cast<std::size_t>(image.area.width);
    const auto height = static_cast<std::size_t>(image.area.height);
    image.depth.assign(width * height, 0.0F);
    image.tolerance.assign(width * height, 0.0F);
    const Pose T_model_camera = T_camera_model.inverse();
    const Vec3d origin = T_model_camera.translation();
    parallel_for(height, [&](std::size_t row) {
        std::vector<Vec3d> directions(width);
        for (std::size_t column = 0; column < width; ++column) {
            const Vec3d ray = camera.pinhole.ray(image.area.x + static_cast<double>(column),
                                                 image.area.y + static_cast<double>(row));
            directions[column] = T_model_camera.linear() * ray;
        }
        const std::vector<RayHit> hits = model.cast(origin, directions);
        for (std::size_t column = 0; column < width; ++column) {
            if (!hits[column].hit()) continue;
            const double cosine =
                std::abs(model.normal(hits[column]).dot(directions[column].normalized()));
            const std::size_t i = row * width + column;
            image.depth[i] = static_cast<float>(hits[column].distance);
            image.tolerance[i] = static_cast<float>(tolerance / std::max(cosine, kLeastCosine));
        }
    });
    return image;
}

std::vector<float> box_blur(const std::vector<float>& values, const Rectangle& area, int radius) {
    std::vector<float> across(values.size(), 0.0F);
    std::vector<float> result(values.size(), 0.0F);
    const float share = 1.0F / static_cast<float>(2 * radius + 1);
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(area.width) +
               static_cast<std::size_t>(x);
    };
    for (int y = 0; y < area.height; ++y) {
        for (int x = 0; x < area.width; ++x) {
            float sum = 0.0F;
            for (int i = std::max(0, x - radius); i <= std::min(area.width - 1, x + radius); ++i)
                sum += values[at(i, y)];
            across[at(x, y)] = sum * share;
        }
    }
    for (int y = 0; y < area.height; ++y) {
        for (int i = std::max(0, y - radius); i <= std::min(area.height - 1, y + radius); ++i) {
            for (int x = 0; x < area.width; ++x) result[at(x, y)] += across[at(x, i)] * share;
        }
    }
    return result;
}

// Of each pixel of the picture, the object that the scan agrees with best.
std::vector<std::uint32_t> assign_pixels(const std::vector<ModelImage>& images,
                                         const ScanRaster& scan, const PictureCamera& camera) {
    const auto columns = static_cast<std::size_t>(camera.pinhole.width);
    std::vector<std::uint32_t> owner(scan.depth.size(), kNoIndex);
    std::vector<float> best(scan.depth.size(), kFar);
    for (std::size_t object = 0; object < images.size(); ++object) {
        const ModelImage& image = images[object];
        const auto width = static_cast<std::size_t>(image.area.width);
        for (std::size_t i = 0; i < image.depth.size(); ++i) {
            const std::size_t pixel =
                (static_cast<std::size_t>(image.area.y) + i / width) * columns +
                static_cast<std::size_t>(image.area.x) + i % width;
            if (!(image.depth[i] > 0.0F) || !(scan.depth[pixel] > 0.0F)) continue;
            const float off = std::abs(image.depth[i] - scan.depth[pixel]);
            if (off > image.tolerance[i] || off >= best[pixel]) continue;
            best[pixel] = off;
            owner[pixel] = static_cast<std::uint32_t>(object);
        }
    }
    return owner;
}

// The value's distance to the nearest zero in its row and column directions (two passes).
Vec2d deepest_pixel(const std::vector<float>& mask, const Rectangle& area) {
    std::vector<float> reach(mask.size(), 0.0F);
    const auto at = [&](int x, int y) -> float& {
        return reach[static_cast<std::size_t>(y) * static_cast<std::size_t>(area.width) +
                     static_cast<std::size_t>(x)];
    };
    for (std::size_t i = 0; i < mask.size(); ++i) reach[i] = mask[i] > 0.5F ? kFar : 0.0F;
    const auto relax = [&](int x, int y, int dx, int dy, float step) {
        const bool inside =
            x + dx >= 0 && y + dy >= 0 && x + dx < area.width && y + dy < area.height;
        at(x, y) = std::min(at(x, y), (inside ? at(x + dx, y + dy) : 0.0F) + step);
    };
    for (int y = 0; y < area.height; ++y) {
        for (int x = 0; x < area.width; ++x) {
            relax(x, y, -1, 0, 1.0F);
            relax(x, y, 0, -1, 1.0F);
            relax(x, y, -1, -1, 1.414F);
            relax(x, y, 1, -1, 1.414F);
        }
    }
    Vec2d deepest(area.x + 0.5 * area.width, area.y + 0.5 * area.height);
    float depth = 0.0F;
    for (int y = area.height - 1; y >= 0; --y) {
        for (int x = area.width - 1; x >= 0; --x) {
            relax(x, y, 1, 0, 1.0F);
            relax(x, y, 0, 1, 1.0F);
            relax(x, y, 1, 1, 1.414F);
            relax(x, y, -1, 1, 1.414F);
            if (!(at(x, y) > depth)) continue;
            depth = at(x, y);
            deepest = Vec2d(area.x + x, area.y + y);
        }
    }
    return deepest;
}

ObjectLayer make_layer(const ModelImage& image, std::uint32_t object,
                       const std::vector<std::uint32_t>& owner, const PictureCamera& camera) {
    ObjectLayer layer;
    layer.area = image.area;
    if (image.depth.empty()) return layer;
    std::vector<float> covered(image.depth.size());
    std::vector<float> agreed(image.depth.size());
    for (int y = image.area.y; y < image.area.bottom(); ++y) {
        for (int x = image.area.x; x < image.area.right(); ++x) {
            const std::size_t i = layer.index(x, y);
            const std::size_t pixel =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.pinhole.width) +
                static_cast<std::size_t>(x);
            covered[i] = image.depth[i] > 0.0F ? 1.0F : 0.0F;
            agreed[i] = owner[pixel] == object ? 1.0F : 0.0F;
        }
    }
    // Single pixels that (dis)agree by noise follow the majority around them.
    std::vector<float> votes = box_blur(agreed, layer.area, kVoteRadius);
    const std::vector<float> voters = box_blur(covered, layer.area, kVoteRadius);
    for (std::size_t i = 0; i < votes.size(); ++i) {
        votes[i] = covered[i] > 0.0F && votes[i] > 0.5F * voters[i] ? 1.0F : 0.0F;
    }
    layer.anchor = deepest_pixel(votes, layer.area);
    const bool any = std::find(votes.begin(), votes.end(), 1.0F) != votes.end();
    if (!any) layer.anchor = deepest_pixel(covered, layer.area);
    layer.silhouette = box_blur(box_blur(covered, layer.area, 1), layer.area, 1);
    layer.visible = box_blur(votes, layer.area, 1);
    return layer;
}

}  // namespace

std::vector<ObjectLayer> object_layers(const ModelLibrary& library, const Recognition& recognition,
                                       const ScanRaster& scan, const PictureCamera& camera,
                                       double tolerance) {
    std::map<std::uint32_t, RayScene> models;
    std::vector<ModelImage> images;
    for (const RecognizedObject& object : recognition.objects) {
        const TriangleMesh& mesh = library.models[object.model_index].mesh;
        const auto model =
            models.try_emplace(object.model_index, std::vector<TriangleMesh>{mesh}).first;
        images.push_back(cast_model(model->second, camera.T_camera_scene * object.T_scene_model,
                                    camera, tolerance));
    }
    const std::vector<std::uint32_t> owner = assign_pixels(images, scan, camera);
    std::vector<ObjectLayer> layers(images.size());
    parallel_for(images.size(), [&](std::size_t i) {
        layers[i] = make_layer(images[i], static_cast<std::uint32_t>(i), owner, camera);
    });
    return layers;
}

}  // namespace ostraka
