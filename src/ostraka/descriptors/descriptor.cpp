// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/descriptor.hpp"

#include <fmt/format.h>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

// What describe() needs to know of a descriptor; one overload of each per entry of AnyDescriptor.
std::vector<float> row_of(const PointCloud& cloud, const VfhSettings& settings) {
    return describe_vfh(cloud, settings);
}
std::vector<float> row_of(const PointCloud& cloud, const EsfSettings& settings) {
    return describe_esf(cloud, settings);
}
std::vector<float> row_of(const PointCloud& cloud, const GasdSettings& settings) {
    return describe_gasd(cloud, settings);
}
std::vector<float> row_of(const PointCloud& cloud, const GlobalShotSettings& settings) {
    return describe_global_shot(cloud, settings);
}
std::vector<float> row_of(const PointCloud& cloud, const GlobalRopsSettings& settings) {
    return describe_global_rops(cloud, settings);
}

struct Traits {
    std::string_view name;
    std::size_t length;
};

constexpr Traits traits(const VfhSettings& /*settings*/) {
    return {"vfh", kVfhLength};
}
constexpr Traits traits(const EsfSettings& /*settings*/) {
    return {"esf", kEsfLength};
}
constexpr Traits traits(const GasdSettings& /*settings*/) {
    return {"gasd", kGasdLength};
}
constexpr Traits traits(const GlobalShotSettings& /*settings*/) {
    return {"shot", kShotLength};
}
constexpr Traits traits(const GlobalRopsSettings& /*settings*/) {
    return {"rops", kRopsLength};
}

Traits traits_of(const AnyDescriptor& descriptor) {
    return std::visit([](const auto& settings) { return traits(settings); }, descriptor);
}

}  // namespace

std::vector<float> describe(const PointCloud& cloud, const AnyDescriptor& descriptor) {
    check(cloud);
    if (cloud.size() < 3) {
        throw InvalidInput(fmt::format("{}: {} points, at least 3 are needed",
                                       descriptor_name(descriptor), cloud.size()));
    }
    if (cloud.normals.empty()) {
        throw InvalidInput(
            fmt::format("{}: the cloud has no normals", descriptor_name(descriptor)));
    }
    return std::visit([&](const auto& settings) { return row_of(cloud, settings); }, descriptor);
}

std::size_t descriptor_length(const AnyDescriptor& descriptor) {
    return traits_of(descriptor).length;
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
    return {VfhSettings{}, EsfSettings{}, GasdSettings{}, GlobalShotSettings{},
            GlobalRopsSettings{}};
}

}  // namespace ostraka
