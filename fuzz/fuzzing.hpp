// SPDX-License-Identifier: Apache-2.0
// What every fuzz target does: a reader may reject its input with FormatError, nothing else, and
// what it accepts must be well formed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/io/bop_results.hpp"
#include "ostraka/io/bop_scene.hpp"
#include "ostraka/io/uwa_occlusion.hpp"
#include "ostraka/mesh/triangle_mesh.hpp"

namespace ostraka::fuzzing {

inline void check_result(const TriangleMesh& mesh) {
    for (const Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t vertex : triangle) {
            if (vertex >= mesh.vertices.size()) {
                std::abort();
            }
        }
    }
}

inline void check_result(const PointCloud& cloud) {
    check(cloud);
}

inline void check_result(const Pose& pose) {
    const Eigen::Matrix3d rotation = pose.linear();
    const Eigen::Matrix3d off = rotation * rotation.transpose() - Eigen::Matrix3d::Identity();
    if (!pose.matrix().allFinite() || !(off.cwiseAbs().maxCoeff() < 1e-9)) {
        std::abort();
    }
}

inline void check_result(const BopObject& object) {
    check_result(object.T_camera_model);
    if (object.number < 1 || !(object.visible_fraction <= 1.0)) {
        std::abort();
    }
}

inline void check_result(const BopResult& result) {
    check_result(result.T_camera_model);
}

inline void check_result(const BopCamera& camera) {
    if (!(camera.fx > 0.0 && camera.fy > 0.0 && camera.depth_scale > 0.0)) {
        std::abort();
    }
}

inline void check_result(const UwaOcclusion& row) {
    if (!(row.percent >= 0.0 && row.percent <= 100.0)) {
        std::abort();
    }
}

inline void check_result(const std::string& /*text*/) {}

template <class Item>
void check_result(const std::vector<Item>& items) {
    for (const Item& item : items) {
        check_result(item);
    }
}

template <class Key, class Item>
void check_result(const std::map<Key, Item>& items) {
    for (const auto& [key, item] : items) {
        check_result(item);
    }
}

template <class Parse>
int run(const std::uint8_t* data, std::size_t size, const Parse& parse) {
    try {
        check_result(parse(std::span<const char>(reinterpret_cast<const char*>(data), size)));
    } catch (const FormatError&) {
    }
    return 0;
}

}  // namespace ostraka::fuzzing
