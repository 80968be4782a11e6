// SPDX-License-Identifier: Apache-2.0
// Our semi-global rows against PCL 1.13's: same clouds, normals, curvatures and settings.
// PCL's region growing searches unsorted, yet skips the first neighbor found as if that were the
// point itself; so it misses a few percent of the points, which ones depends on its tree. Therefore
// regions are compared with those that PCL's normals give by brute force, rows and frames with what
// PCL's code makes of the same regions, and PCL's own regions must be parts of ours.
#include <gtest/gtest.h>
#include <pcl/console/print.h>
#include <pcl/features/cvfh.h>
#include <pcl/features/gasd.h>
#include <pcl/features/normal_3d.h>
#include <pcl/features/our_cvfh.h>
#include <pcl/features/vfh.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <set>

#include "descriptors/shapes.hpp"
#include "ostraka/cloud/resample.hpp"
#include "ostraka/descriptors/cvfh.hpp"
#include "ostraka/descriptors/exact_sum.hpp"
#include "ostraka/descriptors/gasd_color.hpp"
#include "ostraka/descriptors/our_cvfh.hpp"

namespace ostraka {
namespace {

using PclPoints = pcl::PointCloud<pcl::PointXYZ>;
using PclNormals = pcl::PointCloud<pcl::Normal>;
using PclRows = pcl::PointCloud<pcl::VFHSignature308>;
using PclPositions = std::vector<Eigen::Vector3f, Eigen::aligned_allocator<Eigen::Vector3f>>;
using PclPoses = std::vector<Eigen::Matrix4f, Eigen::aligned_allocator<Eigen::Matrix4f>>;

constexpr double kTolerance = 1e-3;

PclPoints::Ptr points_of(std::span<const Vec3f> points) {
    PclPoints::Ptr result(new PclPoints);
    for (const Vec3f& p : points) result->emplace_back(p.x(), p.y(), p.z());
    return result;
}

PclNormals::Ptr normals_of(const PointCloud& cloud, std::span<const float> curvatures) {
    PclNormals::Ptr result(new PclNormals);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const Vec3f& n = cloud.normals[i];
        result->emplace_back(n.x(), n.y(), n.z(), curvatures[i]);
    }
    return result;
}

pcl::search::KdTree<pcl::PointXYZ>::Ptr tree() {
    return pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>);
}

double radius_of(const PointCloud& cloud) {
    return largest_distance(cloud.points, centroid(cloud.points));
}

// With its sensor in the origin, where PCL's CVFH takes it to be, and rough in depth: on an exact
// plane PCL's normals and regions hang on rounding.
PointCloud seen_from_origin(const PointCloud& cloud) {
    Pose away = Pose::Identity();
    away.translation() = -cloud.viewpoint.cast<double>();
    PointCloud moved = transformed(cloud, away);
    moved.viewpoint = Vec3f::Zero();
    const double roughness = 0.001 * radius_of(moved);
    Random random(5);
    for (Vec3f& point : moved.points) {
        point += point.normalized() * static_cast<float>(roughness * random.normal());
    }
    return moved;
}

std::vector<PointCloud> clouds() {
    std::vector<PointCloud> result;
    for (const std::size_t count : {2'000, 6'000}) {
        for (const PointCloud& cloud : shapes::all(count)) {
            result.push_back(seen_from_origin(cloud));
        }
    }
    if (const char* data = std::getenv("OSTRAKA_DATA")) {
        const PointCloud bunny =
            shapes::ply_view(std::string(data) + "/bologna/models/bunny.ply", 3);
        if (!bunny.empty()) result.push_back(seen_from_origin(bunny));
    }
    return result;
}

CvfhRegionSettings regions_for(const PointCloud& cloud, float max_angle) {
    const auto spacing = static_cast<float>(mesh_resolution(cloud.points));
    return {.normal_radius = 4.0F * spacing, .tolerance = 3.0F * spacing, .max_angle = max_angle};
}

template <class Estimation>
void configure(Estimation& estimation, const PointCloud& cloud, std::span<const float> curvatures,
               const CvfhRegionSettings& settings, bool normalize) {
    estimation.setInputCloud(points_of(cloud.points));
    estimation.setInputNormals(normals_of(cloud, curvatures));
    estimation.setSearchMethod(tree());
    estimation.setRadiusNormals(settings.normal_radius);
    estimation.setClusterTolerance(settings.tolerance);
    estimation.setEPSAngleThreshold(settings.max_angle);
    estimation.setCurvatureThreshold(settings.max_curvature);
    estimation.setMinPoints(settings.min_points);
    estimation.setNormalizeBins(normalize);
}

std::span<const float> row(const RegionalDescriptors& ours, std::size_t r) {
    return std::span(ours.rows).subspan(r * kCvfhLength, kCvfhLength);
}

TEST(PclOracle, SurfaceVariationEqualsPclsCurvature) {
    for (const PointCloud& cloud : clouds()) {
        const auto radius = static_cast<float>(4.0 * mesh_resolution(cloud.points));
        pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
        estimation.setInputCloud(points_of(cloud.points));
        estimation.setSearchMethod(tree());
        estimation.setRadiusSearch(radius);
        PclNormals expected;
        estimation.compute(expected);
        const std::vector<float> variations = surface_variations(cloud.points, radius);
        for (std::size_t i = 0; i < cloud.size(); ++i) {
            if (!std::isfinite(expected[i].curvature)) continue;  // fewer than 3 points around
            EXPECT_NEAR(variations[i], expected[i].curvature, 2e-5F) << i << " " << cloud.size();
        }
    }
}

// Groups of points whose neighbors have like normals, by comparing all pairs.
std::set<std::vector<std::uint32_t>> joined(std::span<const Vec3f> points,
                                            const PclNormals& normals,
                                            const CvfhRegionSettings& settings) {
    const float squared_tolerance = settings.tolerance * settings.tolerance;
    const double min_cosine = std::cos(double{settings.max_angle});
    std::vector<bool> reached(points.size(), false);
    std::set<std::vector<std::uint32_t>> groups;
    for (std::uint32_t seed = 0; seed < points.size(); ++seed) {
        if (reached[seed]) continue;
        reached[seed] = true;
        std::vector<std::uint32_t> group = {seed};
        for (std::size_t k = 0; k < group.size(); ++k) {
            const Vec3f point = points[group[k]];
            const Eigen::Vector3f normal = normals[group[k]].getNormalVector3fMap();
            for (std::uint32_t j = 0; j < points.size(); ++j) {
                if (reached[j] || !((points[j] - point).squaredNorm() < squared_tolerance) ||
                    !(double{normal.dot(normals[j].getNormalVector3fMap())} > min_cosine)) {
                    continue;
                }
                reached[j] = true;
                group.push_back(j);
            }
        }
        std::sort(group.begin(), group.end());
        if (group.size() >= settings.min_points) groups.insert(std::move(group));
    }
    return groups;
}

// The points of low curvature, and PCL's normals of them fitted among themselves.
struct Smooth {
    std::vector<std::uint32_t> kept;
    std::vector<Vec3f> points;
    PclNormals normals;
};

Smooth smooth_part(const PointCloud& cloud, std::span<const float> curvatures,
                   const CvfhRegionSettings& settings) {
    Smooth smooth;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
        if (curvatures[i] > settings.max_curvature) continue;
        smooth.kept.push_back(i);
        smooth.points.push_back(cloud.points[i]);
    }
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setInputCloud(points_of(smooth.points));
    estimation.setSearchMethod(tree());
    estimation.setRadiusSearch(settings.normal_radius);
    estimation.compute(smooth.normals);
    return smooth;
}

TEST(PclOracle, SmoothRegionsJoinWhatPclsNormalsJoin) {
    for (const PointCloud& cloud : clouds()) {
        for (const float max_angle : {0.05F, 0.125F, 0.3F}) {
            const CvfhRegionSettings settings = regions_for(cloud, max_angle);
            const auto curvatures = surface_variations(cloud.points, settings.normal_radius);
            const Smooth smooth = smooth_part(cloud, curvatures, settings);
            const auto expected = joined(smooth.points, smooth.normals, settings);
            const auto ours = smooth_regions(cloud, curvatures, settings);
            EXPECT_EQ(ours.size(), smooth_regions(cloud, {}, settings).size());
            ASSERT_EQ(ours.size(), expected.size()) << cloud.size() << " " << max_angle;
            for (const SmoothRegion& region : ours) {
                std::vector<std::uint32_t> members;
                for (const std::uint32_t i : region.points) {
                    const auto at = std::lower_bound(smooth.kept.begin(), smooth.kept.end(), i);
                    members.push_back(static_cast<std::uint32_t>(at - smooth.kept.begin()));
                }
                EXPECT_TRUE(expected.contains(members)) << cloud.size() << " " << max_angle;
            }
        }
    }
}

// PCL's code after its region growing: rows and frames of given regions.
class PclOurCvfh : public pcl::OURCVFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> {
  public:
    PclRows rows_with_octants(const ostraka::PointCloud& cloud, PclRows rows,
                              std::vector<pcl::PointIndices> regions, const PclPositions& centroids,
                              const PclPositions& normals) {
        centroids_dominant_orientations_ = centroids;
        dominant_normals_ = normals;
        PclPoints::Ptr points = points_of(cloud.points);
        computeRFAndShapeDistribution(points, rows, regions);
        return rows;
    }
};

// Centroids and mean normals of our regions, by PCL's normals and as PCL sums them.
void summarize(const std::vector<SmoothRegion>& regions, const PointCloud& cloud,
               const Smooth& smooth, PclPositions& centroids, PclPositions& normals) {
    for (const SmoothRegion& region : regions) {
        Eigen::Vector3f point = Eigen::Vector3f::Zero();
        Eigen::Vector3f normal = Eigen::Vector3f::Zero();
        for (const std::uint32_t i : region.points) {
            const auto at = std::lower_bound(smooth.kept.begin(), smooth.kept.end(), i);
            const auto k = static_cast<std::size_t>(at - smooth.kept.begin());
            point += cloud.points[i];
            normal += smooth.normals[k].getNormalVector3fMap();
        }
        centroids.push_back(point / static_cast<float>(region.points.size()));
        normals.push_back(normal.normalized());
    }
}

// PCL's rows of given regions; CVFH's with `distances`, else what OUR-CVFH starts from.
PclRows pcl_rows(const PointCloud& cloud, const PclPositions& centroids,
                 const PclPositions& normals, bool normalize, bool distances) {
    PclRows rows;
    for (std::size_t r = 0; r < centroids.size(); ++r) {
        pcl::VFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> vfh;
        vfh.setInputCloud(points_of(cloud.points));
        vfh.setInputNormals(normals_of(cloud, std::vector<float>(cloud.size())));
        vfh.setSearchMethod(tree());
        vfh.setUseGivenNormal(true);
        vfh.setUseGivenCentroid(true);
        vfh.setNormalizeBins(normalize);
        vfh.setNormalizeDistance(distances);
        vfh.setFillSizeComponent(distances);
        vfh.setNormalToUse(normals[r]);
        vfh.setCentroidToUse(centroids[r]);
        PclRows one;
        vfh.compute(one);
        rows.push_back(one[0]);
    }
    return rows;
}

// Only a few points lie so close to a bin's edge that PCL's sums in single precision, over
// coordinates far from the origin, put them on its other side.
struct Agreement {
    double difference = 0.0;
    double size = 0.0;
    double worst = 0.0;

    void add(std::span<const float> ours, std::span<const float> pcls) {
        worst = std::max(worst, shapes::relative_l1(ours, pcls));
        for (std::size_t i = 0; i < ours.size(); ++i) {
            difference += std::abs(double{ours[i]} - pcls[i]);
            size += std::abs(pcls[i]);
        }
    }
};

TEST(PclOracle, CvfhEqualsPcl) {
    for (const PointCloud& cloud : clouds()) {
        for (const bool normalize : {false, true}) {
            const CvfhRegionSettings settings = regions_for(cloud, 0.125F);
            const auto curvatures = surface_variations(cloud.points, settings.normal_radius);
            const auto ours = describe_cvfh(cloud, curvatures, {settings, normalize});
            PclPositions centroids;
            PclPositions normals;
            summarize(ours.regions, cloud, smooth_part(cloud, curvatures, settings), centroids,
                      normals);
            const PclRows expected = pcl_rows(cloud, centroids, normals, normalize, true);
            ASSERT_GE(expected.size(), 1U);
            Agreement agreement;
            for (std::size_t r = 0; r < expected.size(); ++r) {
                agreement.add(row(ours, r), expected[r].histogram);
            }
            EXPECT_LE(agreement.difference, kTolerance * agreement.size) << cloud.size();
            EXPECT_LE(agreement.worst, 3.0 * kTolerance) << cloud.size();
        }
    }
}

TEST(PclOracle, CvfhWithoutRegionsEqualsPcl) {
    pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
    for (const PointCloud& cloud : clouds()) {
        const CvfhRegionSettings settings = regions_for(cloud, 0.125F);
        const std::vector<float> curvatures(cloud.size(), 1.0F);
        pcl::CVFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> cvfh;
        configure(cvfh, cloud, curvatures, settings, false);
        PclRows expected;
        cvfh.compute(expected);
        const auto ours = describe_cvfh(cloud, curvatures, {settings});
        ASSERT_EQ(ours.region_of_row, std::vector<std::uint32_t>{kNoIndex});
        EXPECT_LE(shapes::relative_l1(ours.rows, expected[0].histogram), kTolerance);
        PclOurCvfh our_cvfh;
        configure(our_cvfh, cloud, curvatures, settings, true);
        our_cvfh.compute(expected);
        const auto mine =
            describe_our_cvfh(cloud, curvatures, {.regions = settings, .normalize_bins = true});
        EXPECT_LE(shapes::relative_l1(mine.rows, expected[0].histogram), kTolerance);
    }
}

// PCL's frames are mirrored in y.
double frame_error(const Pose& T_frame_cloud, const Eigen::Matrix4f& pcls) {
    Mat4d mirrored = T_frame_cloud.matrix();
    mirrored.row(1) = -mirrored.row(1);
    return (mirrored - pcls.cast<double>()).topLeftCorner<3, 3>().norm();
}

void expect_our_cvfh_equal(const PointCloud& cloud, const OurCvfhSettings& settings) {
    pcl::console::setVerbosityLevel(pcl::console::L_ERROR);  // PCL warns of ambiguous axes
    const auto curvatures = surface_variations(cloud.points, settings.regions.normal_radius);
    const auto ours = describe_our_cvfh(cloud, curvatures, settings);
    PclPositions centroids;
    PclPositions normals;
    summarize(ours.regions, cloud, smooth_part(cloud, curvatures, settings.regions), centroids,
              normals);
    std::vector<pcl::PointIndices> regions(ours.regions.size());
    for (std::size_t r = 0; r < regions.size(); ++r) {
        regions[r].indices.assign(ours.regions[r].points.begin(), ours.regions[r].points.end());
    }
    PclOurCvfh pcls;
    configure(pcls, cloud, curvatures, settings.regions, settings.normalize_bins);
    pcls.setAxisRatio(settings.axis_ratio);
    pcls.setMinAxisValue(settings.min_axis_value);
    const PclRows expected = pcls.rows_with_octants(
        cloud, pcl_rows(cloud, centroids, normals, settings.normalize_bins, false), regions,
        centroids, normals);
    PclPoses poses;
    pcls.getTransforms(poses);
    ASSERT_EQ(ours.rows.size(), expected.size() * kOurCvfhLength) << cloud.size();
    ASSERT_EQ(ours.T_frame_cloud.size(), expected.size());
    Agreement agreement;
    for (std::size_t r = 0; r < expected.size(); ++r) {
        EXPECT_LE(frame_error(ours.T_frame_cloud[r], poses[r]), 2e-3) << cloud.size();
        agreement.add(row(ours, r), expected[r].histogram);
    }
    EXPECT_LE(agreement.difference, kTolerance * agreement.size) << cloud.size();
    EXPECT_LE(agreement.worst, 3.0 * kTolerance) << cloud.size();
}

TEST(PclOracle, OurCvfhEqualsPcl) {
    for (const PointCloud& cloud : clouds()) {
        OurCvfhSettings settings;
        settings.regions = regions_for(cloud, 0.125F);
        settings.octant_width = 0.01F;
        expect_our_cvfh_equal(cloud, settings);
        settings.normalize_bins = true;
        settings.refinement = 2.0F;
        expect_our_cvfh_equal(cloud, settings);
    }
}

TEST(PclOracle, OurCvfhInMetersSharesOctantsAsPcl) {
    for (const PointCloud& cloud : clouds()) {
        const PointCloud small = scaled(cloud, 0.06 / radius_of(cloud));  // where 1 cm is wide
        OurCvfhSettings settings;
        settings.regions = regions_for(small, 0.125F);
        settings.octant_width = 0.01F;
        expect_our_cvfh_equal(small, settings);
    }
}

TEST(PclOracle, OurCvfhGivesAmbiguousFramesAsPcl) {
    for (const PointCloud& cloud : clouds()) {
        OurCvfhSettings settings;
        settings.regions = regions_for(cloud, 0.125F);
        settings.octant_width = 0.01F;
        settings.axis_ratio = 0.0F;  // both axes, always
        expect_our_cvfh_equal(cloud, settings);
        settings.min_axis_value = 0.0F;  // with both signs
        expect_our_cvfh_equal(cloud, settings);
    }
}

TEST(PclOracle, OurRefinedRegionsHoldPcls) {
    for (const PointCloud& cloud : clouds()) {
        OurCvfhSettings settings;
        settings.regions = regions_for(cloud, 0.3F);
        settings.refinement = 50.0F;  // nothing leaves
        const auto curvatures = surface_variations(cloud.points, settings.regions.normal_radius);
        PclOurCvfh pcls;
        configure(pcls, cloud, curvatures, settings.regions, false);
        pcls.setRefineClusters(settings.refinement);
        PclRows rows;
        pcls.compute(rows);
        std::vector<pcl::PointIndices> regions;
        pcls.getClusterIndices(regions);
        const auto ours = describe_our_cvfh(cloud, curvatures, settings);
        std::size_t all = 0;
        for (const pcl::PointIndices& region : regions) {
            all += region.indices.size();
            EXPECT_TRUE(
                std::any_of(ours.regions.begin(), ours.regions.end(), [&](const SmoothRegion& own) {
                    return std::includes(own.points.begin(), own.points.end(),
                                         region.indices.begin(), region.indices.end());
                }));
        }
        std::size_t own = 0;
        for (const SmoothRegion& region : ours.regions) own += region.points.size();
        EXPECT_LE(own, all + cloud.size() / 5);
    }
}

TEST(PclOracle, GasdColorEqualsPcl) {
    for (PointCloud cloud : clouds()) {
        Random random(6);
        pcl::PointCloud<pcl::PointXYZRGB>::Ptr points(new pcl::PointCloud<pcl::PointXYZRGB>);
        for (const Vec3f& p : cloud.points) {
            const Color color = {static_cast<std::uint8_t>(random.below(256)),
                                 static_cast<std::uint8_t>(random.below(4) * 60),
                                 static_cast<std::uint8_t>(random.below(2) * 120)};
            cloud.colors.push_back(color);
            points->emplace_back(p.x(), p.y(), p.z(), color[0], color[1], color[2]);
        }
        const Vec3f view = centroid(cloud.points).cast<float>() - cloud.viewpoint;
        pcl::GASDColorEstimation<pcl::PointXYZRGB> gasd(Eigen::Vector3f(view.normalized()));
        gasd.setInputCloud(points);
        pcl::PointCloud<pcl::GASDSignature984> output;
        gasd.compute(output);
        const auto ours = describe_gasd_color(cloud, {.x_sign = GasdSettings::AxisSign::pcl});
        EXPECT_LE(shapes::relative_l1(ours, output[0].histogram), kTolerance) << cloud.size();
    }
}

}  // namespace
}  // namespace ostraka
