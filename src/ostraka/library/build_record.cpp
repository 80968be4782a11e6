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

constexpr std::size_t kLeastSurface = 100;  // points on which a symmetry can be judged

// From the canonical frame, in which a model is looked at, to the frame of its file.
void to_model_frame(ModelRecord& built, const Pose& T_model_canonical) {
    Symmetry& symmetry = built.model.symmetry;
    symmetry.center = T_model_canonical * symmetry.center;
    for (Pose& turn : symmetry.turns) {
        turn = T_model_canonical * turn * T_model_canonical.inverse();
    }
    for (ContinuousAxis& axis : symmetry.axes) {
        axis.direction = T_model_canonical.linear() * axis.direction;
        axis.point = T_model_canonical * axis.point;
    }
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

// What entries stand for is averaged over many pieces, each of which needs less care: with an
// eighth of ESF's samples, which would take most of a build's time, recognition rates are the same.
LibrarySettings for_companions(LibrarySettings settings) {
    for (AnyDescriptor& descriptor : settings.descriptors) {
        if (auto* esf = std::get_if<EsfSettings>(&descriptor)) esf->samples /= 8;
    }
    return settings;
}

// All descriptors of a piece in turn: its points are in the cache, and items are of one size.
std::vector<std::vector<float>> describe_all(const PointCloud& cloud,
                                             const PieceTriangles& triangles,
                                             const LibrarySettings& settings) {
    std::vector<std::vector<float>> rows;
    for (const AnyDescriptor& descriptor : settings.descriptors) {
        rows.push_back(std::holds_alternative<GlobalRopsSettings>(descriptor)
                           ? describe_global_rops(cloud, triangles)
                           : describe(cloud, descriptor));
    }
    return rows;
}

void describe_entries(ModelRecord& record, const Choice& choice, std::span<const ModelView> views,
                      const LibrarySettings& settings) {
    const std::vector<Companion>& companions = choice.companions;
    const std::size_t entries = record.entries.size();
    const LibrarySettings coarse = for_companions(settings);
    std::vector<std::vector<std::vector<float>>> described(entries + companions.size());
    parallel_for(described.size(), [&](std::size_t i) {
        if (i < entries) {
            described[i] = describe_all(record.entries[i].cloud, choice.triangles[i], settings);
        } else {
            const Piece piece = piece_of(companions[i - entries], views, choice);
            described[i] = describe_all(piece.cloud, piece.triangles, coarse);
        }
    });
    std::vector<std::vector<std::size_t>> members(entries);  // of each entry: itself, companions
    for (std::size_t i = 0; i < described.size(); ++i) {
        members[i < entries ? i : companions[i - entries].entry].push_back(i);
    }
    const auto directions = static_cast<std::size_t>(settings.selection.spread);
    record.rows.resize(settings.descriptors.size());
    record.spreads.resize(settings.descriptors.size());
    parallel_for(settings.descriptors.size(), [&](std::size_t t) {
        const Metric metric = best_metric(settings.descriptors[t]);
        for (std::size_t e = 0; e < entries; ++e) {
            const std::vector<float>& own = described[e][t];
            record.rows[t].insert(record.rows[t].end(), own.begin(), own.end());
            if (companions.empty()) continue;
            std::vector<float> rows;
            for (const std::size_t i : members[e]) {
                const std::vector<float> row = comparable_row(described[i][t], metric);
                rows.insert(rows.end(), row.begin(), row.end());
            }
            append_spread(rows, own.size(), directions, record.spreads[t]);
        }
    });
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
    if (model.surface.size() >= kLeastSurface) {
        model.symmetry = find_symmetry(model.surface, 2.0 * model.shape.radius);
    }
    Choice choice = choose_entries(views, model.surface, model.symmetry, settings, model.counts);
    built.entries = std::move(choice.entries);
    model.keypoints = describe_keypoints(model.surface, views, settings);
    to_model_frame(built, T_model_canonical);
    describe_entries(built, choice, views, settings);
    return built;
}

// Entries are kept as they will be stored, so that a library is the same before and after saving.
void strip(Entry& entry, const MeshShape& shape) {
    entry.cloud.normals.clear();
    for (Vec3f& point : entry.cloud.points) {
        point = decode_point(encode_point(point, shape), shape);
    }
}

}  // namespace

ModelRecord build_record(const ModelSource& source, const LibrarySettings& settings,
                         const std::function<void(std::size_t)>& step) {
    ModelRecord record = look_at(source, settings, step);
    for (Entry& entry : record.entries) strip(entry, record.model.shape);
    return record;
}

}  // namespace ostraka
