// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/our_cvfh.hpp"

#include <algorithm>

#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/checks.hpp"
#include "ostraka/descriptors/our_cvfh_frames.hpp"
#include "ostraka/descriptors/vfh_histogram.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kOctantsBegin = 135;  // after three blocks of 45

// What one region adds: its frames and a row for each.
struct RegionRows {
    std::vector<Pose> T_frame_cloud;
    std::vector<float> rows;
};

RegionRows describe_region(const PointCloud& cloud, const VfhHistogram& histogram,
                           const SmoothRegion& region, const OurCvfhSettings& settings) {
    std::vector<float> row(kOurCvfhLength);
    histogram.describe({region.centroid, region.normal}, {.normalize = settings.normalize_bins},
                       row);
    RegionRows result;
    for (const Mat3d& R_frame_cloud : region_frames(cloud, region, settings)) {
        Pose T_frame_cloud = Pose::Identity();
        T_frame_cloud.linear() = R_frame_cloud;
        T_frame_cloud.translation() = -(R_frame_cloud * region.centroid.cast<double>());
        octant_distances(cloud, T_frame_cloud, settings.octant_width, settings.normalize_bins,
                         std::span<float>(row).subspan(kOctantsBegin, kOctants * kOctantBins));
        result.T_frame_cloud.push_back(T_frame_cloud);
        result.rows.insert(result.rows.end(), row.begin(), row.end());
    }
    return result;
}

}  // namespace

RegionalDescriptors describe_our_cvfh(const PointCloud& cloud, std::span<const float> curvatures,
                                      const OurCvfhSettings& settings) {
    require_points(cloud, "our_cvfh");
    require_normals(cloud, "our_cvfh");
    RegionalDescriptors result;
    result.regions = smooth_regions(cloud, curvatures, settings.regions, settings.refinement);
    const VfhHistogram histogram(cloud);
    if (result.regions.empty()) {
        result.rows.resize(kOurCvfhLength);
        result.region_of_row = {kNoIndex};
        result.T_frame_cloud = {Pose::Identity()};
        histogram.describe(whole_center(cloud), {.normalize = settings.normalize_bins},
                           result.rows);
        return result;
    }
    std::vector<RegionRows> of_region(result.regions.size());
    parallel_for(of_region.size(), [&](std::size_t r) {
        of_region[r] = describe_region(cloud, histogram, result.regions[r], settings);
    });
    for (std::size_t r = 0; r < of_region.size(); ++r) {
        const RegionRows& one = of_region[r];
        result.rows.insert(result.rows.end(), one.rows.begin(), one.rows.end());
        result.T_frame_cloud.insert(result.T_frame_cloud.end(), one.T_frame_cloud.begin(),
                                    one.T_frame_cloud.end());
        result.region_of_row.insert(result.region_of_row.end(), one.T_frame_cloud.size(),
                                    static_cast<std::uint32_t>(r));
    }
    return result;
}

RegionalDescriptors describe_our_cvfh(const PointCloud& cloud, const OurCvfhSettings& settings) {
    return describe_our_cvfh(cloud, {}, settings);
}

}  // namespace ostraka
