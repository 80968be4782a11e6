// SPDX-License-Identifier: Apache-2.0
// Machine parts with parameters: models to recognize where no CAD files are at hand. As solids they
// are exact, so that a test knows the true surface.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "ostraka/mesh/triangle_mesh.hpp"
#include "ostraka/simulation/solid.hpp"

namespace ostraka {

/// What each looks like, and its symmetry, stands at its builder in parts_*.cpp.
enum class PartKind {
    flange,
    l_bracket,
    elbow,
    tee,
    gear,
    bolt,
    bearing_block,
    hook,
    valve_body,
    clevis,
    crank,
    pulley,
    cam,
    manifold_block,
    wing_nut,
    knob,
    pump_housing,
    fork,
    stepped_shaft,
    impeller,
    connecting_rod,
    heat_sink,
};

struct PartSettings {
    std::uint64_t seed = 0;   ///< 0 is the nominal part; others vary proportions and counts
    double size = 1.0;        ///< factor on all lengths; 1 gives parts of 40 to 130 mm
    int resolution = 96;      ///< cells of the contouring along the longest side, 64 to 512
    double tolerance = 0.04;  ///< mm at size 1: how far simplification may move the surface
};

/// The enumerator's name: "flange", "l_bracket", ...
std::string_view part_name(PartKind kind);
/// The inverse of part_name(); nothing for any other text.
std::optional<PartKind> parse_part(std::string_view name);
/// Every kind once, in the order of the enumeration.
std::vector<PartKind> all_parts();

/// The part as an exact solid, in mm, about its working axis; not scaled by any size.
/// Known only for its distance: see solid.hpp.
Solid part_solid(PartKind kind, std::uint64_t seed = 0);

/// The part as a mesh in mm: closed, manifold, outward oriented, in one piece; the frame is that of
/// part_solid(). The same bits for the same settings.
/// @throws InvalidInput if a setting is out of range.
TriangleMesh make_part(PartKind kind, const PartSettings& settings = {});

}  // namespace ostraka
