// SPDX-License-Identifier: Apache-2.0
// What all descriptors promise: lengths, names, finite rows on hostile input, invariances.
#include "ostraka/descriptors/descriptor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "descriptors/shapes.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/cloud/resample.hpp"

namespace ostraka {
namespace {

PointCloud permuted(const PointCloud& cloud, std::uint64_t seed) {
    std::vector<std::uint32_t> order(cloud.size());
    std::iota(order.begin(), order.end(), 0U);
    Random random(seed);
    for (std::size_t i = order.size() - 1; i > 0; --i) {
        std::swap(order[i], order[random.below(static_cast<std::uint32_t>(i + 1))]);
    }
    return select(cloud, order);
}

Pose some_motion(std::uint64_t seed) {
    Random random(seed);
    Pose motion = Pose::Identity();
    motion.linear() = random.rotation();
    motion.translation() = 30.0 * random.direction();
    return motion;
}

// With colors that change across the cloud, for the descriptors that need them.
PointCloud colored(PointCloud cloud) {
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        cloud.colors.push_back({static_cast<std::uint8_t>(i * 7), static_cast<std::uint8_t>(i / 3),
                                static_cast<std::uint8_t>(255 - i * 5)});
    }
    return cloud;
}

// Lengths and kinds, in the order of AnyDescriptor.
struct Expected {
    const char* name;
    std::size_t length;
    DescriptorKind kind;
};
const std::vector<Expected> kFamily = {
    {"vfh", 308, DescriptorKind::global},       {"esf", 640, DescriptorKind::global},
    {"gasd", 512, DescriptorKind::global},      {"shot", 352, DescriptorKind::global},
    {"rops", 135, DescriptorKind::global},      {"gasd_color", 984, DescriptorKind::global},
    {"cvfh", 308, DescriptorKind::regional},    {"our_cvfh", 308, DescriptorKind::regional},
    {"shot_local", 352, DescriptorKind::local}, {"rops_local", 135, DescriptorKind::local},
    {"pfh", 125, DescriptorKind::local},        {"fpfh", 33, DescriptorKind::local},
    {"spin_image", 153, DescriptorKind::local},
};

// Rows far apart at most 1: the mean distance of two rows over the mean size of a row.
double difference(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() ? shapes::relative_l1(a, b) : 1.0;
}

TEST(Descriptor, RowsHaveTheLengthAndNumberTheyAnnounce) {
    const PointCloud cloud = colored(shapes::bumpy_ellipsoid(300));
    const auto descriptors = all_descriptors();
    ASSERT_EQ(descriptors.size(), kFamily.size());
    for (std::size_t i = 0; i < kFamily.size(); ++i) {
        const std::size_t length = kFamily[i].length;
        const std::size_t size = describe(cloud, descriptors[i]).size();
        EXPECT_EQ(descriptor_name(descriptors[i]), kFamily[i].name);
        EXPECT_EQ(descriptor_length(descriptors[i]), length);
        EXPECT_EQ(descriptor_kind(descriptors[i]), kFamily[i].kind) << kFamily[i].name;
        EXPECT_EQ(descriptors[i].index(), i);
        EXPECT_GE(size, length);
        EXPECT_EQ(size % length, 0U) << kFamily[i].name;
        if (kFamily[i].kind == DescriptorKind::regional) continue;
        EXPECT_EQ(size, kFamily[i].kind == DescriptorKind::local ? 300 * length : length);
    }
}

TEST(Descriptor, TheGlobalOnesAreTheFirstFive) {
    const auto all = all_descriptors();
    const auto global = global_descriptors();
    ASSERT_EQ(global.size(), 5U);
    for (std::size_t i = 0; i < global.size(); ++i) EXPECT_EQ(global[i].index(), all[i].index());
}

TEST(Descriptor, LocalRowsAreThoseOfEveryPoint) {
    const PointCloud cloud = shapes::bumpy_ellipsoid(400);
    const KdTree tree(cloud.points);
    const auto radius = static_cast<float>(15.0 * mesh_resolution(cloud.points));
    EXPECT_EQ(describe(cloud, ShotSettings{}),
              describe_shot(cloud, tree, cloud.points, {.radius = radius}).rows);
    EXPECT_EQ(describe(cloud, ShotSettings{.radius = 20.0F}),
              describe_shot(cloud, tree, cloud.points, {.radius = 20.0F}).rows);
    EXPECT_EQ(
        describe(cloud, RopsSettings{}),
        describe_rops(cloud, tree, triangulate(cloud), cloud.points, {.radius = radius}).rows);
}

TEST(Descriptor, NamesAreParsedBack) {
    for (const AnyDescriptor& descriptor : all_descriptors()) {
        const auto parsed = parse_descriptor(descriptor_name(descriptor));
        ASSERT_TRUE(parsed.has_value());
        EXPECT_EQ(parsed->index(), descriptor.index());
    }
    EXPECT_EQ(descriptor_name(GlobalShotSettings{}), "shot");
    EXPECT_FALSE(parse_descriptor("").has_value());
    EXPECT_FALSE(parse_descriptor("VFH").has_value());
}

TEST(Descriptor, UnusableCloudsAreRejected) {
    PointCloud two = colored(shapes::bumpy_ellipsoid(2));
    PointCloud bare = colored(shapes::bumpy_ellipsoid(10));
    bare.normals.clear();
    PointCloud hole = colored(shapes::bumpy_ellipsoid(10));
    hole.points[4].y() = std::numeric_limits<float>::quiet_NaN();
    PointCloud endless = colored(shapes::bumpy_ellipsoid(10));
    endless.points[4].y() = std::numeric_limits<float>::infinity();
    for (const AnyDescriptor& descriptor : all_descriptors()) {
        for (const PointCloud* cloud : {&two, &bare, &hole, &endless}) {
            EXPECT_THROW(describe(*cloud, descriptor), InvalidInput);
        }
        EXPECT_THROW(describe({}, descriptor), InvalidInput);
    }
}

// Clouds on which one or another descriptor is not defined.
std::vector<PointCloud> hostile_clouds() {
    std::vector<PointCloud> clouds;
    const auto add = [&clouds](std::size_t count, auto&& point) {
        PointCloud cloud;
        for (std::size_t i = 0; i < count; ++i)
            cloud.points.push_back(point(static_cast<float>(i)));
        cloud.normals.assign(count, Vec3f(0, 0, 1));
        cloud.viewpoint = Vec3f(0, 0, 10);
        clouds.push_back(cloud);
    };
    add(50, [](float) -> Vec3f { return Vec3f(1, 2, 3); });
    add(3, [](float i) -> Vec3f { return Vec3f(i, 0, 0); });
    add(3, [](float i) -> Vec3f { return Vec3f(i, i * i, 0); });
    add(100, [](float i) -> Vec3f { return Vec3f(i, 0, 0); });
    add(100, [](float i) -> Vec3f { return Vec3f(0.1F * i, 0.2F * i, -0.3F * i); });
    add(100, [](float i) -> Vec3f { return Vec3f(std::floor(i / 10), std::fmod(i, 10.0F), 0); });
    add(100, [](float i) -> Vec3f { return Vec3f(std::floor(i / 50), std::fmod(i, 2.0F), 0); });
    add(100, [](float i) -> Vec3f { return Vec3f(i < 99 ? 0.0F : 1.0F, 0, 0); });
    add(60, [](float i) -> Vec3f { return Vec3f(std::cos(i), std::sin(i), 0.1F * i) * 1e-30F; });
    add(60, [](float i) -> Vec3f { return Vec3f(std::cos(i), std::sin(i), 0.1F * i) * 1e-18F; });
    add(60, [](float i) -> Vec3f { return Vec3f(std::cos(i), std::sin(i), 0.1F * i) * 1e11F; });
    add(60, [](float i) -> Vec3f { return Vec3f(std::cos(i), std::sin(i), i < 59 ? 0.0F : 1e9F); });
    add(60, [](float i) -> Vec3f {
        return Vec3f(1e6F + std::cos(i), 1e6F + std::sin(i), 1e6F + 0.1F * i);
    });
    PointCloud nans = shapes::bumpy_ellipsoid(100);
    nans.normals.assign(100, Vec3f::Constant(std::numeric_limits<float>::quiet_NaN()));
    clouds.push_back(nans);
    PointCloud zeros = shapes::bumpy_ellipsoid(100);
    zeros.normals.assign(100, Vec3f::Zero());
    clouds.push_back(zeros);
    PointCloud huge = shapes::bumpy_ellipsoid(100);
    for (Vec3f& normal : huge.normals) normal *= 1e30F;
    clouds.push_back(huge);
    PointCloud seen_from_within = shapes::bumpy_ellipsoid(100);
    seen_from_within.viewpoint = centroid(seen_from_within.points).cast<float>();
    clouds.push_back(seen_from_within);
    PointCloud organized = shapes::bumpy_ellipsoid(100);
    organized.width = 10;
    organized.height = 10;
    clouds.push_back(organized);
    for (PointCloud& cloud : clouds) cloud = colored(cloud);
    return clouds;
}

TEST(Descriptor, RowsAreFiniteOnHostileClouds) {
    std::size_t number = 0;
    for (const PointCloud& cloud : hostile_clouds()) {
        for (const AnyDescriptor& descriptor : all_descriptors()) {
            const auto row = describe(cloud, descriptor);
            const bool finite =
                std::all_of(row.begin(), row.end(), [](float v) { return std::isfinite(v); });
            EXPECT_TRUE(finite) << descriptor_name(descriptor) << " on cloud " << number;
        }
        ++number;
    }
}

TEST(Descriptor, EqualPointsGiveZerosWhereNothingIsDefined) {
    const PointCloud cloud = hostile_clouds().front();
    for (const char* name :
         {"esf", "gasd", "shot", "rops", "gasd_color", "shot_local", "rops_local", "fpfh"}) {
        const auto row = describe(cloud, *parse_descriptor(name));
        EXPECT_EQ(row, std::vector<float>(row.size(), 0.0F)) << name;
    }
}

TEST(Descriptor, RigidMotionKeepsTheRow) {
    // Moving rounds the coordinates, so that a few points change bins (VFH, GASD's shells, RoPS);
    // only SHOT is continuous. A point more or less moves a region's frame. ESF's voxels don't turn
    // with the cloud: it stays within its sampling noise.
    const std::map<std::string_view, double> tolerances = {
        {"vfh", 2e-3},        {"esf", 0.2},         {"gasd", 4e-3}, {"shot", 1e-3},
        {"rops", 2e-2},       {"gasd_color", 2e-2}, {"cvfh", 2e-2}, {"our_cvfh", 6e-2},
        {"shot_local", 2e-3}, {"rops_local", 5e-2}, {"pfh", 2e-2},  {"fpfh", 2e-2},
        {"spin_image", 2e-2}};
    for (const AnyDescriptor& descriptor : all_descriptors()) {
        const bool local = descriptor_kind(descriptor) == DescriptorKind::local;
        const std::size_t count = local ? 500 : 3'000;
        for (const PointCloud& shape : {shapes::bumpy_ellipsoid(count), shapes::cut_torus(count)}) {
            const PointCloud cloud = colored(shape);
            const auto rows = describe(cloud, descriptor);
            for (std::uint64_t seed = 0; seed < 5; ++seed) {
                EXPECT_LE(
                    difference(describe(transformed(cloud, some_motion(seed)), descriptor), rows),
                    tolerances.at(descriptor_name(descriptor)))
                    << descriptor_name(descriptor);
            }
        }
    }
}

TEST(Descriptor, OrderOfThePointsChangesNoBit) {
    const PointCloud cloud = colored(shapes::bumpy_ellipsoid(2'500));
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const PointCloud other = permuted(cloud, seed);
        for (const char* name : {"vfh", "gasd", "shot", "gasd_color"}) {
            const AnyDescriptor descriptor = *parse_descriptor(name);
            EXPECT_EQ(describe(other, descriptor), describe(cloud, descriptor)) << name;
        }
    }
}

TEST(Descriptor, ScaleKeepsTheRowOfGasdEsfShotAndRops) {
    // A power of two scales floats exactly. VFH's viewpoint block depends on the unit, as in PCL.
    const PointCloud cloud = shapes::notched_box(2'000);
    const PointCloud larger = scaled(cloud, 8.0);
    for (const char* name : {"esf", "gasd", "shot", "rops"}) {
        const AnyDescriptor descriptor = *parse_descriptor(name);
        EXPECT_LE(shapes::relative_l1(describe(larger, descriptor), describe(cloud, descriptor)),
                  name == std::string("rops") ? 1e-2 : 1e-4)
            << name;
    }
}

TEST(Descriptor, ThreadCountChangesNoBit) {
    const PointCloud cloud = colored(shapes::cut_torus(1'000));
    for (const AnyDescriptor& descriptor : all_descriptors()) {
        set_thread_count(1);
        const auto one = describe(cloud, descriptor);
        set_thread_count(0);
        EXPECT_EQ(describe(cloud, descriptor), one) << descriptor_name(descriptor);
    }
}

TEST(Descriptor, DifferentShapesDiffer) {
    // Guards against rows that are invariant because they are constant.
    const PointCloud a = shapes::bumpy_ellipsoid(2'000);
    const PointCloud b = shapes::cut_torus(2'000);
    const PointCloud again = shapes::bumpy_ellipsoid(2'000, 99);
    for (const AnyDescriptor& descriptor : global_descriptors()) {
        const auto row = describe(a, descriptor);
        const double other = shapes::relative_l1(describe(b, descriptor), row);
        const double same = shapes::relative_l1(describe(again, descriptor), row);
        EXPECT_GT(other, 1.5 * same) << descriptor_name(descriptor);
    }
}

}  // namespace
}  // namespace ostraka
