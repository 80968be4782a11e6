// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/cvfh.hpp"

#include "ostraka/base/parallel.hpp"
#include "ostraka/descriptors/checks.hpp"
#include "ostraka/descriptors/vfh_histogram.hpp"

namespace ostraka {

RegionalDescriptors describe_cvfh(const PointCloud& cloud, std::span<const float> curvatures,
                                  const CvfhSettings& settings) {
    require_points(cloud, "cvfh");
    require_normals(cloud, "cvfh");
    RegionalDescriptors result;
    result.regions = smooth_regions(cloud, curvatures, settings.regions);
    const VfhHistogram histogram(cloud);
    const VfhBins bins{.normalize = settings.normalize_bins, .distances = true};
    if (result.regions.empty()) {
        result.rows.resize(kCvfhLength);
        result.region_of_row = {kNoIndex};
        histogram.describe(whole_center(cloud), bins, result.rows);
        return result;
    }
    result.rows.resize(result.regions.size() * kCvfhLength);
    result.region_of_row.resize(result.regions.size());
    parallel_for(result.regions.size(), [&](std::size_t r) {
        const SmoothRegion& region = result.regions[r];
        result.region_of_row[r] = static_cast<std::uint32_t>(r);
        histogram.describe({region.centroid, region.normal}, bins,
                           std::span(result.rows).subspan(r * kCvfhLength, kCvfhLength));
    });
    return result;
}

RegionalDescriptors describe_cvfh(const PointCloud& cloud, const CvfhSettings& settings) {
    return describe_cvfh(cloud, {}, settings);
}

}  // namespace ostraka
