// SPDX-License-Identifier: Apache-2.0
// How long work tells its caller how far it is, and how the caller stops it.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "ostraka/base/error.hpp"

namespace ostraka {

/// Called from one thread at a time with the stage's name and its work done so far.
/// Return false to stop: the work then throws Interrupted and leaves nothing half-done.
using Progress = std::function<bool(std::string_view stage, std::size_t done, std::size_t total)>;

/// Reports progress. @throws Interrupted if the callback asks to stop.
inline void report(const Progress& progress, std::string_view stage, std::size_t done,
                   std::size_t total) {
    if (progress && !progress(stage, done, total)) throw Interrupted();
}

}  // namespace ostraka
