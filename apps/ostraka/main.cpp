// SPDX-License-Identifier: Apache-2.0
// The `ostraka` command. Errors become one line on standard error and a documented exit code.
#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "commands.hpp"
#include "common.hpp"
#include "ostraka/base/error.hpp"

namespace {

using namespace ostraka;

int fail(const std::string& problem, int code) {
    fmt::print(stderr, "ostraka: {}\n", problem);
    return code;
}

// A first word that is neither an option nor a command: CLI11 would only say that one is missing.
bool names_no_command(const CLI::App& app, int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') return false;
    const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
    return std::none_of(commands.begin(), commands.end(),
                        [&](const CLI::App* command) { return command->get_name() == argv[1]; });
}

int run(int argc, char** argv) {
    CLI::App app{
        "Ostraka finds CAD models in depth scans, even when most of each object is hidden.\n"
        "Build a library once, then recognize scans with it:\n"
        "  ostraka build parts/*.ply --unit mm -o parts.ostraka\n"
        "  ostraka recognize parts.ostraka scan.ply --picture found.png"};
    app.set_version_flag("--version", OSTRAKA_VERSION);
    app.require_subcommand(1);
    app.footer(
        "Exit codes: 0 done, 1 internal error, 2 wrong command line, 3 unusable data, "
        "4 file can't be read or written, 5 damaged or foreign file, 130 interrupted.");
    app::add_build(app);
    app::add_recognize(app);
    app::add_classify(app);
    app::add_describe(app);
    app::add_edit(app);
    app::add_calibrate(app);
    app::add_inspect(app);
    app::add_verify(app);
    app::add_export(app);
    app::add_symmetry(app);
    app::add_views(app);
    app::add_parts(app);
    app::add_simulate(app);
    app::add_evaluate(app);
    app::add_advise(app);
    if (names_no_command(app, argc, argv)) {
        return fail(fmt::format("there is no command {}; see ostraka --help", argv[1]),
                    app::kUsage);
    }
    try {
        app.parse(argc, argv);
        return app::kOk;
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
        return fail(error.what(), app::kUsage);
    } catch (const InvalidInput& error) {
        return fail(error.what(), app::kInvalidInput);
    } catch (const FileError& error) {
        return fail(error.what(), app::kFileError);
    } catch (const FormatError& error) {
        return fail(error.what(), app::kFormatError);
    } catch (const Interrupted& error) {
        return fail(error.what(), app::kInterrupted);
    } catch (const std::bad_alloc&) {
        return fail("out of memory", app::kInternal);
    } catch (const std::exception& error) {
        return fail(std::string("internal error: ") + error.what(), app::kInternal);
    }
}

}  // namespace

int main(int argc, char** argv) {
    return run(argc, argv);
}
