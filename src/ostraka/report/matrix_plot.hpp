// SPDX-License-Identifier: Apache-2.0
// A confusion matrix: what each true model was taken for.
#pragma once

#include <string>
#include <vector>

namespace ostraka {

struct MatrixPlot {
    std::string title;
    std::string row_label;             ///< what rows are: "true model"
    std::string column_label;          ///< what columns are: "answer"
    std::vector<std::string> rows;     ///< names; about 60 fit a page
    std::vector<std::string> columns;  ///< names
    std::vector<double> values;        ///< row-major, rows x columns; not finite: an empty cell
    bool counts = true;                ///< values are counts, shaded by their share of the row's
                                       ///< sum; else shares of 0 to 1, shown in percent
};

/// The matrix as one <svg> element, as wide as its cells ask for and at most a page's width. Cells
/// whose row and column have the same name are shaded blue, others orange; zeros are left blank
/// where cells are small.
/// @throws InvalidInput if there isn't one value a cell.
std::string draw_svg(const MatrixPlot& plot);

}  // namespace ostraka
