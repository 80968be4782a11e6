// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/stored_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "ostraka/base/error.hpp"
#include "ostraka/base/sha256.hpp"
#include "ostraka/library/encoding.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kShapeNumbers = 14;
constexpr std::size_t kFrameNumbers = 15;
constexpr std::size_t kCounts = 6;

// Vectors and matrices, too, lie in memory as plain numbers, column by column.
template <class T>
Bytes to_bytes(std::span<const T> values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    return {bytes, bytes + values.size_bytes()};
}
template <class T>
Bytes to_bytes(const std::vector<T>& values) {
    return to_bytes(std::span<const T>(values));
}

const Cell& cell(const Row& row, std::size_t column) {
    if (column >= row.size()) throw InvalidInput("a row has too few columns");
    return row[column];
}

template <class T>
const T& as(const Row& row, std::size_t column) {
    const T* value = std::get_if<T>(&cell(row, column));
    if (value == nullptr) throw InvalidInput(fmt::format("column {} has another type", column));
    return *value;
}

// The blob of a column as values of T, all of them finite.
template <class T>
std::vector<T> values(const Row& row, std::size_t column) {
    const Bytes& bytes = as<Bytes>(row, column);
    if (bytes.size() % sizeof(T) != 0) {
        throw InvalidInput(fmt::format("column {} holds {} bytes, no multiple of {}", column,
                                       bytes.size(), sizeof(T)));
    }
    std::vector<T> result(bytes.size() / sizeof(T));
    if (!bytes.empty()) std::memcpy(result.data(), bytes.data(), bytes.size());
    if constexpr (std::is_floating_point_v<T>) {
        for (const T value : result) {
            if (!std::isfinite(value)) {
                throw InvalidInput(fmt::format("a number in column {} is not finite", column));
            }
        }
    }
    return result;
}

template <class T>
std::vector<T> exactly(const Row& row, std::size_t column, std::size_t count) {
    std::vector<T> result = values<T>(row, column);
    if (result.size() == count) return result;
    throw InvalidInput(
        fmt::format("column {} holds {} numbers instead of {}", column, result.size(), count));
}

std::vector<Vec3f> points(const Row& row, std::size_t column) {
    const std::vector<float> numbers = values<float>(row, column);
    if (numbers.size() % 3 != 0) throw InvalidInput("coordinates don't come in threes");
    std::vector<Vec3f> result(numbers.size() / 3);
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = Vec3f(numbers.data() + 3 * i);
    return result;
}

Bytes pack(const MeshShape& shape) {
    std::vector<double> numbers(shape.center.data(), shape.center.data() + 3);
    numbers.push_back(shape.radius);
    numbers.push_back(shape.diameter);
    numbers.insert(numbers.end(), shape.axes.data(), shape.axes.data() + 9);
    return to_bytes(numbers);
}

MeshShape unpack_shape(const std::vector<double>& numbers) {
    MeshShape shape;
    shape.center = Vec3d(numbers.data());
    shape.radius = numbers[3];
    shape.diameter = numbers[4];
    shape.axes = Mat3d(numbers.data() + 5);
    if (!(shape.radius > 0.0 && shape.diameter > 0.0)) throw InvalidInput("a model has no size");
    return shape;
}

// A pose as a 3 x 4 matrix, column by column.
void append(const Pose& pose, std::vector<double>& numbers) {
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 3; ++row) numbers.push_back(pose(row, column));
    }
}

Pose pose_at(const double* numbers) {
    Pose pose = Pose::Identity();
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 3; ++row) pose.matrix()(row, column) = numbers[3 * column + row];
    }
    return pose;
}

Bytes pack(const PrincipalFrame& frame) {
    std::vector<double> numbers;
    append(frame.T_cloud_frame, numbers);
    for (int axis = 0; axis < 3; ++axis) numbers.push_back(frame.deviations[axis]);
    return to_bytes(numbers);
}

PrincipalFrame unpack_frame(const std::vector<double>& numbers, std::int64_t ambiguity) {
    PrincipalFrame frame;
    frame.T_cloud_frame = pose_at(numbers.data());
    frame.deviations = Vec3d(numbers.data() + 12);
    frame.ambiguous_sign = (ambiguity & 1) != 0;
    frame.ambiguous_order = (ambiguity & 2) != 0;
    return frame;
}

// The center; the number of turns, and each as a 3 x 4 matrix, column by column; then direction and
// point of each axis.
Bytes pack(const Symmetry& symmetry) {
    std::vector<double> numbers(symmetry.center.data(), symmetry.center.data() + 3);
    numbers.push_back(static_cast<double>(symmetry.turns.size()));
    for (const Pose& turn : symmetry.turns) append(turn, numbers);
    for (const ContinuousAxis& axis : symmetry.axes) {
        numbers.insert(numbers.end(), axis.direction.data(), axis.direction.data() + 3);
        numbers.insert(numbers.end(), axis.point.data(), axis.point.data() + 3);
    }
    return to_bytes(numbers);
}

Symmetry unpack_symmetry(const std::vector<double>& numbers) {
    constexpr std::size_t kHead = 4;
    constexpr std::size_t kTurn = 12;
    constexpr std::size_t kAxis = 6;
    const double turns = numbers.size() < kHead ? -1.0 : numbers[3];
    const double most = static_cast<double>(numbers.size()) / kTurn;
    if (!(turns >= 0.0 && turns <= most)) throw InvalidInput("the symmetry is damaged");
    const auto turn_count = static_cast<std::size_t>(turns);
    const std::size_t axes_from = kHead + kTurn * turn_count;
    if (axes_from > numbers.size() || (numbers.size() - axes_from) % kAxis != 0) {
        throw InvalidInput("the symmetry is damaged");
    }
    Symmetry symmetry;
    symmetry.center = Vec3d(numbers.data());
    for (std::size_t t = 0; t < turn_count; ++t) {
        symmetry.turns.push_back(pose_at(numbers.data() + kHead + kTurn * t));
    }
    for (std::size_t i = axes_from; i < numbers.size(); i += kAxis) {
        symmetry.axes.push_back({Vec3d(numbers.data() + i), Vec3d(numbers.data() + i + 3)});
    }
    return symmetry;
}

Row model_row(const Model& model) {
    const BuildCounts& c = model.counts;
    std::vector<Vec3f> surface = model.surface.points;
    surface.insert(surface.end(), model.surface.normals.begin(), model.surface.normals.end());
    const std::vector<std::int32_t> counts = {c.views,     c.cuts,          c.too_small,
                                              c.redundant, c.beyond_budget, c.kept};
    return {model.name,
            model.file,
            model.sha256,
            to_bytes(model.mesh.vertices),
            to_bytes(model.mesh.triangles),
            pack(model.shape),
            to_bytes(surface),
            to_bytes(model.keypoints.points),
            to_bytes(model.keypoints.frames),
            to_bytes(model.keypoints.rows),
            to_bytes(counts),
            c.coverage,
            to_bytes(std::span<const double>(c.covered)),
            pack(model.symmetry)};
}

TriangleMesh unpack_mesh(const Row& row) {
    TriangleMesh mesh;
    mesh.vertices = points(row, 3);
    mesh.triangles = values<Triangle>(row, 4);
    if (mesh.triangles.empty()) throw InvalidInput("a model has no triangles");
    for (const Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t vertex : triangle) {
            if (vertex >= mesh.vertices.size()) throw InvalidInput("a triangle names no vertex");
        }
    }
    return mesh;
}

Keypoints unpack_keypoints(const Row& row) {
    Keypoints keypoints;
    keypoints.points = points(row, 7);
    const std::vector<float> frames = exactly<float>(row, 8, 9 * keypoints.size());
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
        keypoints.frames.emplace_back(frames.data() + 9 * i);
    }
    keypoints.rows = exactly<std::uint8_t>(row, 9, kShotLength * keypoints.size());
    return keypoints;
}

Model unpack_model(const Row& row) {
    Model model;
    model.name = as<std::string>(row, 0);
    model.file = as<std::string>(row, 1);
    model.sha256 = as<std::string>(row, 2);
    model.mesh = unpack_mesh(row);
    model.shape = unpack_shape(exactly<double>(row, 5, kShapeNumbers));
    const std::vector<Vec3f> surface = points(row, 6);
    if (surface.empty() || surface.size() % 2 != 0) throw InvalidInput("the surface is damaged");
    const auto half = surface.begin() + static_cast<std::ptrdiff_t>(surface.size() / 2);
    model.surface.points.assign(surface.begin(), half);
    model.surface.normals.assign(half, surface.end());
    model.keypoints = unpack_keypoints(row);
    const auto c = exactly<std::int32_t>(row, 10, kCounts);
    model.counts = {c[0], c[1], c[2], c[3], c[4], c[5], as<double>(row, 11), {}};
    const auto covered = exactly<double>(row, 12, model.counts.covered.size());
    std::copy(covered.begin(), covered.end(), model.counts.covered.begin());
    model.symmetry = unpack_symmetry(values<double>(row, 13));
    return model;
}

Row entry_row(const Entry& entry, const MeshShape& shape) {
    std::vector<EncodedPoint> encoded;
    for (const Vec3f& point : entry.cloud.points) encoded.push_back(encode_point(point, shape));
    const int ambiguity =
        (entry.frame.ambiguous_sign ? 1 : 0) + (entry.frame.ambiguous_order ? 2 : 0);
    return {std::int64_t{entry.view},
            std::int64_t{entry.direction},
            std::int64_t{entry.fraction},
            to_bytes(std::vector<Vec3f>{entry.cloud.viewpoint}),
            pack(entry.frame),
            std::int64_t{ambiguity},
            to_bytes(encoded)};
}

Entry unpack_entry(const Row& row, const MeshShape& shape) {
    Entry entry;
    entry.view = static_cast<int>(as<std::int64_t>(row, 0));
    entry.direction = static_cast<int>(as<std::int64_t>(row, 1));
    entry.fraction = static_cast<int>(as<std::int64_t>(row, 2));
    entry.cloud.viewpoint = Vec3f(exactly<float>(row, 3, 3).data());
    entry.frame = unpack_frame(exactly<double>(row, 4, kFrameNumbers), as<std::int64_t>(row, 5));
    for (const EncodedPoint& point : values<EncodedPoint>(row, 6)) {
        entry.cloud.points.push_back(decode_point(point, shape));
    }
    if (entry.cloud.empty()) throw InvalidInput("an entry has no points");
    return entry;
}

Spread unpack_spread(const Row& row, std::size_t entries, std::size_t length,
                     std::size_t directions) {
    Spread spread;
    spread.means = values<float>(row, 2);
    if (!spread.empty()) spread.means = exactly<float>(row, 2, entries * length);
    const std::size_t patches = spread.empty() ? 0 : entries * directions;
    spread.directions = exactly<std::int8_t>(row, 3, patches * length);
    spread.scales = exactly<float>(row, 4, patches);
    return spread;
}

void add_bytes(Sha256& digest, const void* data, std::size_t size) {
    const auto length = static_cast<std::uint64_t>(size);
    digest.add({reinterpret_cast<const unsigned char*>(&length), sizeof(length)});
    digest.add({static_cast<const unsigned char*>(data), size});
}

void add_row(Sha256& digest, const Row& row) {
    for (const Cell& value : row) {
        std::visit(
            [&](const auto& v) {
                using T = std::decay_t<decltype(v)>;
                if constexpr (std::is_arithmetic_v<T>) {
                    add_bytes(digest, &v, sizeof(v));
                } else {
                    add_bytes(digest, v.data(), v.size());
                }
            },
            value);
    }
}

}  // namespace

const std::string& name_of(const StoredRecord& record) {
    return as<std::string>(record.model, 0);
}

StoredRecord to_stored(const ModelRecord& record, const LibrarySettings& settings) {
    StoredRecord stored;
    stored.model = model_row(record.model);
    for (const Entry& entry : record.entries) {
        stored.entries.push_back(entry_row(entry, record.model.shape));
    }
    for (std::size_t t = 0; t < settings.descriptors.size(); ++t) {
        const Spread& spread = record.spreads[t];
        stored.descriptors.push_back({std::string(descriptor_name(settings.descriptors[t])),
                                      to_bytes(record.rows[t]), to_bytes(spread.means),
                                      to_bytes(spread.directions), to_bytes(spread.scales)});
    }
    std::sort(stored.descriptors.begin(), stored.descriptors.end());
    return stored;
}

ModelRecord from_stored(const StoredRecord& stored, const LibrarySettings& settings) {
    ModelRecord record;
    record.model = unpack_model(stored.model);
    for (const Row& row : stored.entries) {
        record.entries.push_back(unpack_entry(row, record.model.shape));
    }
    if (stored.descriptors.size() != settings.descriptors.size()) {
        throw InvalidInput(fmt::format("{} descriptors instead of {}", stored.descriptors.size(),
                                       settings.descriptors.size()));
    }
    for (const AnyDescriptor& descriptor : settings.descriptors) {
        const auto found = std::find_if(
            stored.descriptors.begin(), stored.descriptors.end(),
            [&](const Row& row) { return as<std::string>(row, 0) == descriptor_name(descriptor); });
        if (found == stored.descriptors.end()) {
            throw InvalidInput(fmt::format("no rows of {}", descriptor_name(descriptor)));
        }
        const std::size_t length = descriptor_length(descriptor);
        record.rows.push_back(exactly<float>(*found, 1, record.entries.size() * length));
        record.spreads.push_back(
            unpack_spread(*found, record.entries.size(), length,
                          static_cast<std::size_t>(settings.selection.spread)));
    }
    return record;
}

std::string digest_of(const StoredRecord& record) {
    Sha256 digest;
    add_row(digest, record.model);
    for (const Row& row : record.entries) add_row(digest, row);
    for (const Row& row : record.descriptors) add_row(digest, row);
    return digest.finish();
}

std::string digest_of(const std::vector<Row>& rows) {
    Sha256 digest;
    for (const Row& row : rows) add_row(digest, row);
    return digest.finish();
}

}  // namespace ostraka
