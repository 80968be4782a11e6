// SPDX-License-Identifier: Apache-2.0
// One function a subcommand: adds it, its options and what it runs.
#pragma once

#include <CLI/CLI.hpp>

namespace ostraka::app {

void add_advise(CLI::App& app);
void add_build(CLI::App& app);
void add_calibrate(CLI::App& app);
void add_recognize(CLI::App& app);
void add_classify(CLI::App& app);
void add_describe(CLI::App& app);
void add_edit(CLI::App& app);
void add_export(CLI::App& app);
void add_inspect(CLI::App& app);
void add_verify(CLI::App& app);
void add_symmetry(CLI::App& app);
void add_views(CLI::App& app);
void add_parts(CLI::App& app);
void add_simulate(CLI::App& app);
void add_evaluate(CLI::App& app);
void add_evaluate_segments(CLI::App& parent);
void add_evaluate_scenes(CLI::App& parent);   ///< scenes and pose
void add_evaluate_library(CLI::App& parent);  ///< of `ostraka evaluate`

}  // namespace ostraka::app
