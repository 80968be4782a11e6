// SPDX-License-Identifier: Apache-2.0
// What a library holds, to look at: every model with the views and subparts kept of it.
#pragma once

#include "ostraka/io/png_file.hpp"
#include "ostraka/library/model_library.hpp"

namespace ostraka {

struct ContactSheetSettings {
    int tile = 150;            ///< side of an entry's picture, pixels, 48 to 512
    int columns = 8;           ///< entries side by side
    std::size_t models = 40;   ///< models shown; more are counted only
    std::size_t entries = 16;  ///< entries shown of each model, spread over all; at least 0
};

/// One block a model: its shaded mesh, then its entries, each seen from its own virtual sensor:
/// what the entry holds in color, the rest of the model faintly behind it. Captions tell the
/// counts, and each entry's view, cut direction and the percentage that the cut left.
/// @param library  may be empty.
/// @throws InvalidInput if a setting is out of range.
Image draw_contact_sheet(const ModelLibrary& library, const ContactSheetSettings& settings = {});

}  // namespace ostraka
