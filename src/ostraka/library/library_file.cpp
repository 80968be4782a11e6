// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/library_file.hpp"

#include <fmt/format.h>

#include <ostream>

#include "ostraka/base/error.hpp"
#include "ostraka/base/parallel.hpp"
#include "ostraka/base/sha256.hpp"
#include "ostraka/io/atomic_file.hpp"
#include "ostraka/library/bags.hpp"
#include "ostraka/library/library_copy.hpp"
#include "ostraka/library/library_format1.hpp"
#include "ostraka/library/settings_text.hpp"

namespace ostraka {
namespace {

constexpr std::size_t kModelsInFlight = 8;

std::string hex(const Bytes& bytes) {
    std::string text;
    for (const unsigned char byte : bytes) {
        text += "0123456789abcdef"[byte >> 4U];
        text += "0123456789abcdef"[byte & 15U];
    }
    return text;
}

std::string as_text(const Cell& cell) {
    return std::visit(
        [](const auto& value) {
            using T = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<T, Bytes>) {
                return hex(value);
            } else if constexpr (std::is_same_v<T, std::string>) {
                return value;
            } else {
                return fmt::format("{}", value);
            }
        },
        cell);
}

void dump_row(std::ostream& out, std::string_view table, const Row& row) {
    out << table;
    for (const Cell& cell : row) out << '\t' << as_text(cell);
    out << '\n';
}

std::string content_digest(LibraryStore& store) {
    std::vector<Row> rows;
    for (const auto& [key, value] : to_text(store.settings())) rows.push_back({key, value});
    for (const StoredModel& model : store.models()) rows.push_back({model.name, model.sha256});
    return digest_of(rows);
}

void check_structure(Database& database, LibraryCheck& check) {
    Statement integrity(database, "PRAGMA integrity_check(5)");
    while (integrity.step()) {
        if (integrity.text(0) != "ok") check.problems.push_back("database: " + integrity.text(0));
    }
    for (const char* table : {"entry", "descriptor", "bag"}) {
        const std::int64_t stray = database.number(
            fmt::format("SELECT count(*) FROM {} WHERE model NOT IN (SELECT id FROM model)", table)
                .c_str());
        if (stray > 0)
            check.problems.push_back(fmt::format("{}: {} rows of no model", table, stray));
    }
}

// Every model is checked, so that one damaged model doesn't hide another.
void check_models(LibraryStore& store, LibraryCheck& check, const Progress& progress) {
    const std::vector<StoredModel> models = store.models();
    check.models = models.size();
    for (std::size_t m = 0; m < models.size(); ++m) {
        try {
            check.entries += store.load(models[m]).entries.size();
        } catch (const Error& error) {
            check.problems.emplace_back(error.what());
        }
        report(progress, "models", m + 1, models.size());
    }
}

}  // namespace

void write_library(const std::filesystem::path& path, const LibrarySettings& settings,
                   std::size_t count, const std::function<StoredRecord(std::size_t)>& record,
                   const ModelLibrary* bags) {
    AtomicFile file(path);
    {
        LibraryStore store = LibraryStore::create(file.temporary(), settings, path);
        // Nobody else sees the file until it is complete and flushed, so it needs no journal.
        store.database().run("PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF;");
        Transaction transaction(store.database());
        for (std::size_t i = 0; i < count; ++i) store.put(record(i));
        if (bags != nullptr) store.put_bags(*bags);
        store.seal();
        transaction.commit();
    }
    file.commit();
}

ModelLibrary load_store(LibraryStore& store) {
    const std::vector<StoredModel> models = store.models();
    if (models.empty()) return join_records(store.settings(), {});
    std::vector<StoredRecord> stored(models.size());
    std::vector<ModelRecord> records(models.size());
    const auto damaged = [&](std::size_t m, const char* why) {
        return FormatError(store.path(), "model " + models[m].name, why);
    };
    ordered_pipeline(
        models.size(), kModelsInFlight,
        [&](std::size_t m) {
            try {
                stored[m] = store.read(models[m]);
            } catch (const InvalidInput& error) {
                throw damaged(m, error.what());
            }
        },
        [&](std::size_t m) {
            if (digest_of(stored[m]) != models[m].sha256) throw damaged(m, "its checksum differs");
            try {
                records[m] = from_stored(stored[m], store.settings());
            } catch (const InvalidInput& error) {
                throw damaged(m, error.what());
            }
            stored[m] = {};
        },
        [](std::size_t) {});
    return join_records(store.settings(), std::move(records));
}

void make_bags_anew(LibraryStore& store) {
    ModelLibrary library = load_store(store);
    make_bags(library);
    store.put_bags(library);
}

void save_library(const ModelLibrary& library, const std::filesystem::path& path) {
    const std::vector<ModelRecord> records = split_library(library);
    write_library(
        path, library.settings, records.size(),
        [&](std::size_t i) { return to_stored(records[i], library.settings); }, &library);
}

ModelLibrary load_library(const std::filesystem::path& path) {
    if (library_format(path) == 1) return load_library_format1(path);
    LibraryStore store = LibraryStore::open(path, Database::Mode::read);
    const std::vector<std::string> problems = store.damaged_checksums();
    if (!problems.empty()) throw FormatError(path, "library", problems.front());
    ModelLibrary library = load_store(store);
    store.load_bags(library);
    store.load_graph(library);
    store.load_confidence(library);
    if (library.models.empty()) throw FormatError(path, "library", "it has no models");
    return library;
}

std::vector<std::string> model_names(const std::filesystem::path& path) {
    std::vector<std::string> names;
    if (library_format(path) == 1) {
        for (const Model& model : load_library_format1(path).models) names.push_back(model.name);
        return names;
    }
    LibraryStore store = LibraryStore::open(path, Database::Mode::read);
    for (const StoredModel& model : store.models()) names.push_back(model.name);
    return names;
}

LibraryCheck verify_library(const std::filesystem::path& path, const Progress& progress) {
    LibraryCheck check;
    check.format = library_format(path);
    try {
        if (check.format == 1) {
            const ModelLibrary library = load_library_format1(path);
            check.models = library.models.size();
            check.entries = library.entries.size();
            return check;
        }
        LibraryStore store = LibraryStore::open(path, Database::Mode::read);
        check_structure(store.database(), check);
        for (const std::string& problem : store.damaged_checksums()) {
            check.problems.push_back(problem);
        }
        check_models(store, check, progress);
        check.sha256 = content_digest(store);
        if ((store.has_bags() || store.has_graph() || store.has_confidence()) &&
            check.problems.empty()) {
            ModelLibrary library = load_store(store);
            store.load_bags(library);
            store.load_graph(library);
            store.load_confidence(library);
        }
    } catch (const FormatError& error) {
        check.problems.emplace_back(error.what());
    }
    return check;
}

void dump_library(const std::filesystem::path& path, std::ostream& out) {
    if (library_format(path) == 1) {
        throw FormatError(path, "header", "a library of format 1 has no dump: `merge` converts it");
    }
    LibraryStore store = LibraryStore::open(path, Database::Mode::read);
    for (const auto& [key, value] : to_text(store.settings())) {
        dump_row(out, "setting", {key, value});
    }
    for (const StoredModel& model : store.models()) {
        const StoredRecord record = store.read(model);
        dump_row(out, "model", record.model);
        for (const Row& row : record.entries) dump_row(out, "entry", row);
        for (const Row& row : record.descriptors) dump_row(out, "descriptor", row);
    }
}

}  // namespace ostraka
