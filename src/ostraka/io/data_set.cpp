// SPDX-License-Identifier: Apache-2.0
#include "ostraka/io/data_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "ostraka/base/error.hpp"
#include "ostraka/io/bytes.hpp"
#include "ostraka/io/cloud_file.hpp"
#include "ostraka/io/data_set_readers.hpp"
#include "ostraka/io/folder_files.hpp"
#include "ostraka/io/png_file.hpp"

namespace ostraka {
namespace {

PointCloud read_depth_scan(const RecordedScene& scene) {
    if (lower_extension(scene.scan) != ".png") {
        throw InvalidInput(
            fmt::format("{}: depth images are read from 16-bit PNG files only; convert it",
                        scene.scan.string()));
    }
    const DepthImage16 image = read_depth_png16(scene.scan);
    const PinholeCamera& camera = scene.depth->camera;
    if (camera.width != 0 && (camera.width != image.width || camera.height != image.height)) {
        throw FormatError(scene.scan, "header",
                          fmt::format("is of {} x {} pixels, its camera of {} x {}", image.width,
                                      image.height, camera.width, camera.height));
    }
    return depth_cloud(image, *scene.depth);
}

}  // namespace

std::string_view data_set_kind_name(DataSetKind kind) {
    switch (kind) {
        case DataSetKind::ostraka:
            return "ostraka";
        case DataSetKind::bop:
            return "bop";
        case DataSetKind::bologna:
            return "bologna";
        case DataSetKind::uwa:
            return "uwa";
    }
    return "";
}

DataSet open_data_set(const std::filesystem::path& folder) {
    // The kinds whose files lie at known places come first: the others search.
    for (const auto& open : {open_ostraka, open_bop, open_bologna, open_uwa}) {
        if (std::optional<DataSet> set = open(folder)) {
            if (set->kind != DataSetKind::bop) {
                for (std::size_t i = 0; i < set->scenes.size(); ++i) {
                    set->scenes[i].image = static_cast<int>(i);
                }
            }
            return std::move(*set);
        }
    }
    throw InvalidInput(fmt::format(
        "{}: is no known data set; sought scene_NUMBER.json (simulated by Ostraka), scene_gt.json "
        "or scene_camera.json in numbered folders (BOP), Config*.ini with [MODELS] and [SCENE] "
        "(Bologna), MODEL-rsNUMBER.xf (UWA)",
        folder.string()));
}

PointCloud read_scan(const RecordedScene& scene) {
    if (scene.scan.empty()) {
        throw InvalidInput(fmt::format("scene {}: its scan isn't there", scene.name));
    }
    if (scene.depth) return read_depth_scan(scene);
    CloudFile file = read_cloud_file(scene.scan);
    if (scene.viewpoint && !file.has_viewpoint) file.cloud.viewpoint = *scene.viewpoint;
    return std::move(file.cloud);
}

void sort_models(DataSet& set) {
    std::vector<std::uint32_t> order(set.models.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return natural_less(set.models[a].name, set.models[b].name);
    });
    std::vector<RecordedModel> models;
    std::vector<std::uint32_t> now(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        models.push_back(std::move(set.models[order[i]]));
        now[order[i]] = static_cast<std::uint32_t>(i);
    }
    set.models = std::move(models);
    for (RecordedScene& scene : set.scenes) {
        for (RecordedObject& object : scene.objects) object.model = now[object.model];
    }
}

std::uint32_t model_of_name(DataSet& set, const std::string& name) {
    const auto found = std::find_if(set.models.begin(), set.models.end(),
                                    [&](const RecordedModel& m) { return m.name == name; });
    if (found == set.models.end()) {
        set.models.push_back({.name = name, .file = {}});
        return static_cast<std::uint32_t>(set.models.size() - 1);
    }
    return static_cast<std::uint32_t>(found - set.models.begin());
}

}  // namespace ostraka
