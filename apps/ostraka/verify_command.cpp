// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/library/library_file.hpp"

namespace ostraka::app {
namespace {

struct VerifyOptions {
    CommonOptions common;
    std::string library;
};

void run_verify(const VerifyOptions& options) {
    const LibraryCheck check = verify_library(options.library, progress_bar());
    for (const std::string& problem : check.problems) say(problem);
    write_json({{"library", options.library},
                {"format", check.format},
                {"models", check.models},
                {"entries", check.entries},
                {"sha256", check.sha256},
                {"problems", check.problems}},
               options.common.json);
    if (!check.problems.empty()) {
        throw FormatError(options.library, "library",
                          fmt::format("{} problems found", check.problems.size()));
    }
    const std::string digest =
        check.format == 1 ? "format 1, which has no checksums" : "content " + check.sha256;
    say(fmt::format("{}: {} models, {} entries, all well; {}", options.library, check.models,
                    check.entries, digest));
}

}  // namespace

void add_verify(CLI::App& app) {
    auto options = std::make_shared<VerifyOptions>();
    CLI::App* command = app.add_subcommand(
        "verify", "check a library's structure and checksums; exit code 5 if anything is damaged");
    command->add_option("library", options->library, "library made by `ostraka build`")->required();
    add_common(*command, options->common);
    command->callback([options] { run_verify(*options); });
}

}  // namespace ostraka::app
