// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/face_matching.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "ostraka/base/random.hpp"

namespace ostraka {
namespace {

const Vec3d kBox(60.0, 40.0, 20.0);

// The part of a face of the box that faces `side` along `axis`, between two shares of the other
// axes.
FlatFace face_of_box(int axis, double side, const Vec2d& low = Vec2d::Zero(),
                     const Vec2d& high = Vec2d::Ones()) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    FlatFace face;
    for (int corner = 0; corner < 4; ++corner) {
        Vec3d at;
        at[axis] = side > 0.0 ? kBox[axis] : 0.0;
        at[u] = kBox[u] * (corner % 2 == 0 ? low.x() : high.x());
        at[v] = kBox[v] * (corner / 2 == 0 ? low.y() : high.y());
        face.outline.push_back(at);
        face.center += 0.25 * at;
    }
    face.axes.setZero();
    face.axes(u, 0) = 1.0;
    face.axes(v, 1) = side;
    face.axes(axis, 2) = side;
    return face;
}

std::vector<FlatFace> box() {
    std::vector<FlatFace> faces;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) faces.push_back(face_of_box(axis, side));
    }
    return faces;
}

FlatFace moved(const Pose& T, FlatFace face) {
    face.center = T * face.center;
    face.axes = T.linear() * face.axes;
    for (Vec3d& corner : face.outline) corner = T * corner;
    return face;
}

Pose some_pose(std::uint64_t seed) {
    Random random(seed);
    Pose pose = Pose::Identity();
    pose.linear() = random.rotation();
    pose.translation() = 200.0 * random.direction();
    return pose;
}

Vec3d corner_of_box(int corner) {
    return {corner % 2 == 0 ? 0.0 : kBox.x(), corner / 2 % 2 == 0 ? 0.0 : kBox.y(),
            corner / 4 == 0 ? 0.0 : kBox.z()};
}

// Largest distance from a corner of the box to the nearest one of the true box: turns of the box
// onto itself are no error.
double error_of(const Pose& pose, const Pose& truth) {
    double worst = 0.0;
    for (int i = 0; i < 8; ++i) {
        double best = 1e9;
        for (int j = 0; j < 8; ++j) {
            best = std::min(best, (pose * corner_of_box(i) - truth * corner_of_box(j)).norm());
        }
        worst = std::max(worst, best);
    }
    return worst;
}

double best_error(const std::vector<Pose>& poses, const Pose& truth) {
    double best = 1e9;
    for (const Pose& pose : poses) best = std::min(best, error_of(pose, truth));
    return best;
}

// Points one unit apart on the whole surface of the box.
PointCloud surface_of_box() {
    PointCloud cloud;
    for (const FlatFace& face : box()) {
        const Vec3d u = face.outline[1] - face.outline[0];
        const Vec3d v = face.outline[2] - face.outline[0];
        for (double s = 0.5; s < u.norm(); s += 1.0) {
            for (double t = 0.5; t < v.norm(); t += 1.0) {
                const Vec3d at = face.outline[0] + s * u.normalized() + t * v.normalized();
                cloud.points.push_back(at.cast<float>());
                cloud.normals.push_back(face.normal().cast<float>());
            }
        }
    }
    cloud.viewpoint = Vec3f(300.0F, 200.0F, 400.0F);
    return cloud;
}

TEST(FlatFaces, ABoxHasSixThatFaceOutward) {
    const auto faces = flat_faces(surface_of_box(), 1.0);
    ASSERT_EQ(faces.size(), 6U);
    for (const FlatFace& face : faces) {
        const Vec3d outward = face.center - 0.5 * kBox;
        EXPECT_GT(face.normal().dot(outward.normalized()), 0.999);
        EXPECT_NEAR(face.axes.determinant(), 1.0, 1e-9);
        for (const Vec3d& corner : face.outline) {
            EXPECT_NEAR(face.normal().dot(corner - face.center), 0.0, 0.05);
            EXPECT_TRUE((corner.array() > -0.01).all() &&
                        (corner.array() < kBox.array() + 0.01).all());
        }
    }
    // Largest first: 60 x 40 before 60 x 20 before 40 x 20.
    EXPECT_NEAR(std::abs(faces[0].normal().z()), 1.0, 1e-3);
    EXPECT_NEAR(std::abs(faces[5].normal().x()), 1.0, 1e-3);
}

TEST(PosesFromFaces, AWholeFaceFixesTheBox) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Pose truth = some_pose(seed);
        const std::vector<FlatFace> seen = {moved(truth, face_of_box(2, 1.0))};
        EXPECT_LT(best_error(poses_from_faces(seen, box(), 2.0, 1000), truth), 1e-6);
    }
}

TEST(PosesFromFaces, HalfAFaceFixesItByTheBorderThatIsSeen) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Pose truth = some_pose(seed);
        const std::vector<FlatFace> seen = {
            moved(truth, face_of_box(2, 1.0, Vec2d(0.4, 0.0), Vec2d(1.0, 1.0)))};
        EXPECT_LT(best_error(poses_from_faces(seen, box(), 2.0, 1000), truth), 1e-6);
    }
}

TEST(PosesFromFaces, TwoFacesFixItWhereTheRectanglesOfBothAreTooSmall) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Pose truth = some_pose(seed);
        // Of the second so little is seen that its longer side lies across.
        FlatFace top = moved(truth, face_of_box(2, 1.0, Vec2d(0.0, 0.3), Vec2d(0.7, 1.0)));
        FlatFace side = moved(truth, face_of_box(1, 1.0, Vec2d(0.5, 0.0), Vec2d(1.0, 0.1)));
        // What a turned rectangle would say is of no use.
        const Mat3d askew = Eigen::AngleAxisd(0.4, Vec3d::UnitZ()).toRotationMatrix();
        top.axes = top.axes * askew;
        side.axes = side.axes * askew;
        const std::vector<FlatFace> seen = {top, side};
        EXPECT_LT(best_error(poses_from_faces(seen, box(), 2.0, 1000), truth), 1e-6);
    }
}

TEST(PosesFromFaces, EveryPoseHasTheFaceOnAndWithinAFaceOfTheModel) {
    const Pose truth = some_pose(4);
    const FlatFace seen = moved(truth, face_of_box(0, 1.0, Vec2d(0.2, 0.1), Vec2d(0.9, 0.8)));
    const auto poses = poses_from_faces(std::span(&seen, 1), box(), 2.0, 1000);
    EXPECT_GT(poses.size(), 10U);
    for (const Pose& T_scene_model : poses) {
        double outside = 0.0;
        double least = 1e9;
        for (const Vec3d& corner : seen.outline) {
            const Vec3d at = T_scene_model.inverse() * corner;
            outside = std::max(outside, (at - kBox).maxCoeff());
            outside = std::max(outside, -at.minCoeff());
            least = std::min(least,
                             std::min(at.cwiseAbs().minCoeff(), (at - kBox).cwiseAbs().minCoeff()));
        }
        EXPECT_LT(outside, 2.0 + 1e-6);
        EXPECT_LT(least, 1e-6);
    }
}

TEST(PosesFromFaces, NoneWhereTheFaceIsLargerThanAnyOfTheModel) {
    FlatFace large = face_of_box(2, 1.0);
    for (Vec3d& corner : large.outline) corner *= 1.2;
    EXPECT_TRUE(poses_from_faces(std::span(&large, 1), box(), 2.0, 1000).empty());
}

TEST(PosesFromFaces, TheBestFilledComeFirstWhereNotAllAreKept) {
    const Pose truth = some_pose(7);
    const std::vector<FlatFace> seen = {moved(truth, face_of_box(0, 1.0))};
    const auto all = poses_from_faces(seen, box(), 2.0, 1000);
    const auto some = poses_from_faces(seen, box(), 2.0, 2);
    ASSERT_EQ(some.size(), 2U);
    EXPECT_GT(all.size(), 10U);
    EXPECT_LT(error_of(some[0], truth), 1e-6);
}

}  // namespace
}  // namespace ostraka
