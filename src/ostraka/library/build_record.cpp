// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/build_record.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/library/candidates.hpp"
#include "ostraka/library/encoding.hpp"
#include "ostraka/library/keypoints.hpp"
#include "ostraka/library/model_surface.hpp"

namespace ostraka {
namespace {

// From the canonical frame, in which a model is looked at, to the frame of its file.
void to_model_frame(ModelRecord& built, const Pose& T_model_canonical) {
    const Mat3f R_model_canonical = T_model_canonical.linear().cast<float>();
    built.model.surface = transformed(built.model.surface, T_model_canonical);
    for (Vec3f& point : built.model.keypoints.points) {
        point = (T_model_canonical * point.cast<double>()).cast<float>();
    }
    for (Mat3f& frame : built.model.keypoints.frames) frame = R_model_canonical * frame;
    for (Entry& entry : built.entries) {
        entry.cloud = transformed(entry.cloud, T_model_canonical);
        entry.frame.T_cloud_frame = T_model_canonical * entry.frame.T_cloud_frame;
    }
}

ModelRecord look_at(const ModelSource& source, const LibrarySettings& settings,
                    const std::function<void(std::size_t)>& step) {
    ModelRecord built;
    Model& model = built.model;
    model.name = source.name;
    model.file = source.file;
    model.sha256 = source.sha256;
    model.mesh = source.mesh;
    model.shape = measure(source.mesh);
    Pose T_model_canonical = Pose::Identity();
    T_model_canonical.linear() = model.shape.axes;
    T_model_canonical.translation() = model.shape.center;
    MeshShape canonical = model.shape;
    canonical.center.setZero();
    canonical.axes.setIdentity();
    const RayScene rays({transformed(source.mesh, T_model_canonical.inverse())});

    const auto count = static_cast<std::size_t>(settings.views.count);
    std::vector<RenderedView> rendered(count);
    std::vector<ModelView> views(count);
    parallel_for(count, [&](std::size_t v) {
        rendered[v] = render_view(rays, canonical, settings.views, static_cast<int>(v));
        views[v] = make_view(rendered[v], settings.views, static_cast<int>(v));
        step(1);
    });
    model.surface = merge_surface(rendered, settings.sampling);
    if (model.surface.empty()) {
        throw InvalidInput(fmt::format("model {}: nothing of it can be seen at sampling {:.6g}",
                                       model.name, settings.sampling));
    }
    built.entries = choose_entries(views, model.surface, settings, model.counts);
    model.keypoints = describe_keypoints(model.surface, views, settings);
    to_model_frame(built, T_model_canonical);
    return built;
}

// Entries are kept as they will be stored, so that a library is the same before and after saving.
void strip(Entry& entry, const MeshShape& shape) {
    entry.cloud.normals.clear();
    for (Vec3f& point : entry.cloud.points) {
        point = decode_point(encode_point(point, shape), shape);
    }
}

void describe_entries(ModelRecord& record, const LibrarySettings& settings) {
    const std::size_t count = record.entries.size();
    for (const AnyDescriptor& descriptor : settings.descriptors) {
        record.rows.emplace_back(count * descriptor_length(descriptor));
    }
    // All descriptors of an entry in turn: its points are in the cache, and items are of one size.
    parallel_for(count, [&](std::size_t i) {
        for (std::size_t t = 0; t < record.rows.size(); ++t) {
            const std::vector<float> row =
                describe(record.entries[i].cloud, settings.descriptors[t]);
            std::copy(row.begin(), row.end(),
                      record.rows[t].begin() + static_cast<std::ptrdiff_t>(i * row.size()));
        }
    });
}

}  // namespace

ModelRecord build_record(const ModelSource& source, const LibrarySettings& settings,
                         const std::function<void(std::size_t)>& step) {
    ModelRecord record = look_at(source, settings, step);
    describe_entries(record, settings);
    for (Entry& entry : record.entries) strip(entry, record.model.shape);
    return record;
}

}  // namespace ostraka
