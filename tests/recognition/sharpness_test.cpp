// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/sharpness.hpp"

#include <numeric>

#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

using namespace recognition_testing;

// The model's own surface as a scan.
Scan surface_scan(std::uint32_t model, const Pose& T_scene_model) {
    const double sampling = library().settings.sampling;
    Scan scan{.ranges = RangeMap({}, {}, {}, sampling), .sampling = sampling};
    const PointCloud& surface = library().models[model].surface;
    for (std::size_t i = 0; i < surface.size(); ++i) {
        const Vec3d at = T_scene_model * surface.points[i].cast<double>();
        const Vec3d normal = T_scene_model.linear() * surface.normals[i].cast<double>();
        scan.cloud.points.push_back(at.cast<float>());
        scan.cloud.normals.push_back(normal.cast<float>());
    }
    return scan;
}

std::vector<std::uint32_t> all_of(const Scan& scan) {
    std::vector<std::uint32_t> points(scan.cloud.size());
    std::iota(points.begin(), points.end(), 0U);
    return points;
}

Pose anywhere(std::uint64_t seed) {
    return disturbed(Pose::Identity(), Vec3d(40, 30, 20), 2.0, 50.0, seed);
}

TEST(Sharpness, APieceOfAPlaneSlides) {
    const Scan scan = surface_scan(kPlate, Pose::Identity());
    // The lower face, farther from its edges than it is moved.
    std::vector<std::uint32_t> inner;
    for (const std::uint32_t i : all_of(scan)) {
        const Vec3f& at = scan.cloud.points[i];
        const bool lower = at.z() < 0.5F && scan.cloud.normals[i].z() < -0.99F;
        if (lower && at.x() > 12 && at.x() < 78 && at.y() > 12 && at.y() < 48) inner.push_back(i);
    }
    ASSERT_GT(inner.size(), 100U);
    EXPECT_NEAR(sharpness(scan, probe(kPlate), Pose::Identity(), inner), 0.0, 0.01);
}

TEST(Sharpness, AWholePartStaysPutWhereverItIs) {
    for (const std::uint32_t model : {kCorner, kPlate}) {
        std::vector<double> found;
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            const Pose truth = anywhere(seed);
            const Scan scan = surface_scan(model, truth);
            found.push_back(sharpness(scan, probe(model), truth, all_of(scan)));
        }
        EXPECT_GT(found[0], 0.15);
        // The field's cells turn with the model, not with the scan.
        for (const double one : found) EXPECT_NEAR(one, found[0], 0.01);
    }
}

TEST(Sharpness, WhereAPoseIsOffAMoveMayHelp) {
    const Pose truth = anywhere(7);
    const Scan scan = surface_scan(kCorner, truth);
    const Pose off = truth * Eigen::Translation3d(8.0, 0.0, 0.0);
    EXPECT_LT(sharpness(scan, probe(kCorner), off, all_of(scan)),
              sharpness(scan, probe(kCorner), truth, all_of(scan)) - 0.1);
}

TEST(Sharpness, NothingToJudgeIsZero) {
    const Scan scan = surface_scan(kCorner, Pose::Identity());
    EXPECT_EQ(sharpness(scan, probe(kCorner), Pose::Identity(), {}), 0.0);
}

}  // namespace
}  // namespace ostraka
