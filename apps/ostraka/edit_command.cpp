// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "ostraka/base/error.hpp"
#include "ostraka/base/stopwatch.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/library/edit.hpp"
#include "ostraka/library/library_file.hpp"
#include "rebuilt_note.hpp"

namespace ostraka::app {
namespace {

struct EditOptions {
    CommonOptions common;
    std::string library;
    std::vector<std::string> inputs;  // model files, model names or libraries
    std::string output;               // empty: the library itself
};

// Edits the library itself or, with --output, a copy that appears when it is done.
template <class Edit>
void edit(const EditOptions& options, Edit change) {
    if (options.output.empty()) {
        change(options.library);
        return;
    }
    AtomicFile copy(options.output);
    std::filesystem::copy_file(options.library, copy.temporary(),
                               std::filesystem::copy_options::overwrite_existing);
    change(copy.temporary());
    copy.commit();
}

void tell(const EditOptions& options, const Stopwatch& watch, std::size_t present = 0) {
    const std::string& path = options.output.empty() ? options.library : options.output;
    const std::vector<std::string> models = model_names(path);
    if (present > 0) say(fmt::format("in the library already: {}", present));
    say(fmt::format("{}: {} models, {:.1f} s", path, models.size(), watch.seconds()));
    write_json({{"library", path}, {"models", models}, {"seconds", watch.seconds()}},
               options.common.json);
}

void run_add(const EditOptions& options) {
    catch_interrupts();
    const Stopwatch watch;
    std::vector<ModelInput> models;
    for (const std::string& path : options.inputs) {
        if (!std::filesystem::exists(path)) throw FileError(path, "no such file");
        models.push_back(tell_rebuilt(model_input(path)));
    }
    AddOutcome outcome;
    edit(options, [&](const std::filesystem::path& library) {
        outcome = add_models(library, models, progress_bar());
    });
    tell(options, watch, outcome.present);
}

void run_remove(const EditOptions& options) {
    const Stopwatch watch;
    edit(options,
         [&](const std::filesystem::path& library) { remove_models(library, options.inputs); });
    tell(options, watch);
}

void run_rename(const EditOptions& options) {
    const Stopwatch watch;
    edit(options, [&](const std::filesystem::path& library) {
        rename_model(library, options.inputs[0], options.inputs[1]);
    });
    tell(options, watch);
}

void run_index(const EditOptions& options) {
    const Stopwatch watch;
    edit(options, [&](const std::filesystem::path& library) {
        const std::size_t rows = index_keypoints(library);
        say(fmt::format("graph of {} keypoint rows", rows));
    });
    tell(options, watch);
}

void run_merge(const EditOptions& options) {
    catch_interrupts();
    const Stopwatch watch;
    const std::vector<std::filesystem::path> libraries(options.inputs.begin(),
                                                       options.inputs.end());
    merge_libraries(libraries, options.output, progress_bar());
    tell(options, watch);
}

void add_output(CLI::App& command, EditOptions& options) {
    command.add_option("-o,--output", options.output, "file to write (default: LIBRARY itself)");
}

}  // namespace

void add_edit(CLI::App& app) {
    auto add = std::make_shared<EditOptions>();
    CLI::App* command = app.add_subcommand(
        "add", "add models to a library, built with its own settings; the others stay as they are");
    command->add_option("library", add->library, "library made by `ostraka build`")->required();
    command
        ->add_option("models", add->inputs,
                     "mesh files, or clouds seen from all around, in the library's unit")
        ->required();
    add_output(*command, *add);
    add_common(*command, add->common);
    command->callback([add] { run_add(*add); });

    auto remove = std::make_shared<EditOptions>();
    command = app.add_subcommand("remove", "remove models from a library");
    command->add_option("library", remove->library, "library made by `ostraka build`")->required();
    command->add_option("names", remove->inputs, "names of models (see `ostraka inspect`)")
        ->required();
    add_output(*command, *remove);
    add_common(*command, remove->common);
    command->callback([remove] { run_remove(*remove); });

    auto rename = std::make_shared<EditOptions>();
    command = app.add_subcommand("rename", "give a model of a library another name");
    command->add_option("library", rename->library, "library made by `ostraka build`")->required();
    command->add_option("names", rename->inputs, "the old and the new name")
        ->required()
        ->expected(2);
    add_output(*command, *rename);
    add_common(*command, rename->common);
    command->callback([rename] { run_rename(*rename); });

    auto index = std::make_shared<EditOptions>();
    command = app.add_subcommand(
        "index",
        "add a graph for fast, approximate matching of keypoints: for libraries of dozens "
        "to thousands of models; to be repeated after models have changed");
    command->add_option("library", index->library, "library made by `ostraka build`")->required();
    add_output(*command, *index);
    add_common(*command, index->common);
    command->callback([index] { run_index(*index); });

    auto merge = std::make_shared<EditOptions>();
    command = app.add_subcommand(
        "merge", "one library of all models of several; their settings must be the same");
    command->add_option("libraries", merge->inputs, "libraries made by `ostraka build`")
        ->required();
    command->add_option("-o,--output", merge->output, "library file to write")->required();
    add_common(*command, merge->common);
    command->callback([merge] { run_merge(*merge); });
}

}  // namespace ostraka::app
