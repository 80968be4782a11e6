// SPDX-License-Identifier: Apache-2.0
// Pose errors. ADI: Hinterstoisser et al. Model Based Training, Detection and Pose Estimation. ACCV
// 2012. MSSD, MSPD, VSD: Hodan et al. BOP Challenge 2020 on 6D Object Localization. ECCVW 2020,
// and, for VSD's visibility, BOP's toolkit ("bop19").
#pragma once

#include <span>
#include <vector>

#include "ostraka/cloud/pinhole_camera.hpp"
#include "ostraka/views/ray_scene.hpp"

namespace ostraka {

/// ADI: mean distance from each model point at its true pose to the closest model point at the
/// estimated pose. Forgives symmetry. In the points' unit; 0 for no points.
double adi_error(std::span<const Vec3f> model_points, const Pose& T_scene_model_true,
                 const Pose& T_scene_model_estimated);

/// MSSD: the greatest distance of a model point from where it should be, least over symmetries.
/// @param symmetries  T_model_model: symmetry_motions(), the identity among them.
/// @return in the points' unit; 0 for no points.
double mssd_error(std::span<const Vec3f> model_points, std::span<const Pose> symmetries,
                  const Pose& T_scene_model_true, const Pose& T_scene_model_estimated);

/// MSPD: the same with distances in the image, in pixels.
/// @param T_camera_model_true, T_camera_model_estimated  poses in the camera's frame. A point that
///        is not in front of the camera makes the error infinite.
double mspd_error(std::span<const Vec3f> model_points, std::span<const Pose> symmetries,
                  const Pose& T_camera_model_true, const Pose& T_camera_model_estimated,
                  const PinholeCamera& camera);

struct VsdSettings {
    double delta = 15.0;  ///< tolerance of the visibility, unit of the scan (15 mm in BOP)
    std::vector<double> tolerances = {0.05, 0.10, 0.15, 0.20, 0.25,
                                      0.30, 0.35, 0.40, 0.45, 0.50};  ///< tau, in diameters
};

/// Distances from the camera's center to what each pixel sees of a placed mesh, row-major; 0: none.
std::vector<double> distance_image(const RayModel& model, const PinholeCamera& camera,
                                   const Pose& T_camera_model);

/// VSD: the share of the visible pixels of both poses where they differ by tau or more.
/// @param scan       distances from the camera's center, as distance_image(); 0: no return.
/// @param truth, estimate  distance_image() of the model at both poses.
/// @param diameter   of the model.
/// @return one error, 0 to 1, for each of settings.tolerances.
std::vector<double> vsd_errors(std::span<const double> scan, std::span<const double> truth,
                               std::span<const double> estimate, double diameter,
                               const VsdSettings& settings = {});

}  // namespace ostraka
