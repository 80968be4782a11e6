// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "ostraka/base/error.hpp"
#include "ostraka/library/bags.hpp"
#include "ostraka/library/build.hpp"
#include "ostraka/library/library_copy.hpp"
#include "ostraka/library/library_file.hpp"
#include "ostraka/library/settings_text.hpp"

namespace ostraka {
namespace {

namespace fs = std::filesystem;

// Unit and sampling are named first: others are derived from them.
void require_equal_settings(const LibrarySettings& a, const LibrarySettings& b,
                            const fs::path& named) {
    const SettingTexts first = to_text(a);
    SettingTexts second = to_text(b);
    const auto require_equal = [&](const std::string& key) {
        if (first.at(key) == second[key]) return;
        throw InvalidInput(fmt::format("{}: the setting {} is {}, in the first library {}",
                                       named.string(), key, second[key], first.at(key)));
    };
    require_equal("unit");
    require_equal("sampling");
    for (const auto& [key, value] : first) require_equal(key);
}

// A library of an earlier format is rewritten first.
LibraryStore open_for_editing(const fs::path& path) {
    if (library_format(path) != kLibraryFormat) save_library(load_library(path), path);
    return LibraryStore::open(path, Database::Mode::edit);
}

void seal(LibraryStore& store, bool with_bags) {
    if (with_bags) make_bags_anew(store);
    store.seal();
}

// Those that are not in the library yet.
std::vector<ModelInput> missing_models(LibraryStore& store, std::span<const ModelInput> models) {
    std::vector<ModelInput> missing;
    for (const ModelInput& input : models) {
        if (!store.contains(input.name)) {
            missing.push_back(input);
            continue;
        }
        const StoredModel stored = store.find(input.name);
        const bool same = !stored.source_sha256.empty() && stored.source_sha256 == input.sha256() &&
                          stored.file == input.file;
        if (same) continue;
        throw InvalidInput(
            fmt::format("the library has another model named {} already: remove or rename it first",
                        input.name));
    }
    return missing;
}

// A model of one of the libraries to merge.
struct Origin {
    std::size_t library = 0;
    StoredModel model;
};

std::vector<Origin> all_models(std::vector<LibraryStore>& stores) {
    std::vector<Origin> origins;
    for (std::size_t s = 0; s < stores.size(); ++s) {
        for (StoredModel& model : stores[s].models()) origins.push_back({s, std::move(model)});
    }
    std::stable_sort(origins.begin(), origins.end(),
                     [](const Origin& a, const Origin& b) { return a.model.name < b.model.name; });
    for (std::size_t i = 1; i < origins.size(); ++i) {
        if (origins[i].model.name != origins[i - 1].model.name) continue;
        throw InvalidInput(fmt::format(
            "{} and {} both have a model named {}", stores[origins[i - 1].library].path().string(),
            stores[origins[i].library].path().string(), origins[i].model.name));
    }
    return origins;
}

// For libraries with bags of words, which depend on all models, and of earlier formats.
void merge_in_memory(std::span<const fs::path> libraries, const fs::path& output) {
    std::vector<ModelRecord> records;
    std::optional<ModelLibrary> first;
    for (const fs::path& path : libraries) {
        ModelLibrary library = load_library(path);
        if (!first) first = {.settings = library.settings, .codebook = library.codebook};
        require_equal_settings(first->settings, library.settings, path);
        for (ModelRecord& record : split_library(std::move(library))) {
            records.push_back(std::move(record));
        }
    }
    ModelLibrary merged = join_records(first->settings, std::move(records));
    if (first->codebook.size() > 0) make_bags(merged);
    save_library(merged, output);
}

}  // namespace

AddOutcome add_models(const fs::path& library, std::span<const ModelInput> models,
                      const Progress& progress) {
    require_distinct_names(models);
    LibraryStore store = open_for_editing(library);
    const std::vector<ModelInput> missing = missing_models(store, models);
    const bool with_bags = store.has_bags();
    std::vector<StoredRecord> waiting;
    const auto put = [&](std::span<const StoredRecord> records) {
        Transaction transaction(store.database());
        for (const StoredRecord& record : records) {
            // Another process may have added it since.
            if (store.contains(name_of(record))) {
                throw InvalidInput(
                    fmt::format("the library has a model named {} already", name_of(record)));
            }
            store.put(record);
        }
        seal(store, with_bags);
        transaction.commit();
    };
    build_records(
        missing, store.settings(),
        [&](const ModelRecord& record) {
            waiting.push_back(to_stored(record, store.settings()));
            if (with_bags) return;  // the words are made anew once, for all
            put(waiting);
            waiting.clear();
        },
        progress);
    if (!waiting.empty()) put(waiting);
    return {.added = missing.size(), .present = models.size() - missing.size()};
}

void remove_models(const fs::path& library, std::span<const std::string> names) {
    LibraryStore store = open_for_editing(library);
    const bool with_bags = store.has_bags();
    Transaction transaction(store.database());
    for (const std::string& name : names) store.remove(name);
    if (store.models().empty()) throw InvalidInput("a library needs at least one model");
    seal(store, with_bags);
    transaction.commit();
}

void rename_model(const fs::path& library, const std::string& from, const std::string& to) {
    if (to.empty()) throw InvalidInput("a model's name must not be empty");
    LibraryStore store = open_for_editing(library);
    const bool with_bags = store.has_bags();
    Transaction transaction(store.database());
    store.find(from);
    if (store.contains(to)) {
        throw InvalidInput(fmt::format("the library has a model named {} already", to));
    }
    store.rename(from, to);
    seal(store, with_bags);
    transaction.commit();
}

void set_confidence(const fs::path& library, const ConfidenceModel& confidence, ScanKind kind) {
    LibraryStore store = open_for_editing(library);
    Transaction transaction(store.database());
    store.put_confidence(confidence, kind);
    transaction.commit();
}

std::size_t index_keypoints(const fs::path& library) {
    LibraryStore store = open_for_editing(library);
    Transaction transaction(store.database());
    const std::vector<std::uint8_t> bytes = all_keypoint_rows(load_store(store));
    if (bytes.empty()) throw InvalidInput("no model of the library has keypoints");
    const ByteRows rows{bytes, kShotLength};
    store.put_graph(build_neighbor_graph(rows));
    transaction.commit();
    return rows.size();
}

void merge_libraries(std::span<const fs::path> libraries, const fs::path& output,
                     const Progress& progress) {
    if (libraries.empty()) throw InvalidInput("nothing to merge");
    const bool in_memory =
        std::any_of(libraries.begin(), libraries.end(),
                    [](const fs::path& path) { return library_format(path) != kLibraryFormat; });
    if (in_memory || LibraryStore::open(libraries.front(), Database::Mode::read).has_bags()) {
        return merge_in_memory(libraries, output);
    }
    std::vector<LibraryStore> stores;
    for (const fs::path& path : libraries) {
        stores.push_back(LibraryStore::open(path, Database::Mode::read));
        require_equal_settings(stores.front().settings(), stores.back().settings(), path);
    }
    const std::vector<Origin> origins = all_models(stores);
    const auto record = [&](std::size_t i) {
        LibraryStore& store = stores[origins[i].library];
        StoredRecord stored = store.read(origins[i].model);
        if (digest_of(stored) != origins[i].model.sha256) {
            throw FormatError(store.path(), "model " + origins[i].model.name,
                              "its checksum differs");
        }
        report(progress, "models", i + 1, origins.size());
        return stored;
    };
    write_library(output, stores.front().settings(), origins.size(), record);
}

}  // namespace ostraka
