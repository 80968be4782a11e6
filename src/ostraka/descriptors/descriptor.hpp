// SPDX-License-Identifier: Apache-2.0
// Run-time choice of a descriptor: a cloud in, rows of floats out.
#pragma once

#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/cvfh.hpp"
#include "ostraka/descriptors/esf.hpp"
#include "ostraka/descriptors/fpfh.hpp"
#include "ostraka/descriptors/gasd.hpp"
#include "ostraka/descriptors/gasd_color.hpp"
#include "ostraka/descriptors/our_cvfh.hpp"
#include "ostraka/descriptors/pfh.hpp"
#include "ostraka/descriptors/rops.hpp"
#include "ostraka/descriptors/shot.hpp"
#include "ostraka/descriptors/spin_image.hpp"
#include "ostraka/descriptors/vfh.hpp"

namespace ostraka {

/// Every descriptor, as its settings; the global ones first. To add one: a header, a source, an
/// entry here, a line of traits, a test.
using AnyDescriptor =
    std::variant<VfhSettings, EsfSettings, GasdSettings, GlobalShotSettings, GlobalRopsSettings,
                 GasdColorSettings, CvfhSettings, OurCvfhSettings, ShotSettings, RopsSettings,
                 PfhSettings, FpfhSettings, SpinImageSettings>;

/// How many rows a piece gets.
enum class DescriptorKind {
    global,    ///< one
    regional,  ///< one for each smooth region
    local,     ///< one for each point
};

/// Describes a piece.
/// @param cloud  at least 3 points, all finite, with unit normals; any rigid motion of it (with its
///               viewpoint) gives the same rows.
/// @param descriptor  a local one with a radius of 0 gets a support of 15 mesh resolutions.
/// @return rows x descriptor_length() finite floats, row-major; the kind says how many rows. A
///         point whose local row is undefined has a row of 0.
/// @throws InvalidInput if there are fewer than 3 points, normals are missing, or a point is not
///         finite, or colors are missing where the descriptor needs them.
std::vector<float> describe(const PointCloud& cloud, const AnyDescriptor& descriptor);

/// Floats in a row.
std::size_t descriptor_length(const AnyDescriptor& descriptor);

/// One row, one a region, or one a point.
DescriptorKind descriptor_kind(const AnyDescriptor& descriptor);

/// "global", "regional" or "local".
std::string_view descriptor_kind_name(DescriptorKind kind);

/// The descriptor's name: "vfh", "esf", "gasd", "shot", "rops", "gasd_color", "cvfh", "our_cvfh",
/// "shot_local", "rops_local", "pfh", "fpfh", "spin_image".
std::string_view descriptor_name(const AnyDescriptor& descriptor);

/// The descriptor of that name with its default settings; nothing if there is none.
std::optional<AnyDescriptor> parse_descriptor(std::string_view name);

/// All descriptors with their default settings, in the order of AnyDescriptor.
std::vector<AnyDescriptor> all_descriptors();

/// Those that a library holds unless told otherwise: "vfh", "esf", "gasd", "shot", "rops".
std::vector<AnyDescriptor> global_descriptors();

}  // namespace ostraka
