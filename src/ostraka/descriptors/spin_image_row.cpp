// SPDX-License-Identifier: Apache-2.0
#include "ostraka/descriptors/spin_image_row.hpp"

#include <algorithm>
#include <cmath>

#include "ostraka/base/vector_clones.hpp"

namespace ostraka {
namespace {

// Where each point falls: whole bins along distance and height, and how far beyond; column -1 where
// it doesn't count.
OSTRAKA_VECTOR_CLONES
void vote(const SurfelColumns& points, const SpinCylinder& cylinder, SpinScratch& votes) {
    const float ax = cylinder.axis.x();
    const float ay = cylinder.axis.y();
    const float az = cylinder.axis.z();
    const double bins = 1.0 / cylinder.bin;
    const double width = cylinder.width;
    const float cx = cylinder.center.x();
    const float cy = cylinder.center.y();
    const float cz = cylinder.center.z();
    const float least = cylinder.support_cosine;
    const float flip = cylinder.either_side ? -1.0F : 1.0F;
    std::int32_t* column = votes.column.data();
    std::int32_t* line = votes.line.data();
    double* past_column = votes.past_column.data();
    double* past_line = votes.past_line.data();
    for (std::size_t i = 0; i < points.count; ++i) {
        const float dx = points.x[i] - cx;
        const float dy = points.y[i] - cy;
        const float dz = points.z[i] - cz;
        const float cosine = points.nx[i] * ax + points.ny[i] * ay + points.nz[i] * az;
        const double square =
            double{dx} * double{dx} + double{dy} * double{dy} + double{dz} * double{dz};
        const double height =
            double{dx} * double{ax} + double{dy} * double{ay} + double{dz} * double{az};
        const double rest = square - height * height;
        const double across = std::sqrt(rest > 0.0 ? rest : 0.0) * bins;
        const double up = height * bins + width;
        const bool counts = (square > 0.0) & (across < width) & (up > 0.0) & (up < 2.0 * width) &
                            ((cosine >= least) | (flip * cosine >= least));
        const auto whole_across = static_cast<std::int32_t>(counts ? across : 0.0);
        const auto whole_up = static_cast<std::int32_t>(counts ? up : 0.0);
        column[i] = counts ? whole_across : -1;
        line[i] = whole_up;
        past_column[i] = across - static_cast<double>(whole_across);
        past_line[i] = up - static_cast<double>(whole_up);
    }
}

void add_votes(const SpinScratch& votes, std::size_t count, std::size_t lines,
               std::vector<double>& image) {
    for (std::size_t i = 0; i < count; ++i) {
        if (votes.column[i] < 0) continue;
        const double a = votes.past_column[i];
        const double b = votes.past_line[i];
        double* corner = image.data() + static_cast<std::size_t>(votes.column[i]) * lines +
                         static_cast<std::size_t>(votes.line[i]);
        corner[0] += (1.0 - a) * (1.0 - b);
        corner[1] += (1.0 - a) * b;
        corner[lines] += a * (1.0 - b);
        corner[lines + 1] += a * b;
    }
}

}  // namespace

void draw_spin_image(const SurfelColumns& around, const SpinCylinder& cylinder,
                     SpinScratch& scratch, std::span<float> row) {
    if (scratch.column.size() < around.count) {
        scratch.column.resize(around.count);
        scratch.line.resize(around.count);
        scratch.past_column.resize(around.count);
        scratch.past_line.resize(around.count);
    }
    vote(around, cylinder, scratch);
    scratch.image.assign(row.size(), 0.0);
    add_votes(scratch, around.count, 2 * static_cast<std::size_t>(cylinder.width) + 1,
              scratch.image);
    double sum = 0.0;
    for (const double value : scratch.image) sum += value;
    const double scale = sum > 0.0 ? 1.0 / sum : 0.0;
    std::transform(scratch.image.begin(), scratch.image.end(), row.begin(),
                   [scale](double value) { return static_cast<float>(value * scale); });
}

}  // namespace ostraka
