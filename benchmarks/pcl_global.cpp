// SPDX-License-Identifier: Apache-2.0
// Global descriptors against PCL: the same cloud, the same normals, the settings that make ours
// equal to PCL's.
#include <pcl/features/esf.h>
#include <pcl/features/gasd.h>
#include <pcl/features/rops_estimation.h>
#include <pcl/features/shot.h>
#include <pcl/features/vfh.h>

#include <memory>

#include "benchmark.hpp"
#include "ostraka/descriptors/descriptor.hpp"
#include "pcl_clouds.hpp"
#include "pcl_surface.hpp"

namespace ostraka::bench {
namespace {

// The state of a contest whose answers are single rows.
struct Rows {
    explicit Rows(const BenchCloud& cloud)
        : points(pcl_points(cloud.cloud.points)), normals(pcl_normals(cloud.cloud)) {}
    PclPoints::Ptr points;
    PclNormals::Ptr normals;
    std::vector<float> ours;
    std::vector<float> pcl;
};

// `ours` and `pcl` fill the rows' members.
template <class Ours, class Pcl>
Contest contest(const std::shared_ptr<Rows>& rows, const Ours& ours, const Pcl& pcl) {
    return {{[rows, ours] { rows->ours = ours(); }, [rows] { return rows->ours; }},
            {[rows, pcl] { rows->pcl = pcl(*rows); }, [rows] { return rows->pcl; }}};
}

template <class Signature>
std::vector<float> row_of(const Signature& signature) {
    return {std::begin(signature.histogram), std::end(signature.histogram)};
}

Contest vfh(const BenchCloud& cloud) {
    return contest(
        std::make_shared<Rows>(cloud),
        [&cloud] { return describe_vfh(cloud.cloud, {.pcl_viewpoint_length = true}); },
        [&cloud](const Rows& rows) {
            pcl::VFHEstimation<pcl::PointXYZ, pcl::Normal> estimation;
            estimation.setInputCloud(rows.points);
            estimation.setInputNormals(rows.normals);
            const Vec3f& eye = cloud.cloud.viewpoint;
            estimation.setViewPoint(eye.x(), eye.y(), eye.z());
            estimation.setSearchMethod(PclTree::Ptr(new PclTree));
            pcl::PointCloud<pcl::VFHSignature308> output;
            estimation.compute(output);
            return row_of(output[0]);
        });
}

Contest esf(const BenchCloud& cloud) {
    return contest(
        std::make_shared<Rows>(cloud), [&cloud] { return describe_esf(cloud.cloud); },
        [](const Rows& rows) {
            pcl::ESFEstimation<pcl::PointXYZ> estimation;
            estimation.setInputCloud(rows.points);
            pcl::PointCloud<pcl::ESFSignature640> output;
            estimation.compute(output);
            return row_of(output[0]);
        });
}

Contest gasd(const BenchCloud& cloud) {
    const Vec3f view = centroid(cloud.cloud.points).cast<float>() - cloud.cloud.viewpoint;
    GasdSettings settings;
    settings.x_sign = GasdSettings::AxisSign::pcl;
    return contest(
        std::make_shared<Rows>(cloud),
        [&cloud, settings] { return describe_gasd(cloud.cloud, settings); },
        [view](const Rows& rows) {
            pcl::GASDEstimation<pcl::PointXYZ> estimation(Eigen::Vector3f(view.normalized()));
            estimation.setInputCloud(rows.points);
            pcl::PointCloud<pcl::GASDSignature512> output;
            estimation.compute(output);
            return row_of(output[0]);
        });
}

Contest global_shot(const BenchCloud& cloud) {
    const double radius = 1.0001 * cloud.radius;
    const Vec3f center = centroid(cloud.cloud.points).cast<float>();
    return contest(
        std::make_shared<Rows>(cloud), [&cloud] { return describe_global_shot(cloud.cloud); },
        [radius, center](const Rows& rows) {
            pcl::SHOTEstimation<pcl::PointXYZ, pcl::Normal> estimation;
            estimation.setInputCloud(pcl_points({&center, 1}));
            estimation.setSearchSurface(rows.points);
            estimation.setInputNormals(rows.normals);
            estimation.setRadiusSearch(radius);
            estimation.setLRFRadius(static_cast<float>(radius));
            estimation.setSearchMethod(PclTree::Ptr(new PclTree));
            pcl::PointCloud<pcl::SHOT352> output;
            estimation.compute(output);
            return std::vector<float>(std::begin(output[0].descriptor),
                                      std::end(output[0].descriptor));
        });
}

// Each side makes its own triangles, so the rows differ with them.
Contest global_rops(const BenchCloud& cloud) {
    const double radius = 1.0001 * cloud.radius;
    const double edge = 4.0 * cloud.mr;
    const Vec3f center = centroid(cloud.cloud.points).cast<float>();
    return contest(
        std::make_shared<Rows>(cloud), [&cloud] { return describe_global_rops(cloud.cloud); },
        [radius, edge, center](const Rows& rows) {
            pcl::ROPSEstimation<pcl::PointXYZ, pcl::Histogram<135>> estimation;
            estimation.setInputCloud(pcl_points({&center, 1}));
            estimation.setSearchSurface(rows.points);
            estimation.setRadiusSearch(radius);
            estimation.setSupportRadius(static_cast<float>(radius));
            estimation.setTriangles(pcl_triangles(*rows.points, *rows.normals, edge));
            estimation.setSearchMethod(PclTree::Ptr(new PclTree));
            pcl::PointCloud<pcl::Histogram<135>> output;
            estimation.compute(output);
            return row_of(output[0]);
        });
}

}  // namespace

std::vector<Benchmark> pcl_global_benchmarks() {
    return {
        {.name = "VFH", .peer = kPcl, .goal = 5, .in_mean = true, .prepare = vfh},
        {.name = "ESF", .peer = kPcl, .goal = 10, .in_mean = true, .prepare = esf},
        {.name = "GASD", .peer = kPcl, .goal = 5, .in_mean = true, .prepare = gasd},
        {.name = "SHOT, global", .peer = kPcl, .goal = 5, .in_mean = true, .prepare = global_shot},
        {.name = "RoPS, global", .peer = kPcl, .prepare = global_rops},
    };
}

}  // namespace ostraka::bench
