// SPDX-License-Identifier: Apache-2.0
// What local descriptors return: a row and a local reference frame for each keypoint.
#pragma once

#include <vector>

#include "ostraka/base/types.hpp"

namespace ostraka {

struct LocalDescriptors {
    std::vector<float> rows;    ///< keypoints x length, row-major; finite; all 0 where undefined
    std::vector<Mat3f> frames;  ///< R_local_cloud of each keypoint: rows are its x, y and z axis in
                                ///< the cloud's frame, right-handed; NaN where undefined. Empty
                                ///< for descriptors without a frame (PFH, FPFH, spin images)
};

}  // namespace ostraka
