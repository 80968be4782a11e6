// SPDX-License-Identifier: Apache-2.0
// CVFH and OUR-CVFH against PCL: the same normals, curvatures and settings. PCL's region growing
// misses a few points (see tests/descriptors/pcl_oracle_regional_test.cpp), so rows differ with the
// regions; they are compared only where their number is the same.
#include <pcl/console/print.h>
#include <pcl/features/cvfh.h>
#include <pcl/features/our_cvfh.h>

#include <memory>

#include "benchmark.hpp"
#include "ostraka/descriptors/our_cvfh.hpp"
#include "pcl_clouds.hpp"

namespace ostraka::bench {
namespace {

struct State {
    explicit State(const BenchCloud& bench)
        : cloud(bench.cloud),
          points(pcl_points(bench.cloud.points)),
          normals(pcl_normals(bench.cloud)) {
        regions.normal_radius = static_cast<float>(3.0 * bench.mr);
        regions.tolerance = regions.normal_radius;
        curvatures = surface_variations(cloud.points, regions.normal_radius);
        for (std::size_t i = 0; i < curvatures.size(); ++i) (*normals)[i].curvature = curvatures[i];
    }

    template <class Estimation>
    void compute(Estimation& estimation) {
        estimation.setInputCloud(points);
        estimation.setInputNormals(normals);
        estimation.setSearchMethod(PclTree::Ptr(new PclTree));
        estimation.setRadiusNormals(regions.normal_radius);
        estimation.setClusterTolerance(regions.tolerance);
        estimation.setEPSAngleThreshold(regions.max_angle);
        estimation.setCurvatureThreshold(regions.max_curvature);
        estimation.setMinPoints(regions.min_points);
        estimation.setNormalizeBins(false);
        estimation.compute(pcl);
    }
    std::vector<float> pcl_rows() const {
        std::vector<float> rows;
        for (const auto& row : pcl) {
            rows.insert(rows.end(), std::begin(row.histogram), std::end(row.histogram));
        }
        return rows;
    }

    const PointCloud& cloud;
    PclPoints::Ptr points;
    PclNormals::Ptr normals;
    CvfhRegionSettings regions;
    std::vector<float> curvatures;
    std::vector<float> ours;
    pcl::PointCloud<pcl::VFHSignature308> pcl;
};

Contest cvfh(const BenchCloud& cloud) {
    auto state = std::make_shared<State>(cloud);
    const auto ours = [state] {
        const CvfhSettings settings{.regions = state->regions};
        state->ours = describe_cvfh(state->cloud, state->curvatures, settings).rows;
    };
    const auto peer = [state] {
        pcl::CVFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> estimation;
        state->compute(estimation);
    };
    return {{ours, [state] { return state->ours; }}, {peer, [state] { return state->pcl_rows(); }}};
}

Contest our_cvfh(const BenchCloud& cloud) {
    auto state = std::make_shared<State>(cloud);
    const auto ours = [state] {
        const OurCvfhSettings settings{.regions = state->regions};
        state->ours = describe_our_cvfh(state->cloud, state->curvatures, settings).rows;
    };
    const auto peer = [state] {
        pcl::OURCVFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> estimation;
        const OurCvfhSettings settings;
        estimation.setRefineClusters(settings.refinement);
        estimation.setAxisRatio(settings.axis_ratio);
        estimation.setMinAxisValue(settings.min_axis_value);
        state->compute(estimation);
    };
    return {{ours, [state] { return state->ours; }}, {peer, [state] { return state->pcl_rows(); }}};
}

}  // namespace

std::vector<Benchmark> pcl_regional_benchmarks() {
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // it reports each ambiguous frame
    return {
        {.name = "CVFH", .peer = kPcl, .prepare = cvfh},
        {.name = "OUR-CVFH", .peer = kPcl, .goal = 10, .in_mean = true, .prepare = our_cvfh},
    };
}

}  // namespace ostraka::bench
