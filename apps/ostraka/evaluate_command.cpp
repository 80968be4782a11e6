// SPDX-License-Identifier: Apache-2.0
#include "commands.hpp"

namespace ostraka::app {

void add_evaluate(CLI::App& app) {
    CLI::App* command = app.add_subcommand("evaluate", "measure how well a library recognizes");
    command->require_subcommand(1);
    add_evaluate_segments(*command);
    add_evaluate_scenes(*command);
    add_evaluate_library(*command);
}

}  // namespace ostraka::app
