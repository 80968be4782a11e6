// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/build_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "ostraka/base/error.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/io/file_lock.hpp"
#include "ostraka/library/bags.hpp"
#include "ostraka/library/build.hpp"
#include "ostraka/library/library_copy.hpp"
#include "ostraka/library/settings_text.hpp"

namespace ostraka {
namespace {

namespace fs = std::filesystem;

// A kill can't hurt what the system has been handed; a power failure can, and then the checksums
// show it.
void write_without_waiting(LibraryStore& store) {
    store.database().run("PRAGMA journal_mode=DELETE; PRAGMA synchronous=OFF;");
}

void remove_build(const fs::path& path) {
    fs::remove(path.string() + "-journal");  // first: another build may begin when the file is gone
    fs::remove(path);
}

// The file stays, as it is what is locked.
LibraryStore start_anew(const fs::path& path, const LibrarySettings& settings) {
    fs::remove(path.string() + "-journal");
    fs::resize_file(path, 0);
    return LibraryStore::create(path, settings, path);
}

bool is_of(LibraryStore& store, const LibrarySettings& settings) {
    return to_text(store.settings()) == to_text(settings);
}

// An unfinished build with these settings, or a new one.
LibraryStore open_unfinished(const fs::path& path, const LibrarySettings& settings) {
    try {
        LibraryStore store = LibraryStore::open(path, Database::Mode::edit);
        if (is_of(store, settings)) return store;
    } catch (const FormatError&) {
        // Empty, killed in its first moments, or of another version: nothing to go on from.
    }
    return start_anew(path, settings);
}

// Models in the file that are none of these, or damaged, are removed. Returns what remains to do.
std::vector<ModelInput> remaining(LibraryStore& store, std::span<const ModelInput> models) {
    std::vector<ModelInput> missing(models.begin(), models.end());
    Transaction transaction(store.database());
    for (const StoredModel& stored : store.models()) {
        const auto wanted = std::find_if(missing.begin(), missing.end(), [&](const auto& input) {
            return input.name == stored.name;
        });
        bool usable = wanted != missing.end() && !stored.source_sha256.empty() &&
                      wanted->sha256() == stored.source_sha256 && wanted->file == stored.file;
        if (usable) {
            try {
                store.load(stored);
            } catch (const Error&) {
                usable = false;
            }
        }
        if (usable) {
            missing.erase(wanted);
        } else {
            store.remove(stored.name);
        }
    }
    transaction.commit();
    return missing;
}

// An unfinished build that is being worked on.
struct Work {
    std::optional<LibraryStore> store;
    std::size_t done = 0;  // models in it
};

BuildOutcome finish(LibraryStore& store, const fs::path& path, bool bags) {
    BuildOutcome outcome;
    outcome.settings = store.settings();
    const std::vector<StoredModel> models = store.models();
    for (const StoredModel& model : models) {
        const Model loaded = store.load(model).model;
        outcome.models.push_back({loaded.name, loaded.shape.diameter, loaded.counts});
    }
    ModelLibrary with_bags;
    if (bags) {
        with_bags = load_store(store);
        make_bags(with_bags);
    }
    write_library(
        path, store.settings(), models.size(), [&](std::size_t i) { return store.read(models[i]); },
        bags ? &with_bags : nullptr);
    return outcome;
}

}  // namespace

fs::path unfinished_build(const fs::path& path) {
    return path.parent_path() / fmt::format(".{}.unfinished", path.filename().string());
}

BuildOutcome build_library_file(std::span<const ModelInput> models, LibrarySettings settings,
                                const fs::path& path, bool bags, const Progress& progress) {
    if (models.empty()) throw InvalidInput("a library needs at least one model");
    require_distinct_names(models);
    { const AtomicFile writable(path); }  // better to fail now than after the build
    if (settings.sampling == 0.0) settings.sampling = default_sampling(models);
    settings = complete_settings(settings);
    const fs::path unfinished = unfinished_build(path);
    const FileLock lock(unfinished);
    Work work;
    try {
        work.store = open_unfinished(unfinished, settings);
        write_without_waiting(*work.store);
        const std::vector<ModelInput> missing = remaining(*work.store, models);
        work.done = models.size() - missing.size();
        const std::size_t resumed = work.done;
        const auto keep = [&](const ModelRecord& record) {
            Transaction transaction(work.store->database());
            work.store->put(to_stored(record, settings));
            work.store->seal();
            transaction.commit();
            ++work.done;
        };
        build_records(missing, settings, keep, progress);
        BuildOutcome outcome = finish(*work.store, path, bags);
        outcome.resumed = resumed;
        remove_build(unfinished);  // while it is locked, so that no other build begins with it
        return outcome;
    } catch (...) {
        // Worth keeping only if something is done.
        work.store.reset();
        if (work.done == 0) remove_build(unfinished);
        throw;
    }
}

}  // namespace ostraka
