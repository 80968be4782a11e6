// SPDX-License-Identifier: Apache-2.0
#include "ostraka/simulation/parts.hpp"

#include <array>
#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/mesh/simplify.hpp"
#include "ostraka/simulation/contour.hpp"
#include "ostraka/simulation/part_builders.hpp"

namespace ostraka {
namespace {

struct Entry {
    PartKind kind;
    std::string_view name;
    Solid (*build)(Variation&);
};

constexpr std::array kEntries = {
    Entry{PartKind::flange, "flange", build_flange},
    Entry{PartKind::l_bracket, "l_bracket", build_l_bracket},
    Entry{PartKind::elbow, "elbow", build_elbow},
    Entry{PartKind::tee, "tee", build_tee},
    Entry{PartKind::gear, "gear", build_gear},
    Entry{PartKind::bolt, "bolt", build_bolt},
    Entry{PartKind::bearing_block, "bearing_block", build_bearing_block},
    Entry{PartKind::hook, "hook", build_hook},
    Entry{PartKind::valve_body, "valve_body", build_valve_body},
    Entry{PartKind::clevis, "clevis", build_clevis},
    Entry{PartKind::crank, "crank", build_crank},
    Entry{PartKind::pulley, "pulley", build_pulley},
    Entry{PartKind::cam, "cam", build_cam},
    Entry{PartKind::manifold_block, "manifold_block", build_manifold_block},
    Entry{PartKind::wing_nut, "wing_nut", build_wing_nut},
    Entry{PartKind::knob, "knob", build_knob},
    Entry{PartKind::pump_housing, "pump_housing", build_pump_housing},
    Entry{PartKind::fork, "fork", build_fork},
    Entry{PartKind::stepped_shaft, "stepped_shaft", build_stepped_shaft},
    Entry{PartKind::impeller, "impeller", build_impeller},
    Entry{PartKind::connecting_rod, "connecting_rod", build_connecting_rod},
    Entry{PartKind::heat_sink, "heat_sink", build_heat_sink},
};

const Entry& entry_of(PartKind kind) {
    for (const Entry& entry : kEntries) {
        if (entry.kind == kind) return entry;
    }
    throw InvalidInput("there is no such kind of part");
}

}  // namespace

std::string_view part_name(PartKind kind) {
    return entry_of(kind).name;
}

std::optional<PartKind> parse_part(std::string_view name) {
    for (const Entry& entry : kEntries) {
        if (entry.name == name) return entry.kind;
    }
    return std::nullopt;
}

std::vector<PartKind> all_parts() {
    std::vector<PartKind> kinds;
    for (const Entry& entry : kEntries) kinds.push_back(entry.kind);
    return kinds;
}

Solid part_solid(PartKind kind, std::uint64_t seed) {
    Variation vary(seed);
    return entry_of(kind).build(vary);
}

TriangleMesh make_part(PartKind kind, const PartSettings& settings) {
    if (!(settings.size > 0.0) || !std::isfinite(settings.size)) {
        throw InvalidInput("make_part: the size must be positive");
    }
    if (settings.resolution < 64 || settings.resolution > 512) {
        throw InvalidInput("make_part: the resolution must be from 64 to 512");
    }
    const Solid solid = part_solid(kind, settings.seed);
    const TriangleMesh fine = contour(solid, {.resolution = settings.resolution});
    return scaled(simplify(fine, {.max_error = settings.tolerance}), settings.size);
}

}  // namespace ostraka
