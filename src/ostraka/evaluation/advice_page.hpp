// SPDX-License-Identifier: Apache-2.0
// Advice as one page to look at: verdicts, pictures, plots, the settings to use.
#pragma once

#include "ostraka/evaluation/advice.hpp"
#include "ostraka/report/page.hpp"

namespace ostraka {

/// @param settings  that the advice was asked with.
/// @param command   the command line that builds the recommended library.
PageContent advice_page(const Advice& advice, const AdviceSettings& settings,
                        const std::string& command);

}  // namespace ostraka
