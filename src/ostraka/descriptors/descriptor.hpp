// SPDX-License-Identifier: Apache-2.0
// Run-time choice of a global descriptor: a cloud in, one row of floats out.
#pragma once

#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/esf.hpp"
#include "ostraka/descriptors/gasd.hpp"
#include "ostraka/descriptors/rops.hpp"
#include "ostraka/descriptors/shot.hpp"
#include "ostraka/descriptors/vfh.hpp"

namespace ostraka {

/// Every global descriptor, as its settings. To add one: a header, a source, an entry here, a test.
using AnyDescriptor =
    std::variant<VfhSettings, EsfSettings, GasdSettings, GlobalShotSettings, GlobalRopsSettings>;

/// Describes a whole piece.
/// @param cloud  at least 3 points, all finite, with unit normals; any rigid motion of it (with its
///               viewpoint) gives the same row.
/// @return descriptor_length() finite floats.
/// @throws InvalidInput if there are fewer than 3 points or normals are missing.
std::vector<float> describe(const PointCloud& cloud, const AnyDescriptor& descriptor);

/// Floats in a row.
std::size_t descriptor_length(const AnyDescriptor& descriptor);

/// The descriptor's name: "vfh", "esf", "gasd", "shot", "rops".
std::string_view descriptor_name(const AnyDescriptor& descriptor);

/// The descriptor of that name with its default settings; nothing if there is none.
std::optional<AnyDescriptor> parse_descriptor(std::string_view name);

/// All descriptors with their default settings, in the order of AnyDescriptor.
std::vector<AnyDescriptor> all_descriptors();

}  // namespace ostraka
