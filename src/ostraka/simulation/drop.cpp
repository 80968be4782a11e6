// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/drop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/random.hpp"
#include "ostraka/simulation/landing_surface.hpp"
#include "ostraka/simulation/resting_poses.hpp"

namespace ostraka {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr int kMaxSlides = 200;  // in cells times the step; a slope ends long before

void check(const DropModels& models, std::span<const std::uint32_t> chosen,
           const DropSettings& settings) {
    if (settings.bin) check(*settings.bin);
    if (!(settings.area >= 0.0 && settings.area <= 1e6)) {
        throw InvalidInput("drop: area must be from 0 to 1e6 mean diameters");
    }
    if (!(settings.settled >= 0.0 && settings.settled <= 1.0)) {
        throw InvalidInput("drop: settled must be from 0 to 1");
    }
    if (settings.positions < 1 || settings.rotations < 1) {
        throw InvalidInput("drop: positions and rotations must be at least 1");
    }
    if (settings.cells < 10 || settings.cells > 2000) {
        throw InvalidInput("drop: cells must be from 10 to 2000");
    }
    if (chosen.empty()) throw InvalidInput("drop: no models chosen");
    for (const std::uint32_t model : chosen) {
        if (model >= models.meshes.size()) {
            throw InvalidInput("drop: there is no model " + std::to_string(model));
        }
    }
}

double mean_diameter(const DropModels& models, std::span<const std::uint32_t> chosen) {
    double sum = 0.0;
    for (const std::uint32_t model : chosen) sum += models.diameters[model];
    return sum / static_cast<double>(chosen.size());
}

// The rectangle of the table in which objects, or their centers of mass, must stay.
struct Ground {
    double cell = 0.0;
    Vec2d half = Vec2d::Zero();
    bool whole = false;  // the whole object must stay inside, not only its center of mass
    double rim = kUnlimited;
};

Ground make_ground(const DropModels& models, std::span<const std::uint32_t> chosen,
                   const DropSettings& settings) {
    const double diameter = mean_diameter(models, chosen);
    Ground ground{.cell = diameter / settings.cells};
    if (settings.bin) {
        ground.half = Vec2d(settings.bin->length, settings.bin->width) / 2.0;
        ground.whole = true;
        ground.rim = settings.bin->height;
    } else {
        ground.half = Vec2d::Constant(settings.area * diameter / 2.0);
    }
    return ground;
}

LandingSurface make_surface(const DropModels& models, std::span<const std::uint32_t> chosen,
                            const Ground& ground) {
    double reach = 0.0;
    for (const std::uint32_t model : chosen) reach = std::max(reach, models.shapes[model].radius);
    // A bin's objects stay inside. The limit keeps the cast defined; the surface's own is lower.
    const Vec2d half = ground.half + Vec2d::Constant(ground.whole ? 0.0 : reach);
    const Vec2d cells = (half / ground.cell).array().ceil().min(1e8) + 4.0;
    const auto columns = static_cast<int>(cells.x());
    const auto rows = static_cast<int>(cells.y());
    return {-columns, -rows, columns, rows};
}

// Whole numbers of cells by which a map may be moved along one axis.
struct Range {
    int low = 0;
    int high = -1;
};

// One object in one rotation.
struct Faller {
    Mat3d R_world_model = Mat3d::Identity();
    HeightMap map;
    double center_height = 0.0;  // of the center of mass above the lowest point
    std::array<Range, 2> ranges;

    bool fits() const { return ranges[0].low <= ranges[0].high && ranges[1].low <= ranges[1].high; }
};

Range range_along(int axis, const Faller& faller, const Vec3d& center, const Ground& ground) {
    const double low = ground.whole ? faller.map.bounds.low[axis] : center[axis];
    const double high = ground.whole ? faller.map.bounds.high[axis] : center[axis];
    const Range range{static_cast<int>(std::ceil((-ground.half[axis] - low) / ground.cell)),
                      static_cast<int>(std::floor((ground.half[axis] - high) / ground.cell))};
    // On a table smaller than a cell the center is as near as it gets.
    if (!ground.whole && range.low > range.high) return {range.low, range.low};
    return range;
}

Faller make_faller(const DropModels& models, std::uint32_t model, const Ground& ground,
                   bool settled, Random& random) {
    Faller faller{.R_world_model = random.rotation()};
    const RollingShape& shape = models.shapes[model];
    if (settled) faller.R_world_model = roll_to_rest(shape, faller.R_world_model).R_world_model;
    faller.map = height_map(models.meshes[model], faller.R_world_model, ground.cell);
    const Vec3d center = faller.R_world_model * shape.center_of_mass;
    faller.center_height = center.z() - faller.map.bounds.low.z();
    for (int axis = 0; axis < 2; ++axis) {
        faller.ranges[static_cast<std::size_t>(axis)] = range_along(axis, faller, center, ground);
    }
    return faller;
}

int pick(const Range& range, Random& random) {
    return range.low + static_cast<int>(random.below(std::uint32_t(range.high - range.low) + 1));
}

// The lowest of some random places that is lower than `limit`; else one of height `limit`.
Landing find_landing(const LandingSurface& surface, const Faller& faller, int positions,
                     double limit, Random& random) {
    Landing best{.height = limit};
    for (int i = 0; i < positions; ++i) {
        const int columns = pick(faller.ranges[0], random);
        const int rows = pick(faller.ranges[1], random);
        const double height = surface.landing_height(faller.map, columns, rows, best.height);
        if (height < best.height) best = {columns, rows, height};
    }
    return best;
}

// Moves downhill, first by long steps, until no place beside is lower.
Landing slide(const LandingSurface& surface, const Faller& faller, Landing landing) {
    int slides = 0;
    for (int step = 8; step >= 1; step /= 2) {
        bool moved = true;
        while (moved && slides < kMaxSlides) {
            moved = false;
            const Landing from = landing;
            for (int way = 0; way < 9; ++way) {
                const int columns = from.columns + step * (way % 3 - 1);
                const int rows = from.rows + step * (way / 3 - 1);
                if (columns < faller.ranges[0].low || columns > faller.ranges[0].high ||
                    rows < faller.ranges[1].low || rows > faller.ranges[1].high) {
                    continue;
                }
                const double height =
                    surface.landing_height(faller.map, columns, rows, landing.height);
                if (height >= landing.height) continue;
                landing = {columns, rows, height};
                moved = true;
            }
            ++slides;
        }
    }
    return landing;
}

Pose landed_pose(const Faller& faller, const Landing& landing, double cell) {
    Pose T_world_model = Pose::Identity();
    T_world_model.linear() = faller.R_world_model;
    T_world_model.translation() = Vec3d(landing.columns * cell, landing.rows * cell,
                                        landing.height - faller.map.bounds.low.z());
    return T_world_model;
}

// Lets one object fall and leaves it on the surface; nothing if it has no place in the bin.
std::optional<Pose> fall(const DropModels& models, std::uint32_t model, const Ground& ground,
                         const DropSettings& settings, Random& random, LandingSurface& surface) {
    const bool settled = random.uniform() < settings.settled;
    std::optional<Faller> best;
    Landing place;
    double lowest = ground.rim;  // of the center of mass
    for (int i = 0; i < settings.rotations; ++i) {
        Faller faller = make_faller(models, model, ground, settled, random);
        if (!faller.fits()) continue;
        const double limit = lowest - faller.center_height;
        const Landing found = find_landing(surface, faller, settings.positions, limit, random);
        if (found.height >= limit) continue;
        lowest = found.height + faller.center_height;
        place = found;
        best = std::move(faller);
    }
    if (!best) return std::nullopt;
    place = slide(surface, *best, place);
    surface.add(best->map, place);
    return landed_pose(*best, place, ground.cell);
}

}  // namespace

DropModels drop_models(const SceneModels& models) {
    DropModels result;
    const std::size_t count = models.meshes.size();
    result.meshes.resize(count);
    result.shapes.resize(count);
    for (const MeshShape& shape : models.shapes) result.diameters.push_back(shape.diameter);
    parallel_for(count, [&](std::size_t i) {
        result.meshes[i] = raster_mesh(models.meshes[i]);
        result.shapes[i] = rolling_shape(models.meshes[i]);
    });
    return result;
}

DropResult drop(const DropModels& models, std::span<const std::uint32_t> chosen,
                std::uint64_t number, const DropSettings& settings) {
    check(models, chosen, settings);
    Random random(settings.seed, number);
    const Ground ground = make_ground(models, chosen, settings);
    LandingSurface surface = make_surface(models, chosen, ground);
    DropResult result{.cell = ground.cell};
    for (std::uint32_t i = 0; i < chosen.size(); ++i) {
        const std::optional<Pose> T_world_model =
            fall(models, chosen[i], ground, settings, random, surface);
        if (T_world_model) {
            result.placed.push_back({chosen[i], *T_world_model});
        } else {
            result.left_out.push_back(i);
        }
    }
    return result;
}

}  // namespace ostraka
