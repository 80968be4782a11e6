// SPDX-License-Identifier: Apache-2.0
// What lies on a table, as seen by an object that comes down on it: one height for each cell.
// What is under an overhang counts as filled.
#pragma once

#include <vector>

#include "ostraka/simulation/height_map.hpp"

namespace ostraka {

/// A place for a height map: it is moved by so many cells, and its lowest point to the height.
struct Landing {
    int columns = 0;      ///< along x
    int rows = 0;         ///< along y
    double height = 0.0;  ///< of the lowest point above the table; at least 0
};

/// The upper envelope of all that was added, over a rectangle of the table, whose top is at 0.
class LandingSurface {
  public:
    /// Covers the cells [first_column, last_column] x [first_row, last_row]: all that is ever
    /// landed must stay within.
    /// @throws InvalidInput if these are more than 2^26 cells.
    LandingSurface(int first_column, int first_row, int last_column, int last_row);

    /// The lowest height of the map's lowest point above the table at which no column of the map
    /// overlaps one below it; `limit` if that is not below `limit`.
    double landing_height(const HeightMap& map, int columns, int rows, double limit) const;

    /// Leaves a map where it landed.
    void add(const HeightMap& map, const Landing& landing);

  private:
    // Columns of a row on which something lies: [begin, end).
    struct Span {
        int begin;
        int end;
    };

    int first_column_;
    int first_row_;
    int rows_;
    int stride_;
    std::vector<float> heights_;  // rows x stride; -infinity: the bare table
    std::vector<Span> occupied_;  // of each row
};

}  // namespace ostraka
