// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/icp_redundancy.hpp"

#include <gtest/gtest.h>

#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"
#include "ostraka/library/build.hpp"
#include "ostraka/library/model_record.hpp"
#include "support/simple_models.hpp"

namespace ostraka {
namespace {

constexpr double kSampling = 2.0;

// A curved patch, unlike others of another seed.
PointCloud patch(std::uint64_t seed) {
    Random random(seed);
    const float bend = 0.01F + 0.02F * static_cast<float>(random.uniform());
    const float skew = 0.02F * static_cast<float>(random.uniform());
    PointCloud cloud;
    for (float x = -40.0F; x <= 40.0F; x += 2.0F) {
        for (float y = -20.0F; y <= 20.0F; y += 2.0F) {
            if (x > 10.0F && y > 0.0F) continue;  // lopsided, so that signs are clear
            cloud.points.emplace_back(x, y, bend * x * x + skew * y * y);
            cloud.normals.push_back(Vec3f(-2.0F * bend * x, -2.0F * skew * y, 1.0F).normalized());
        }
    }
    cloud.viewpoint = Vec3f(0, 0, 500);
    return cloud;
}

Pose some_motion() {
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(1.1, Vec3d(1, 2, -1).normalized()).toRotationMatrix();
    pose.translation() = Vec3d(30, -12, 7);
    return pose;
}

TEST(DropByIcp, KeepsOneOfSeveralPosesOfAPieceAndAllThatDiffer) {
    const PointCloud a = patch(1);
    const PointCloud b = patch(2);
    const std::vector<PointCloud> clouds = {a, b, transformed(a, some_motion()),
                                            transformed(b, some_motion())};
    EXPECT_EQ(drop_by_icp(clouds, kSampling), (std::vector<std::uint32_t>{0, 1}));
    EXPECT_TRUE(drop_by_icp({}, kSampling).empty());
}

TEST(DropByIcp, IsTheSameForAnyNumberOfThreads) {
    LibrarySettings settings = testing::quick_settings();
    settings.selection = {.redundancy = Redundancy::icp, .budget = 0, .spread = 0};
    settings.views.count = 12;
    settings.descriptors.resize(1);
    const auto models = testing::simple_models();
    set_thread_count(1);
    const ModelLibrary one = build_library(models, settings);
    set_thread_count(4);
    const ModelLibrary four = build_library(models, settings);
    set_thread_count(0);
    EXPECT_EQ(one.tables[0].rows, four.tables[0].rows);
    settings.selection.redundancy = Redundancy::none;
    const ModelLibrary none = build_library(models, settings);
    EXPECT_LT(one.entries.size(), none.entries.size());
    EXPECT_GT(one.models[0].counts.redundant, 0);
    EXPECT_EQ(none.models[0].counts.redundant, 0);
    settings.selection.budget = 10;
    const ModelLibrary ten = build_library(models, settings);
    EXPECT_EQ(ten.entries.size(), 20U);
    const ModelLibrary thinned = thin_library(none, 10);
    EXPECT_EQ(thinned.tables[0].rows, ten.tables[0].rows);
    EXPECT_EQ(thinned.entries.back().direction, ten.entries.back().direction);
}

}  // namespace
}  // namespace ostraka
