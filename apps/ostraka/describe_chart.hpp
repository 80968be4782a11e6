// SPDX-License-Identifier: Apache-2.0
// A descriptor's rows as a picture: bars in labeled blocks beside the piece they describe.
#pragma once

#include <string>
#include <vector>

#include "ostraka/cloud/point_cloud.hpp"
#include "ostraka/descriptors/descriptor.hpp"
#include "ostraka/io/png_file.hpp"

namespace ostraka::app {

/// Consecutive numbers of a row that belong together.
struct ChartBlock {
    std::string label;
    std::size_t length = 0;
};

/// The blocks of a descriptor's row, in order; their lengths sum to descriptor_length().
std::vector<ChartBlock> chart_blocks(const AnyDescriptor& descriptor);

struct ChartRow {
    std::vector<float> values;
    std::string caption;                ///< what the row belongs to; may be empty
    std::vector<std::uint32_t> points;  ///< of the piece, colored like the row; empty: all of it
    bool marked = false;                ///< the points are single positions: drawn as large dots
};

/// @param piece  finite points with normals, seen from its viewpoint at the left.
/// @param rows   at least 1; all as long as the blocks together. Heights are square roots, as rows
///               are compared by Hellinger's distance; all rows have one scale.
Image draw_chart(const std::string& title, const PointCloud& piece,
                 const std::vector<ChartBlock>& blocks, const std::vector<ChartRow>& rows);

}  // namespace ostraka::app
