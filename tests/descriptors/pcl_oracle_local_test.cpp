// SPDX-License-Identifier: Apache-2.0
// Our local descriptors and keypoints against PCL 1.13's: same clouds, same normals, same settings.
#include <gtest/gtest.h>
#include <pcl/features/fpfh.h>
#include <pcl/features/pfh.h>
#include <pcl/features/spin_image.h>
#include <pcl/filters/uniform_sampling.h>
#include <pcl/keypoints/iss_3d.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include "descriptors/shapes.hpp"
#include "ostraka/cloud/resample.hpp"
#include "ostraka/descriptors/fpfh.hpp"
#include "ostraka/descriptors/keypoint_detectors.hpp"
#include "ostraka/descriptors/pfh.hpp"
#include "ostraka/descriptors/spin_image.hpp"

namespace ostraka {
namespace {

using PclPoints = pcl::PointCloud<pcl::PointXYZ>;
using PclNormals = pcl::PointCloud<pcl::Normal>;
using PclTree = pcl::search::KdTree<pcl::PointXYZ>;

constexpr double kTolerance = 1e-3;

PclPoints::Ptr points_of(std::span<const Vec3f> points) {
    PclPoints::Ptr result(new PclPoints);
    for (const Vec3f& p : points) result->emplace_back(p.x(), p.y(), p.z());
    return result;
}

PclNormals::Ptr normals_of(std::span<const Vec3f> normals) {
    PclNormals::Ptr result(new PclNormals);
    for (const Vec3f& n : normals) result->emplace_back(n.x(), n.y(), n.z());
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

std::vector<std::uint32_t> every(const PointCloud& cloud, std::size_t count) {
    std::vector<std::uint32_t> result;
    for (std::size_t i = 0; i < count; ++i) {
        result.push_back(static_cast<std::uint32_t>(i * cloud.size() / count));
    }
    return result;
}

std::vector<Vec3f> at(const PointCloud& cloud, std::span<const std::uint32_t> indices) {
    std::vector<Vec3f> result;
    for (const std::uint32_t i : indices) result.push_back(cloud.points[i]);
    return result;
}

// How far all rows together are from PCL's, and the worst of them.
struct Difference {
    double difference = 0.0;
    double size = 0.0;
    double worst = 0.0;

    void add(std::span<const float> ours, std::span<const float> pcls) {
        for (std::size_t i = 0; i < ours.size(); ++i) {
            difference += std::abs(double{ours[i]} - pcls[i]);
            size += std::abs(pcls[i]);
        }
        worst = std::max(worst, shapes::relative_l1(ours, pcls));
    }
    double relative() const { return difference / size; }
};

TEST(PclOracleLocal, FpfhEqualsPcl) {
    for (const PointCloud& cloud : clouds()) {
        const auto radius = static_cast<float>(8.0 * mesh_resolution(cloud.points));
        const std::vector<std::uint32_t> indices = every(cloud, 150);
        const std::vector<Vec3f> keypoints = at(cloud, indices);
        pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal> fpfh;
        fpfh.setInputCloud(points_of(keypoints));
        fpfh.setSearchSurface(points_of(cloud.points));
        fpfh.setInputNormals(normals_of(cloud.normals));
        fpfh.setRadiusSearch(radius);
        fpfh.setSearchMethod(PclTree::Ptr(new PclTree));
        pcl::PointCloud<pcl::FPFHSignature33> expected;
        fpfh.compute(expected);
        const LocalDescriptors result = describe_fpfh(cloud, keypoints, {.radius = radius});
        const LocalDescriptors everywhere = describe_fpfh(cloud, {.radius = radius});
        Difference difference;
        for (std::size_t k = 0; k < keypoints.size(); ++k) {
            const auto row = std::span(result.rows).subspan(k * kFpfhLength, kFpfhLength);
            difference.add(row, expected[k].histogram);
            const auto same =
                std::span(everywhere.rows).subspan(indices[k] * kFpfhLength, kFpfhLength);
            EXPECT_TRUE(std::equal(row.begin(), row.end(), same.begin()));
        }
        EXPECT_LE(difference.relative(), kTolerance) << cloud.size();
        EXPECT_LE(difference.worst, kTolerance) << cloud.size();
    }
}

TEST(PclOracleLocal, PfhEqualsPcl) {
    for (const PointCloud& cloud : clouds()) {
        const auto radius = static_cast<float>(8.0 * mesh_resolution(cloud.points));
        const std::vector<Vec3f> keypoints = at(cloud, every(cloud, 40));
        pcl::PFHEstimation<pcl::PointXYZ, pcl::Normal> pfh;
        pfh.setInputCloud(points_of(keypoints));
        pfh.setSearchSurface(points_of(cloud.points));
        pfh.setInputNormals(normals_of(cloud.normals));
        pfh.setRadiusSearch(radius);
        pfh.setSearchMethod(PclTree::Ptr(new PclTree));
        pcl::PointCloud<pcl::PFHSignature125> expected;
        pfh.compute(expected);
        const LocalDescriptors result = describe_pfh(cloud, keypoints, {.radius = radius});
        Difference difference;
        for (std::size_t k = 0; k < keypoints.size(); ++k) {
            difference.add(std::span(result.rows).subspan(k * kPfhLength, kPfhLength),
                           expected[k].histogram);
        }
        EXPECT_LE(difference.relative(), kTolerance) << cloud.size();
        EXPECT_LE(difference.worst, kTolerance) << cloud.size();
    }
}

TEST(PclOracleLocal, SpinImagesEqualPcl) {
    for (const PointCloud& cloud : clouds()) {
        const auto radius = static_cast<float>(12.0 * mesh_resolution(cloud.points));
        const std::vector<std::uint32_t> indices = every(cloud, 100);
        for (const float cosine : {0.0F, 0.5F}) {
            pcl::SpinImageEstimation<pcl::PointXYZ, pcl::Normal, pcl::Histogram<153>> spin(8,
                                                                                           cosine);
            spin.setInputCloud(points_of(cloud.points));
            spin.setInputNormals(normals_of(cloud.normals));
            spin.setIndices(pcl::make_shared<pcl::Indices>(indices.begin(), indices.end()));
            spin.setRadiusSearch(radius);
            spin.setSearchMethod(PclTree::Ptr(new PclTree));
            pcl::PointCloud<pcl::Histogram<153>> expected;
            spin.compute(expected);
            const SpinImageSettings settings{.radius = radius, .support_cosine = cosine};
            const LocalDescriptors result =
                describe_spin_images(cloud, KdTree(cloud.points), at(cloud, indices), settings);
            Difference difference;
            for (std::size_t k = 0; k < indices.size(); ++k) {
                difference.add(std::span(result.rows).subspan(k * 153, 153), expected[k].histogram);
            }
            EXPECT_LE(difference.relative(), kTolerance) << cloud.size();
            EXPECT_LE(difference.worst, kTolerance) << cloud.size();
        }
    }
}

std::vector<std::array<float, 3>> sorted_positions(const PclPoints& points) {
    std::vector<std::array<float, 3>> result;
    for (const auto& p : points) result.push_back({p.x, p.y, p.z});
    std::sort(result.begin(), result.end());
    return result;
}

TEST(PclOracleLocal, IssKeypointsEqualPcls) {
    for (const PointCloud& cloud : clouds()) {
        const double mr = mesh_resolution(cloud.points);
        pcl::ISSKeypoint3D<pcl::PointXYZ, pcl::PointXYZ> iss;
        iss.setInputCloud(points_of(cloud.points));
        iss.setSearchMethod(PclTree::Ptr(new PclTree));
        const IssSettings settings{.salient_radius = static_cast<float>(6.0 * mr),
                                   .non_max_radius = static_cast<float>(4.0 * mr)};
        iss.setSalientRadius(settings.salient_radius);
        iss.setNonMaxRadius(settings.non_max_radius);
        PclPoints expected;
        iss.compute(expected);
        const std::vector<std::uint32_t> keypoints = detect_iss(cloud.points, settings);
        EXPECT_GE(keypoints.size(), 5U);
        auto pcls = sorted_positions(expected);
        const auto ours = sorted_positions(*points_of(at(cloud, keypoints)));
        // PCL finds keypoints on planes, too, where saliency is nothing but rounding.
        const KdTree tree(cloud.points);
        std::vector<Neighbor> neighbors;
        std::erase_if(pcls, [&](const std::array<float, 3>& p) {
            const Vec3f center(p[0], p[1], p[2]);
            tree.within(center, settings.salient_radius, neighbors);
            Mat3d scatter = Mat3d::Zero();
            for (const Neighbor& n : neighbors) {
                const Vec3d d = (cloud.points[n.index] - center).cast<double>();
                scatter += d * d.transpose();
            }
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
            return solver.eigenvalues()[0] < 1e-10 * solver.eigenvalues()[2];
        });
        EXPECT_EQ(ours, pcls) << cloud.size();
    }
}

TEST(PclOracleLocal, UniformKeypointsEqualPcls) {
    for (PointCloud cloud : clouds()) {
        // PCL adds 1 to all squared distances: in small units rounding decides.
        if (mesh_resolution(cloud.points) < 0.1) cloud = scaled(cloud, 1024.0);
        const auto spacing = static_cast<float>(5.0 * mesh_resolution(cloud.points));
        pcl::UniformSampling<pcl::PointXYZ> uniform;
        uniform.setInputCloud(points_of(cloud.points));
        uniform.setRadiusSearch(spacing);
        PclPoints expected;
        uniform.filter(expected);
        const auto ours = at(cloud, detect_uniform(cloud.points, {spacing}));
        EXPECT_EQ(sorted_positions(*points_of(ours)), sorted_positions(expected));
    }
}

}  // namespace
}  // namespace ostraka
