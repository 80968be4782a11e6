// SPDX-License-Identifier: Apache-2.0
// Private to this module: the three angles between two surfels of Rusu et al. (2008), eight pairs
// at a time, straight as bins.
//
// With p the surfel whose normal is closer to the line, d = q - p, u = n_p, v = d x u / |d x u| and
// w = u x v: angle = atan2(w . n_q, u . n_q), across = v . n_q, along = u . d / |d|.
// The number of bins is odd and the middle one is centered on 0, so a bin is a sign and a count of
// the borders exceeded. Borders are compared as squares: no arctangent, square root or division,
// and nothing that could become NaN.
// As PCL 1.13, points that coincide, and points along the normal, count in the middle bins.
#pragma once

#include "ostraka/base/vector_clones.hpp"

namespace ostraka {

/// The squares of the borders on one side of the middle bin, in rising order.
template <int kBins>
struct PairBorders;

template <>
struct PairBorders<11> {
    static constexpr int kSide = 5;
    static constexpr int kAcute = 3;  // borders of the angle below a quarter turn
    // tan((2k - 1) pi / 11)^2 and ((2k - 1) / 11)^2.
    static constexpr float kTangent[kSide] = {0.0862165174F, 1.33185799F, 48.3741501F, 4.79476228F,
                                              0.413013132F};
    static constexpr float kCosine[kSide] = {0.00826446281F, 0.0743801653F, 0.20661157F,
                                             0.404958678F, 0.669421488F};
};

template <>
struct PairBorders<5> {
    static constexpr int kSide = 2;
    static constexpr int kAcute = 1;
    // tan((2k - 1) pi / 5)^2 and ((2k - 1) / 5)^2.
    static constexpr float kTangent[kSide] = {0.527864045F, 9.47213595F};
    static constexpr float kCosine[kSide] = {0.04F, 0.36F};
};

/// Eight surfels.
struct Surfels8 {
    Float8 x, y, z, nx, ny, nz;
};

/// The middle bin minus the bins of eight pairs, and the squared distance of each pair.
struct PairBins8 {
    Int8 angle, across, along;
    Float8 squared_distance;
};

// `borders` holds minus the number of borders exceeded, as masks add up to.
__attribute__((always_inline)) inline void with_sign_of(const Float8& value, const Int8& borders,
                                                        Int8& bins) {
    const Int8 negative = reinterpret_cast<Int8>(value) >> 31;
    bins = (borders ^ negative) - negative;
}

/// The bins of the pairs of one surfel (in all lanes of p) with eight others.
template <int kBins>
__attribute__((always_inline)) inline void pair_bins(const Surfels8& p, const Surfels8& q,
                                                     PairBins8& bins) {
    using Borders = PairBorders<kBins>;
    const Float8 dx = q.x - p.x;
    const Float8 dy = q.y - p.y;
    const Float8 dz = q.z - p.z;
    const Float8 dd = dx * dx + dy * dy + dz * dz;
    const Float8 a = p.nx * dx + p.ny * dy + p.nz * dz;
    const Float8 b = q.nx * dx + q.ny * dy + q.nz * dz;
    const Float8 cosine = p.nx * q.nx + p.ny * q.ny + p.nz * q.nz;
    const Float8 triple = dx * (p.ny * q.nz - p.nz * q.ny) + dy * (p.nz * q.nx - p.nx * q.nz) +
                          dz * (p.nx * q.ny - p.ny * q.nx);
    // Exchanging the surfels turns d around; the triple product stays.
    const Float8 aa = a * a;
    const Float8 bb = b * b;
    const Int8 exchange = aa < bb;
    const Float8 first = exchange ? -b : a;
    const Float8 second = exchange ? -a : b;
    const Float8 along2 = aa > bb ? aa : bb;
    // |d x u|^2. Within 1e-3 of the normal's direction it is rounding noise, and v has no meaning.
    const Float8 cross2 = dd - along2;
    const Int8 defined = cross2 > dd * 1e-6F;

    const Float8 sine = second - first * cosine;  // times |d x u|
    const Float8 sine2 = sine * sine;
    // Negative beyond a quarter turn: then all acute borders are exceeded, and before it no obtuse
    // one is.
    const Float8 size = reinterpret_cast<Float8>(reinterpret_cast<Int8>(cosine) & 0x7fffffff);
    const Float8 reference2 = cosine * size * cross2;
    const Float8 triple2 = triple * triple;
    Int8 angle = {};
    Int8 across = {};
    Int8 along = {};
    for (int k = 0; k < Borders::kSide; ++k) {
        angle += k < Borders::kAcute ? sine2 > reference2 * Borders::kTangent[k]
                                     : sine2 < reference2 * -Borders::kTangent[k];
        across += triple2 > cross2 * Borders::kCosine[k];
        along += along2 > dd * Borders::kCosine[k];
    }
    with_sign_of(sine, angle & defined, bins.angle);
    with_sign_of(triple, across & defined, bins.across);
    with_sign_of(first, along & defined, bins.along);
    bins.squared_distance = dd;
}

}  // namespace ostraka
