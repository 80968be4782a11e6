// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/library_format1.hpp"

#include <fmt/format.h>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/library/bags.hpp"
#include "ostraka/library/encoding.hpp"
#include "ostraka/library/settings_text.hpp"
#include "ostraka/library/sqlite.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kShapeNumbers = 14;
constexpr std::size_t kFrameNumbers = 15;

std::vector<Vec3f> unflat(const std::vector<float>& values) {
    if (values.size() % 3 != 0) throw InvalidInput("coordinates don't come in threes");
    std::vector<Vec3f> vectors(values.size() / 3);
    for (std::size_t i = 0; i < vectors.size(); ++i) {
        vectors[i] = Vec3f(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
        if (!vectors[i].allFinite()) throw InvalidInput(fmt::format("point {} is not finite", i));
    }
    return vectors;
}

void check_numbers(const std::vector<double>& values, std::size_t count) {
    if (values.size() != count) {
        throw InvalidInput(fmt::format("{} numbers instead of {}", values.size(), count));
    }
    for (const double value : values) {
        if (!std::isfinite(value)) throw InvalidInput("a number is not finite");
    }
}

MeshShape unpack_shape(const std::vector<double>& values) {
    check_numbers(values, kShapeNumbers);
    MeshShape shape;
    shape.center = Vec3d(values.data());
    shape.radius = values[3];
    shape.diameter = values[4];
    shape.axes = Mat3d(values.data() + 5);
    if (!(shape.radius > 0.0 && shape.diameter > 0.0)) throw InvalidInput("a model has no size");
    return shape;
}

PrincipalFrame unpack_frame(const std::vector<double>& values, std::int64_t ambiguity) {
    check_numbers(values, kFrameNumbers);
    PrincipalFrame frame;
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 3; ++row) {
            frame.T_cloud_frame.matrix()(row, column) =
                values[static_cast<std::size_t>(3 * column + row)];
        }
    }
    frame.deviations = Vec3d(values.data() + 12);
    frame.ambiguous_sign = (ambiguity & 1) != 0;
    frame.ambiguous_order = (ambiguity & 2) != 0;
    return frame;
}

Keypoints load_keypoints(const Statement& row, int column) {
    Keypoints keypoints;
    keypoints.points = unflat(row.blob<float>(column));
    const std::vector<float> frames = row.blob<float>(column + 1);
    keypoints.rows = row.blob<std::uint8_t>(column + 2);
    if (frames.size() != 9 * keypoints.size() ||
        keypoints.rows.size() != kShotLength * keypoints.size()) {
        throw InvalidInput("keypoint columns differ in length");
    }
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
        keypoints.frames.emplace_back(frames.data() + 9 * i);
        if (!keypoints.frames.back().allFinite()) throw InvalidInput("a frame is not finite");
    }
    return keypoints;
}

Model load_model_row(const Statement& row) {
    Model model;
    model.name = row.text(1);
    model.file = row.text(2);
    model.sha256 = row.text(3);
    model.mesh.vertices = unflat(row.blob<float>(4));
    const std::vector<std::uint32_t> triangles = row.blob<std::uint32_t>(5);
    if (triangles.empty() || triangles.size() % 3 != 0) throw InvalidInput("triangles are damaged");
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
        model.mesh.triangles.push_back({triangles[i], triangles[i + 1], triangles[i + 2]});
        for (const std::uint32_t vertex : model.mesh.triangles.back()) {
            if (vertex >= model.mesh.vertices.size())
                throw InvalidInput("a triangle names no vertex");
        }
    }
    model.shape = unpack_shape(row.blob<double>(6));
    std::vector<Vec3f> surface = unflat(row.blob<float>(7));
    if (surface.empty() || surface.size() % 2 != 0) throw InvalidInput("the surface is damaged");
    const auto half = surface.begin() + static_cast<std::ptrdiff_t>(surface.size() / 2);
    model.surface.points.assign(surface.begin(), half);
    model.surface.normals.assign(half, surface.end());
    model.keypoints = load_keypoints(row, 8);
    const std::vector<std::int32_t> c = row.blob<std::int32_t>(11);
    if (c.size() != 6) throw InvalidInput("counts are damaged");
    model.counts = {c[0], c[1], c[2], c[3], c[4], c[5], row.real(12), {}};
    return model;
}

Entry load_entry_row(const Statement& row, const std::vector<Model>& models) {
    Entry entry;
    const std::int64_t model = row.integer(1);
    if (model < 0 || model >= static_cast<std::int64_t>(models.size())) {
        throw InvalidInput("an entry names no model");
    }
    entry.model = static_cast<std::uint32_t>(model);
    entry.view = static_cast<int>(row.integer(2));
    entry.direction = static_cast<int>(row.integer(3));
    entry.fraction = static_cast<int>(row.integer(4));
    const std::vector<Vec3f> viewpoint = unflat(row.blob<float>(5));
    if (viewpoint.size() != 1) throw InvalidInput("a viewpoint is damaged");
    entry.cloud.viewpoint = viewpoint.front();
    entry.frame = unpack_frame(row.blob<double>(6), row.integer(7));
    for (const EncodedPoint& point : row.blob<EncodedPoint>(8)) {
        entry.cloud.points.push_back(decode_point(point, models[entry.model].shape));
    }
    if (entry.cloud.empty()) throw InvalidInput("an entry has no points");
    return entry;
}

void append_finite(std::vector<float>& rows, const std::vector<float>& row) {
    for (const float value : row) {
        if (!std::isfinite(value)) throw InvalidInput("a descriptor is not finite");
    }
    rows.insert(rows.end(), row.begin(), row.end());
}

std::vector<float> load_rows(Database& database, std::string_view name, std::size_t length,
                             std::size_t entries) {
    std::vector<float> rows;
    Statement select_rows(database,
                          "SELECT entry, row FROM descriptor WHERE name=? ORDER BY entry");
    select_rows.bind(1, std::string(name));
    std::size_t next = 0;
    for (; select_rows.step(); ++next) {
        const std::vector<float> row = select_rows.blob<float>(1);
        if (select_rows.integer(0) != static_cast<std::int64_t>(next) || row.size() != length) {
            throw InvalidInput(fmt::format("descriptor {} of entry {} is damaged", name, next));
        }
        append_finite(rows, row);
    }
    if (next != entries) {
        throw InvalidInput(
            fmt::format("descriptor {} has {} rows for {} entries", name, next, entries));
    }
    return rows;
}

// Files of before there were codebooks have no such table.
Codebook load_codebook(Database& database) {
    Codebook codebook{kShotLength, {}};
    if (database.number("SELECT count(*) FROM sqlite_master WHERE name='codebook'") == 0) {
        return codebook;
    }
    Statement words(database, "SELECT word, row FROM codebook ORDER BY word");
    while (words.step()) {
        const std::vector<float> word = words.blob<float>(1);
        if (words.integer(0) != static_cast<std::int64_t>(codebook.size()) ||
            word.size() != codebook.length) {
            throw InvalidInput(fmt::format("word {} of the codebook is damaged", codebook.size()));
        }
        append_finite(codebook.words, word);
    }
    return codebook;
}

ModelLibrary load_content(Database& database) {
    SettingTexts texts;
    Statement settings(database, "SELECT key, value FROM setting");
    while (settings.step()) texts[settings.text(0)] = settings.text(1);
    texts.try_emplace("selection.redundancy", "surface");
    texts.try_emplace("selection.spread", "0");
    ModelLibrary library;
    library.settings = settings_from_text(texts);
    Statement models(database, "SELECT * FROM model ORDER BY id");
    while (models.step()) {
        if (models.integer(0) != static_cast<std::int64_t>(library.models.size())) {
            throw InvalidInput("models are not numbered from 0");
        }
        library.models.push_back(load_model_row(models));
    }
    Statement entries(database, "SELECT * FROM entry ORDER BY id");
    while (entries.step()) library.entries.push_back(load_entry_row(entries, library.models));
    for (const AnyDescriptor& descriptor : library.settings.descriptors) {
        library.tables.push_back({descriptor,
                                  load_rows(database, descriptor_name(descriptor),
                                            descriptor_length(descriptor), library.entries.size()),
                                  {}});
    }
    library.codebook = load_codebook(database);
    if (library.codebook.size() > 0) {
        library.bags =
            load_rows(database, kBagOfWords, library.codebook.size(), library.entries.size());
    }
    if (library.models.empty()) throw InvalidInput("the library has no models");
    return library;
}

}  // namespace

ModelLibrary load_library_format1(const std::filesystem::path& path) {
    Database database(path, Database::Mode::read, path);
    try {
        return load_content(database);
    } catch (const InvalidInput& error) {
        throw FormatError(path, "library", error.what());
    }
}

}  // namespace ostraka
