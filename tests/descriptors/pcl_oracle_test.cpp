// SPDX-License-Identifier: Apache-2.0
// Our rows against PCL 1.13's: same clouds, same normals, same settings.
#include <gtest/gtest.h>
#include <pcl/features/esf.h>
#include <pcl/features/gasd.h>
#include <pcl/features/rops_estimation.h>
#include <pcl/features/shot.h>
#include <pcl/features/vfh.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <atomic>
#include <ctime>

#include "descriptors/shapes.hpp"
#include "ostraka/descriptors/descriptor.hpp"
#include "ostraka/descriptors/exact_sum.hpp"

// PCL's ESF seeds its numbers by this: the test's own clock makes its runs the same each time.
namespace {
std::atomic<std::time_t> pcl_seed{0};
}
extern "C" std::time_t time(std::time_t* out) noexcept {
    const std::time_t now = pcl_seed;
    if (out != nullptr) *out = now;
    return now;
}

namespace ostraka {
namespace {

using PclPoints = pcl::PointCloud<pcl::PointXYZ>;
using PclNormals = pcl::PointCloud<pcl::Normal>;

constexpr double kTolerance = 1e-3;

PclPoints::Ptr points_of(std::span<const Vec3f> points) {
    PclPoints::Ptr result(new PclPoints);
    for (const Vec3f& p : points) result->emplace_back(p.x(), p.y(), p.z());
    return result;
}

PclNormals::Ptr normals_of(const PointCloud& cloud) {
    PclNormals::Ptr result(new PclNormals);
    for (const Vec3f& n : cloud.normals) result->emplace_back(n.x(), n.y(), n.z());
    return result;
}

// The shapes at several sizes and, where OSTRAKA_DATA names a folder that has it, the bunny.
std::vector<PointCloud> clouds() {
    std::vector<PointCloud> result;
    for (const std::size_t count : {700, 2'000, 6'000}) {
        for (PointCloud& cloud : shapes::all(count)) result.push_back(std::move(cloud));
    }
    if (const char* data = std::getenv("OSTRAKA_DATA")) {
        PointCloud bunny = shapes::ply_view(std::string(data) + "/bologna/models/bunny.ply", 3);
        if (!bunny.empty()) result.push_back(std::move(bunny));
    }
    return result;
}

double radius_of(const PointCloud& cloud) {
    return largest_distance(cloud.points, centroid(cloud.points));
}

std::vector<Vec3f> every(const PointCloud& cloud, std::size_t step) {
    std::vector<Vec3f> result;
    for (std::size_t i = 0; i < cloud.size(); i += step) result.push_back(cloud.points[i]);
    return result;
}

TEST(PclOracle, VfhEqualsPcl) {
    for (const PointCloud& cloud : clouds()) {
        pcl::VFHEstimation<pcl::PointXYZ, pcl::Normal> vfh;
        vfh.setInputCloud(points_of(cloud.points));
        vfh.setInputNormals(normals_of(cloud));
        vfh.setViewPoint(cloud.viewpoint.x(), cloud.viewpoint.y(), cloud.viewpoint.z());
        vfh.setSearchMethod(
            pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
        pcl::PointCloud<pcl::VFHSignature308> output;
        vfh.compute(output);
        const auto row = describe_vfh(cloud, {.pcl_viewpoint_length = true});
        EXPECT_LE(shapes::relative_l1(row, output[0].histogram), kTolerance) << cloud.size();
    }
}

TEST(PclOracle, GasdEqualsPcl) {
    for (const PointCloud& cloud : clouds()) {
        const Vec3f view = centroid(cloud.points).cast<float>() - cloud.viewpoint;
        pcl::GASDEstimation<pcl::PointXYZ> gasd(Eigen::Vector3f(view.normalized()));
        gasd.setInputCloud(points_of(cloud.points));
        pcl::PointCloud<pcl::GASDSignature512> output;
        gasd.compute(output);
        GasdSettings settings;
        settings.x_sign = GasdSettings::AxisSign::pcl;
        const auto row = describe_gasd(cloud, settings);
        EXPECT_LE(shapes::relative_l1(row, output[0].histogram), kTolerance) << cloud.size();
        const Mat3d R = gasd_frame(cloud, settings).R_aligned_cloud;
        const Eigen::Matrix3f expected = gasd.getTransform().topLeftCorner<3, 3>();
        EXPECT_LE((R.cast<float>() - expected).norm(), 1e-3F);
    }
}

TEST(PclOracle, EsfLiesWithinPclsOwnSpread) {
    for (const PointCloud& cloud : {shapes::bumpy_ellipsoid(2'000), shapes::notched_box(3'000)}) {
        std::vector<std::vector<float>> rows;
        for (int run = 0; run < 4; ++run) {
            pcl_seed = 1 + run;  // glibc takes 0 for 1
            pcl::ESFEstimation<pcl::PointXYZ> esf;
            esf.setInputCloud(points_of(cloud.points));
            pcl::PointCloud<pcl::ESFSignature640> output;
            esf.compute(output);
            rows.emplace_back(output[0].histogram, output[0].histogram + kEsfLength);
        }
        double spread = 0.0;
        int pairs = 0;
        for (std::size_t a = 0; a < rows.size(); ++a) {
            for (std::size_t b = 0; b < a; ++b) {
                spread += shapes::relative_l1(rows[a], rows[b]);
                ++pairs;
            }
        }
        spread /= pairs;
        double distance = 0.0;
        double largest = 0.0;
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            const auto row = describe_esf(cloud, {.seed = seed});
            for (const auto& other : rows) {
                distance += shapes::relative_l1(row, other) / 16.0;
                largest = std::max(largest, shapes::relative_l1(row, other));
            }
        }
        EXPECT_GT(spread, 0.0);
        EXPECT_LE(distance, 1.1 * spread);
        EXPECT_LE(largest, 1.5 * spread);
    }
}

// PCL's SHOT at points that need not belong to the surface.
pcl::PointCloud<pcl::SHOT352> pcl_shot(const PointCloud& cloud, std::span<const Vec3f> keypoints,
                                       double radius) {
    pcl::SHOTEstimation<pcl::PointXYZ, pcl::Normal> shot;
    shot.setInputCloud(points_of(keypoints));
    shot.setSearchSurface(points_of(cloud.points));
    shot.setInputNormals(normals_of(cloud));
    shot.setRadiusSearch(radius);
    shot.setLRFRadius(static_cast<float>(radius));
    shot.setSearchMethod(
        pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
    pcl::PointCloud<pcl::SHOT352> output;
    shot.compute(output);
    return output;
}

// Whether the support is a plane up to rounding: then rounding decides the sign of z, here as in
// PCL.
bool flat(const PointCloud& cloud, const KdTree& tree, const Vec3f& keypoint, float radius,
          const Mat3f& frame) {
    std::vector<Neighbor> neighbors;
    tree.within(keypoint, radius, neighbors);
    float height = 0.0F;
    for (const Neighbor& neighbor : neighbors) {
        const Vec3f offset = cloud.points[neighbor.index] - keypoint;
        height = std::max(height, std::abs((frame * offset).z()));
    }
    return height < 1e-4F * radius;
}

struct Agreement {
    double difference = 0.0;  // of all rows, L1
    double size = 0.0;
    int rows = 0;
    int unequal = 0;  // rows beyond the tolerance

    void add(std::span<const float> ours, std::span<const float> pcls) {
        ++rows;
        if (!(shapes::relative_l1(ours, pcls) <= kTolerance)) ++unequal;
        for (std::size_t i = 0; i < ours.size(); ++i) {
            difference += std::abs(double{ours[i]} - pcls[i]);
            size += std::abs(pcls[i]);
        }
    }
};

TEST(PclOracle, ShotEqualsPcl) {
    for (const PointCloud& cloud : clouds()) {
        const float radius = static_cast<float>(radius_of(cloud)) * 0.3F;
        const std::vector<Vec3f> keypoints = every(cloud, cloud.size() / 150);
        const auto expected = pcl_shot(cloud, keypoints, radius);
        const KdTree tree(cloud.points);
        const LocalDescriptors result = describe_shot(cloud, tree, keypoints, {.radius = radius});
        Agreement agreement;
        for (std::size_t k = 0; k < keypoints.size(); ++k) {
            if (flat(cloud, tree, keypoints[k], radius, result.frames[k])) continue;
            const std::span<const float> row(result.rows.data() + k * kShotLength, kShotLength);
            agreement.add(row, expected[k].descriptor);
            const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> frame(
                expected[k].rf);
            EXPECT_LE((result.frames[k] - frame).norm(), 1e-4F);
        }
        EXPECT_GE(agreement.rows, 40);
        EXPECT_EQ(agreement.unequal, 0) << "of " << agreement.rows << ", cloud " << cloud.size();
    }
}

TEST(PclOracle, GlobalShotEqualsPcl) {
    for (const PointCloud& cloud : clouds()) {
        const std::vector<Vec3f> center = {exact_centroid(cloud.points).cast<float>()};
        const auto radius = static_cast<float>(1.0001 * radius_of(cloud));
        const auto expected = pcl_shot(cloud, center, radius);
        const auto row = describe_global_shot(cloud);
        EXPECT_LE(shapes::relative_l1(row, expected[0].descriptor), kTolerance) << cloud.size();
    }
}

pcl::PointCloud<pcl::Histogram<135>> pcl_rops(const PointCloud& cloud,
                                              std::span<const IndexTriangle> triangles,
                                              std::span<const Vec3f> keypoints, float radius) {
    std::vector<pcl::Vertices> polygons;
    for (const IndexTriangle& t : triangles) {
        pcl::Vertices polygon;
        polygon.vertices.assign(t.begin(), t.end());
        polygons.push_back(polygon);
    }
    pcl::ROPSEstimation<pcl::PointXYZ, pcl::Histogram<135>> rops;
    rops.setInputCloud(points_of(keypoints));
    rops.setSearchSurface(points_of(cloud.points));
    rops.setRadiusSearch(radius);
    rops.setSupportRadius(radius);
    rops.setTriangles(polygons);
    rops.setSearchMethod(
        pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
    pcl::PointCloud<pcl::Histogram<135>> output;
    rops.compute(output);
    return output;
}

TEST(PclOracle, RopsEqualsPcl) {
    for (const PointCloud& cloud : clouds()) {
        const float radius = static_cast<float>(radius_of(cloud)) * 0.4F;
        const std::vector<Vec3f> keypoints = every(cloud, cloud.size() / 150);
        const auto triangles = triangulate(cloud);
        const auto expected = pcl_rops(cloud, triangles, keypoints, radius);
        const KdTree tree(cloud.points);
        const auto result = describe_rops(cloud, tree, triangles, keypoints, {.radius = radius});
        Agreement agreement;
        for (std::size_t k = 0; k < keypoints.size(); ++k) {
            if (flat(cloud, tree, keypoints[k], radius, result.frames[k])) continue;
            const std::span<const float> row(result.rows.data() + k * kRopsLength, kRopsLength);
            agreement.add(row, expected[k].histogram);
        }
        // PCL's frame has float's accuracy: now and then one point falls into another bin.
        EXPECT_GE(agreement.rows, 40);
        EXPECT_LE(agreement.difference, kTolerance * agreement.size) << cloud.size();
        EXPECT_LE(agreement.unequal, agreement.rows / 40 + 1) << cloud.size();
    }
}

TEST(PclOracle, GlobalRopsEqualsPcl) {
    for (const PointCloud& cloud : clouds()) {
        const std::vector<Vec3f> center = {exact_centroid(cloud.points).cast<float>()};
        const auto radius = static_cast<float>(1.0001 * radius_of(cloud));
        const auto triangles = triangulate(cloud);
        const auto expected = pcl_rops(cloud, triangles, center, radius);
        const auto row = describe_global_rops(cloud);
        EXPECT_LE(shapes::relative_l1(row, expected[0].histogram), kTolerance) << cloud.size();
    }
}

}  // namespace
}  // namespace ostraka
