// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/descriptor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "ostraka/base/error.hpp"
#include "ostraka/cloud/resample.hpp"
#include "ostraka/descriptors/checks.hpp"

namespace ostraka {
namespace {

// Support of a local descriptor that is given no radius, in mesh resolutions.
constexpr double kLocalRadius = 15.0;

// The radius to use; nothing if none is given and the points have no extent.
std::optional<float> radius_for(const PointCloud& cloud, float radius) {
    if (radius != 0.0F) return radius;
    const double derived = kLocalRadius * mesh_resolution(cloud.points);
    if (!(derived > 0.0)) return std::nullopt;
    return static_cast<float>(std::min(derived, double{kLargestCoordinate}));
}

// One row for each point, by describe_at(settings with a radius).
template <class Settings, class DescribeAt>
std::vector<float> rows_at_points(const PointCloud& cloud, Settings settings, std::size_t length,
                                  const DescribeAt& describe_at) {
    require_points(cloud, descriptor_name(settings));
    const std::optional<float> radius = radius_for(cloud, settings.radius);
    if (!radius) return std::vector<float>(cloud.size() * length, 0.0F);
    settings.radius = *radius;
    return describe_at(settings).rows;
}

// What describe() needs to know of a descriptor; one overload of each per entry of AnyDescriptor.
std::vector<float> rows_of(const PointCloud& cloud, const VfhSettings& settings) {
    return describe_vfh(cloud, settings);
}
std::vector<float> rows_of(const PointCloud& cloud, const EsfSettings& settings) {
    return describe_esf(cloud, settings);
}
std::vector<float> rows_of(const PointCloud& cloud, const GasdSettings& settings) {
    return describe_gasd(cloud, settings);
}
std::vector<float> rows_of(const PointCloud& cloud, const GlobalShotSettings& settings) {
    return describe_global_shot(cloud, settings);
}
std::vector<float> rows_of(const PointCloud& cloud, const GlobalRopsSettings& settings) {
    return describe_global_rops(cloud, settings);
}
std::vector<float> rows_of(const PointCloud& cloud, const GasdColorSettings& settings) {
    return describe_gasd_color(cloud, settings);
}
std::vector<float> rows_of(const PointCloud& cloud, const CvfhSettings& settings) {
    return describe_cvfh(cloud, settings).rows;
}
std::vector<float> rows_of(const PointCloud& cloud, const OurCvfhSettings& settings) {
    return describe_our_cvfh(cloud, settings).rows;
}
std::vector<float> rows_of(const PointCloud& cloud, const ShotSettings& settings) {
    return rows_at_points(cloud, settings, kShotLength, [&](const ShotSettings& with) {
        return describe_shot(cloud, cloud.points, with);
    });
}
std::vector<float> rows_of(const PointCloud& cloud, const RopsSettings& settings) {
    return rows_at_points(cloud, settings, kRopsLength, [&](const RopsSettings& with) {
        return describe_rops(cloud, triangulate(cloud), cloud.points, with);
    });
}
std::vector<float> rows_of(const PointCloud& cloud, const PfhSettings& settings) {
    return rows_at_points(cloud, settings, kPfhLength, [&](const PfhSettings& with) {
        return describe_pfh(cloud, cloud.points, with);
    });
}
std::vector<float> rows_of(const PointCloud& cloud, const FpfhSettings& settings) {
    return rows_at_points(cloud, settings, kFpfhLength,
                          [&](const FpfhSettings& with) { return describe_fpfh(cloud, with); });
}
std::vector<float> rows_of(const PointCloud& cloud, const SpinImageSettings& settings) {
    const std::size_t length = spin_image_length(settings);
    return rows_at_points(cloud, settings, length, [&](const SpinImageSettings& with) {
        return describe_spin_images(cloud, cloud.points, cloud.normals, with);
    });
}

struct Traits {
    std::string_view name;
    std::size_t length;
    DescriptorKind kind;
};

constexpr Traits traits(const VfhSettings& /*settings*/) {
    return {"vfh", kVfhLength, DescriptorKind::global};
}
constexpr Traits traits(const EsfSettings& /*settings*/) {
    return {"esf", kEsfLength, DescriptorKind::global};
}
constexpr Traits traits(const GasdSettings& /*settings*/) {
    return {"gasd", kGasdLength, DescriptorKind::global};
}
constexpr Traits traits(const GlobalShotSettings& /*settings*/) {
    return {"shot", kShotLength, DescriptorKind::global};
}
constexpr Traits traits(const GlobalRopsSettings& /*settings*/) {
    return {"rops", kRopsLength, DescriptorKind::global};
}
constexpr Traits traits(const GasdColorSettings& /*settings*/) {
    return {"gasd_color", kGasdColorLength, DescriptorKind::global};
}
constexpr Traits traits(const CvfhSettings& /*settings*/) {
    return {"cvfh", kCvfhLength, DescriptorKind::regional};
}
constexpr Traits traits(const OurCvfhSettings& /*settings*/) {
    return {"our_cvfh", kOurCvfhLength, DescriptorKind::regional};
}
constexpr Traits traits(const ShotSettings& /*settings*/) {
    return {"shot_local", kShotLength, DescriptorKind::local};
}
constexpr Traits traits(const RopsSettings& /*settings*/) {
    return {"rops_local", kRopsLength, DescriptorKind::local};
}

constexpr Traits traits(const PfhSettings& /*settings*/) {
    return {"pfh", kPfhLength, DescriptorKind::local};
}
constexpr Traits traits(const FpfhSettings& /*settings*/) {
    return {"fpfh", kFpfhLength, DescriptorKind::local};
}
constexpr Traits traits(const SpinImageSettings& settings) {
    return {"spin_image", spin_image_length(settings), DescriptorKind::local};
}

Traits traits_of(const AnyDescriptor& descriptor) {
    return std::visit([](const auto& settings) { return traits(settings); }, descriptor);
}

template <std::size_t... kIndices>
std::vector<AnyDescriptor> each_with_defaults(std::index_sequence<kIndices...> /*indices*/) {
    return {AnyDescriptor(std::in_place_index<kIndices>)...};
}

}  // namespace

std::vector<float> describe(const PointCloud& cloud, const AnyDescriptor& descriptor) {
    check(cloud);
    if (cloud.size() < 3) {
        throw InvalidInput(fmt::format("{}: {} points, at least 3 are needed",
                                       descriptor_name(descriptor), cloud.size()));
    }
    require_normals(cloud, descriptor_name(descriptor));
    return std::visit([&](const auto& settings) { return rows_of(cloud, settings); }, descriptor);
}

std::size_t descriptor_length(const AnyDescriptor& descriptor) {
    return traits_of(descriptor).length;
}

DescriptorKind descriptor_kind(const AnyDescriptor& descriptor) {
    return traits_of(descriptor).kind;
}

std::string_view descriptor_kind_name(DescriptorKind kind) {
    switch (kind) {
        case DescriptorKind::regional:
            return "regional";
        case DescriptorKind::local:
            return "local";
        case DescriptorKind::global:
            break;
    }
    return "global";
}

std::string_view descriptor_name(const AnyDescriptor& descriptor) {
    return traits_of(descriptor).name;
}

std::optional<AnyDescriptor> parse_descriptor(std::string_view name) {
    for (const AnyDescriptor& descriptor : all_descriptors()) {
        if (descriptor_name(descriptor) == name) return descriptor;
    }
    return std::nullopt;
}

std::vector<AnyDescriptor> all_descriptors() {
    return each_with_defaults(std::make_index_sequence<std::variant_size_v<AnyDescriptor>>());
}

std::vector<AnyDescriptor> global_descriptors() {
    return {VfhSettings{}, EsfSettings{}, GasdSettings{}, GlobalShotSettings{},
            GlobalRopsSettings{}};
}

}  // namespace ostraka
