// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/contradiction.hpp"

#include <limits>

#include "ostraka/recognition/confidence.hpp"
#include "recognition/recognition_testing.hpp"

namespace ostraka {
namespace {

using namespace recognition_testing;

// A wall of 41 x 41 cells, and verdicts on something in front of it.
class Wall {
  public:
    Wall() : map_(points(), {}, {}, 1.0) {
        for (std::uint32_t cell = 0; cell < map_.size(); ++cell) window_.push_back(cell);
        verdicts_.assign(window_.size(), CellVerdict::support);
        through_.assign(window_.size(), false);
    }
    void fill(std::uint32_t u, std::uint32_t v, std::uint32_t columns, std::uint32_t rows,
              CellVerdict verdict, bool through = false) {
        for (std::uint32_t y = v; y < v + rows; ++y) {
            for (std::uint32_t x = u; x < u + columns; ++x) {
                verdicts_[y * map_.width() + x] = verdict;
                through_[y * map_.width() + x] = through;
            }
        }
    }
    std::size_t solid() const { return solid_contradiction(map_, window_, verdicts_); }
    std::size_t blank() const { return solid_blank(map_, window_, verdicts_); }
    std::size_t hollow() const { return hollow_contradiction(map_, window_, verdicts_, through_); }

  private:
    static PointCloud points() {
        PointCloud wall;
        for (int y = -20; y <= 20; ++y) {
            for (int x = -20; x <= 20; ++x) {
                wall.points.emplace_back(static_cast<float>(x), static_cast<float>(y), 100.0F);
            }
        }
        return wall;
    }
    RangeMap map_;
    std::vector<std::uint32_t> window_;
    std::vector<CellVerdict> verdicts_;
    std::vector<bool> through_;
};

TEST(SolidContradiction, CountsTheInsideOfPiecesButNoLines) {
    Wall wall;
    EXPECT_EQ(wall.solid(), 0U);
    wall.fill(2, 2, 2, 20, CellVerdict::violation);  // a line, two cells wide
    EXPECT_EQ(wall.solid(), 0U);
    wall.fill(8, 4, 7, 5, CellVerdict::violation);
    EXPECT_EQ(wall.solid(), 5U * 3U);
    wall.fill(10, 6, 2, 1, CellVerdict::backdrop);  // contradicts as well
    EXPECT_EQ(wall.solid(), 5U * 3U);
    wall.fill(10, 6, 1, 1,
              CellVerdict::missing);  // says nothing: none of the nine around it counts
    EXPECT_EQ(wall.solid(), 2U * 3U);
}

TEST(SolidBlank, CountsTheInsideOfPiecesThatWereNotMeasured) {
    Wall wall;
    EXPECT_EQ(wall.blank(), 0U);
    wall.fill(2, 2, 2, 20, CellVerdict::missing);  // a line, two cells wide: a shadow's rim
    EXPECT_EQ(wall.blank(), 0U);
    wall.fill(8, 4, 7, 5, CellVerdict::missing);
    EXPECT_EQ(wall.blank(), 5U * 3U);
    EXPECT_EQ(wall.solid(), 0U);
    wall.fill(10, 6, 1, 1, CellVerdict::unsure);  // what can't be judged is not blank
    EXPECT_EQ(wall.blank(), 2U * 3U);
}

TEST(HollowContradiction, CountsTheInsideOfAHoleWithAWall) {
    Wall wall;
    wall.fill(8, 4, 7, 5, CellVerdict::missing);
    EXPECT_EQ(wall.hollow(), 0U);  // may be the sensor's failure
    wall.fill(8, 4, 1, 5, CellVerdict::unsure, true);
    EXPECT_EQ(wall.hollow(), 5U * 3U);
    wall.fill(8, 4, 1, 4, CellVerdict::unsure);  // what is seen of a wall is one cell: a speck
    EXPECT_EQ(wall.hollow(), 0U);
    wall.fill(8, 4, 1, 5, CellVerdict::violation, true);  // where it is clear
    EXPECT_EQ(wall.hollow(), 5U * 3U);
}

TEST(HollowContradiction, IsNoneAtTheOutline) {
    Wall wall;
    wall.fill(8, 4, 7, 5, CellVerdict::missing);
    wall.fill(8, 4, 1, 5, CellVerdict::unsure, true);
    wall.fill(15, 6, 1, 1, CellVerdict::hidden);
    EXPECT_EQ(wall.hollow(), 0U);
    wall.fill(15, 6, 1, 1, CellVerdict::outside);
    EXPECT_EQ(wall.hollow(), 0U);
    wall.fill(15, 6, 1, 1, CellVerdict::support);
    EXPECT_EQ(wall.hollow(), 5U * 3U);
}

TEST(HollowContradiction, IsNoneWhereMuchIsMissingAndLittleOfItIsSeenThrough) {
    Wall wall;
    wall.fill(4, 4, 30, 20, CellVerdict::missing);
    wall.fill(4, 4, 1, 20, CellVerdict::unsure, true);  // 20 of 600
    EXPECT_EQ(wall.hollow(), 0U);
}

// A plate with two square holes, in front of nothing.
TriangleMesh plate_with_holes() {
    TriangleMesh mesh;
    const float low[3] = {0, 18, 42};    // of the bars along the short side, and of
    const float high[3] = {18, 42, 60};  // those along the long one
    const float x[6] = {0, 16, 40, 50, 74, 90};
    testing::add_box(mesh, Vec3f(0, low[0], 0), Vec3f(90, high[0], 8));
    testing::add_box(mesh, Vec3f(0, low[2], 0), Vec3f(90, high[2], 8));
    for (int i = 0; i < 6; i += 2) {
        testing::add_box(mesh, Vec3f(x[i], low[1], 0), Vec3f(x[i + 1], high[1], 8));
    }
    return mesh;
}

Verified verified_as_plate(const SimulatedScene& scene) {
    return verify(prepared(scene), probe(kPlate),
                  {.model = kPlate, .T_scene_model = scene.objects[0].T_scene_model}, tolerance());
}

TEST(HollowContradiction, TellsAPlateWithHolesFromOneWithout) {
    const Vec3d eye(190, 170, -350);
    const Verified with = verified_as_plate(scan_of(plate_with_holes(), eye, 0.1));
    EXPECT_GT(with.hollow, 10U);
    EXPECT_LT(general_confidence().confidence(features_of(with)), 0.5);
    const Verified without = verified_as_plate(scan_of(testing::plate_model(), eye, 0.1));
    EXPECT_EQ(without.hollow, 0U);
    EXPECT_GT(general_confidence().confidence(features_of(without)), 0.9);
}

// The same holes, but of the sensor: nothing farther is seen in them.
TEST(HollowContradiction, IsNoneWhereTheSensorFails) {
    SimulatedScene scene = scan_of(testing::plate_model(), Vec3d(190, 170, -350), 0.1);
    const Pose T_model_scene = scene.objects[0].T_scene_model.inverse();
    std::size_t lost = 0;
    for (Vec3f& point : scene.cloud.points) {
        const Vec3d at = T_model_scene * point.cast<double>();
        const bool along = (at.x() > 16 && at.x() < 40) || (at.x() > 50 && at.x() < 74);
        if (!along || at.y() < 18 || at.y() > 42) continue;
        point = Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());
        ++lost;
    }
    EXPECT_GT(lost, 500U);
    EXPECT_EQ(verified_as_plate(scene).hollow, 0U);
}

}  // namespace
}  // namespace ostraka
