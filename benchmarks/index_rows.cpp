// SPDX-License-Identifier: Apache-2.0
#include "index_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"
#include "ostraka/descriptors/metric.hpp"
#include "ostraka/descriptors/shot.hpp"
#include "ostraka/simulation/parts.hpp"
#include "ostraka/subparts/cuts.hpp"
#include "ostraka/views/model_views.hpp"

namespace ostraka::bench {
namespace {

constexpr std::size_t kBatch = 32;               // models made at a time
constexpr double kSampling = 0.015;              // of the model's diameter
constexpr int kViews = 42;                       // vertices of the subdivided icosahedron
constexpr int kQueryViews = 80;                  // centers of its faces: none is a vertex
constexpr std::uint32_t kMagic = 0x31'57'52'49;  // "IRW1"
constexpr std::array<double, 4> kFractions = {0.35, 0.5, 0.65, 0.8};
constexpr std::array<double, 3> kQueryFractions = {0.42, 0.57, 0.72};

struct ModelRows {
    std::vector<float> library;
    std::vector<float> queries;
};

void append_row(const PointCloud& piece, std::vector<float>& rows) {
    const std::vector<float> row =
        comparable_row(describe_global_shot(piece), best_metric(GlobalShotSettings{}));
    rows.insert(rows.end(), row.begin(), row.end());
}

// One fraction a view, drawn anew for each, so that models don't share a pattern.
void append_cuts(const ModelView& view, double fraction, double sampling, bool whole,
                 std::vector<float>& rows) {
    if (view.cloud.size() < 60) return;  // a plate seen from its edge
    if (whole) append_row(view.cloud, rows);
    const CutSettings settings{
        .directions = 6, .fractions = {fraction}, .cluster_tolerance = 2.0 * sampling};
    const CutResult cuts = cut_view(view.cloud, principal_frame(view.cloud), settings);
    for (const Subpart& subpart : cuts.subparts) {
        append_row(select(view.cloud, subpart.indices), rows);
    }
}

ModelRows rows_of_model(std::size_t number, bool with_queries) {
    const std::vector<PartKind> kinds = all_parts();
    const TriangleMesh mesh =
        make_part(kinds[number % kinds.size()],
                  {.seed = 1 + number / kinds.size(), .resolution = 64, .tolerance = 0.1});
    const MeshShape shape = measure(mesh);
    const RayScene scene({mesh});
    const double sampling = kSampling * shape.diameter;
    Random random(1, number);
    ModelRows rows;
    for (int v = 0; v < kViews; ++v) {
        const ViewSettings settings{.count = kViews, .sampling = sampling, .rays_per_sample = 1.5};
        const double fraction = kFractions[random.below(kFractions.size())];
        append_cuts(make_view(scene, shape, settings, v), fraction, sampling, true, rows.library);
    }
    if (!with_queries) return rows;
    const ViewSettings settings{.count = kQueryViews, .sampling = sampling, .rays_per_sample = 1.5};
    const double fraction = kQueryFractions[random.below(kQueryFractions.size())];
    const auto view = static_cast<int>(random.below(kQueryViews));
    append_cuts(make_view(scene, shape, settings, view), fraction, sampling, false, rows.queries);
    return rows;
}

bool read_cache(const std::filesystem::path& path, std::size_t count, std::size_t queries,
                IndexRows& rows) {
    std::ifstream file(path, std::ios::binary);
    std::array<std::uint64_t, 4> head{};
    if (!file.read(reinterpret_cast<char*>(head.data()), sizeof(head))) return false;
    if (head[0] != kMagic || head[1] != rows.length || head[2] != count || head[3] > queries) {
        return false;
    }
    rows.library.resize(count * rows.length);
    rows.queries.resize(head[3] * rows.length);
    const auto bytes = [](const auto& v) { return static_cast<std::streamsize>(v.size() * 4); };
    file.read(reinterpret_cast<char*>(rows.queries.data()), bytes(rows.queries));
    file.read(reinterpret_cast<char*>(rows.library.data()), bytes(rows.library));
    return file.good();
}

void write_cache(const std::filesystem::path& path, const IndexRows& rows) {
    std::ofstream file(path, std::ios::binary);
    const std::array<std::uint64_t, 4> head = {kMagic, rows.length, rows.size(),
                                               rows.query_count()};
    const auto bytes = [](const auto& v) { return static_cast<std::streamsize>(v.size() * 4); };
    file.write(reinterpret_cast<const char*>(head.data()), sizeof(head));
    file.write(reinterpret_cast<const char*>(rows.queries.data()), bytes(rows.queries));
    file.write(reinterpret_cast<const char*>(rows.library.data()), bytes(rows.library));
    if (!file.flush()) throw FileError(path, "can't be written");
}

}  // namespace

IndexRows index_rows(std::size_t count, std::size_t queries, const std::filesystem::path& cache) {
    IndexRows rows;
    rows.length = kShotLength;
    if (!cache.empty() && read_cache(cache, count, queries, rows)) return rows;
    rows.library.reserve(count * rows.length);
    // A model gives about 275 rows, and at most 6 queries.
    const std::size_t models = std::max<std::size_t>(1, count / 275);
    const std::size_t stride =
        std::max<std::size_t>(1, 5 * models / std::max<std::size_t>(1, queries));
    for (std::size_t first = 0; rows.library.size() < count * rows.length; first += kBatch) {
        std::vector<ModelRows> batch(kBatch);
        parallel_for(kBatch, [&](std::size_t i) {
            batch[i] = rows_of_model(first + i, (first + i) % stride == 0);
        });
        for (const ModelRows& model : batch) {
            rows.library.insert(rows.library.end(), model.library.begin(), model.library.end());
            rows.queries.insert(rows.queries.end(), model.queries.begin(), model.queries.end());
        }
        fmt::print(stderr, "\r{} rows of {} models", rows.size(), first + kBatch);
    }
    fmt::print(stderr, "\n");
    rows.library.resize(count * rows.length);
    rows.queries.resize(std::min(rows.queries.size(), queries * rows.length));
    if (!cache.empty()) write_cache(cache, rows);
    return rows;
}

}  // namespace ostraka::bench
