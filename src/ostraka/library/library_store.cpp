// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/library_store.hpp"

#include <fmt/format.h>

#include <cmath>

#include "ostraka/base/error.hpp"
#include "ostraka/library/bags.hpp"
#include "ostraka/library/settings_text.hpp"

namespace ostraka {
namespace {

constexpr std::int64_t kApplicationId = 0x4f535452;  // "OSTR"

constexpr const char* kSchema = R"sql(
CREATE TABLE checksum(part TEXT PRIMARY KEY, sha256 TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE setting(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE model(id INTEGER PRIMARY KEY, sha256 TEXT NOT NULL, name TEXT NOT NULL UNIQUE,
    file TEXT NOT NULL, source_sha256 TEXT NOT NULL, vertices BLOB NOT NULL, triangles BLOB NOT NULL,
    shape BLOB NOT NULL, surface BLOB NOT NULL, keypoint_points BLOB NOT NULL,
    keypoint_frames BLOB NOT NULL, keypoint_rows BLOB NOT NULL, counts BLOB NOT NULL,
    coverage REAL NOT NULL, covered BLOB NOT NULL, symmetry BLOB NOT NULL);
CREATE TABLE entry(model INTEGER NOT NULL REFERENCES model(id), number INTEGER NOT NULL,
    view INTEGER NOT NULL, direction INTEGER NOT NULL, fraction INTEGER NOT NULL,
    viewpoint BLOB NOT NULL, frame BLOB NOT NULL, ambiguity INTEGER NOT NULL, points BLOB NOT NULL,
    PRIMARY KEY(model, number));
CREATE TABLE descriptor(model INTEGER NOT NULL REFERENCES model(id), name TEXT NOT NULL,
    rows BLOB NOT NULL, means BLOB NOT NULL, directions BLOB NOT NULL, scales BLOB NOT NULL,
    PRIMARY KEY(model, name));
CREATE TABLE codebook(word INTEGER PRIMARY KEY, row BLOB NOT NULL);
CREATE TABLE bag(model INTEGER PRIMARY KEY REFERENCES model(id), rows BLOB NOT NULL);
)sql";

std::string insertion(const char* table, std::size_t columns) {
    std::string marks = "?";
    for (std::size_t i = 1; i < columns; ++i) marks += ",?";
    return fmt::format("INSERT INTO {} VALUES({})", table, marks);
}

void bind(Statement& statement, int parameter, const Cell& cell) {
    if (const Bytes* bytes = std::get_if<Bytes>(&cell)) {
        statement.bind_blob(parameter, std::span<const unsigned char>(*bytes));
    } else if (const auto* text = std::get_if<std::string>(&cell)) {
        statement.bind(parameter, *text);
    } else if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
        statement.bind(parameter, *integer);
    } else {
        statement.bind(parameter, std::get<double>(cell));
    }
}

void insert_row(Statement& statement, std::initializer_list<Cell> keys, const Row& row) {
    int parameter = 0;
    for (const Cell& key : keys) bind(statement, ++parameter, key);
    for (const Cell& value : row) bind(statement, ++parameter, value);
    statement.step();
    statement.reset();
}

// The rest of the columns, from `first` on.
Row read_row(const Statement& statement, int first, std::size_t columns) {
    Row row;
    for (int i = first; i < first + static_cast<int>(columns); ++i) {
        row.push_back(statement.cell(i));
    }
    return row;
}

Row read_one(Database& database, const char* sql, std::int64_t model, std::size_t columns) {
    Statement select(database, sql);
    select.bind(1, model);
    if (!select.step()) throw InvalidInput("the library lacks a row");
    return read_row(select, 0, columns);
}

std::vector<Row> read_all(Database& database, const char* sql, std::size_t columns) {
    Statement select(database, sql);
    std::vector<Row> rows;
    while (select.step()) rows.push_back(read_row(select, 0, columns));
    return rows;
}

void append_floats(std::vector<float>& values, const Row& row, std::size_t column,
                   std::size_t count) {
    const Bytes* bytes = std::get_if<Bytes>(&row[column]);
    if (bytes == nullptr || bytes->size() != count * sizeof(float)) {
        throw InvalidInput("the codebook or a bag of words has another length");
    }
    const std::size_t before = values.size();
    values.resize(before + count);
    if (count > 0) std::memcpy(values.data() + before, bytes->data(), bytes->size());
    for (std::size_t i = before; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) throw InvalidInput("a word's number is not finite");
    }
}

template <class T>
Bytes bytes_of(std::span<T> values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    return {bytes, bytes + values.size_bytes()};
}

}  // namespace

std::int64_t library_format(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path)) throw FileError(path, "no such file");
    if (std::filesystem::is_directory(path)) throw FileError(path, "is a folder");
    Database database(path, Database::Mode::read, path);
    if (database.number("PRAGMA application_id") != kApplicationId) {
        throw FormatError(path, "header", "not an Ostraka library");
    }
    const std::int64_t format = database.number("PRAGMA user_version");
    if (format >= 1 && format <= kLibraryFormat) return format;
    throw FormatError(path, "header",
                      fmt::format("library format {}, this program reads formats 1 to {}", format,
                                  kLibraryFormat));
}

LibraryStore LibraryStore::create(const std::filesystem::path& file,
                                  const LibrarySettings& settings,
                                  const std::filesystem::path& named) {
    LibraryStore store(std::make_unique<Database>(file, Database::Mode::create, named), named);
    store.settings_ = settings;
    Database& database = store.database();
    // Until it is whole the file is worth nothing, so a journal would only be litter after a kill.
    database.run("PRAGMA page_size=8192; PRAGMA journal_mode=MEMORY;");
    database.run(fmt::format("PRAGMA application_id={}; PRAGMA user_version={};", kApplicationId,
                             kLibraryFormat)
                     .c_str());
    Transaction transaction(database);
    database.run(kSchema);
    store.put_settings();
    store.seal();
    transaction.commit();
    return store;
}

LibraryStore LibraryStore::open(const std::filesystem::path& file, Database::Mode mode) {
    const std::int64_t format = library_format(file);
    if (format != kLibraryFormat) {
        throw FormatError(file, "header", fmt::format("library format {}", format));
    }
    LibraryStore store(std::make_unique<Database>(file, mode, file), file);
    store.load_settings();
    return store;
}

void LibraryStore::put_settings() {
    Statement insert(*database_, "INSERT INTO setting VALUES(?,?)");
    for (const auto& [key, value] : to_text(settings_)) insert_row(insert, {}, {key, value});
}

void LibraryStore::load_settings() {
    SettingTexts texts;
    Statement select(*database_, "SELECT key, value FROM setting");
    while (select.step()) texts[select.text(0)] = select.text(1);
    try {
        settings_ = settings_from_text(texts);
    } catch (const InvalidInput& error) {
        throw FormatError(named_, "settings", error.what());
    }
}

std::vector<StoredModel> LibraryStore::models() {
    Statement select(*database_,
                     "SELECT id, name, file, source_sha256, sha256 FROM model ORDER BY name");
    std::vector<StoredModel> models;
    while (select.step()) {
        models.push_back(
            {select.integer(0), select.text(1), select.text(2), select.text(3), select.text(4)});
    }
    return models;
}

StoredModel LibraryStore::find(const std::string& name) {
    for (StoredModel& model : models()) {
        if (model.name == name) return std::move(model);
    }
    throw InvalidInput(fmt::format("the library has no model named {}", name));
}

bool LibraryStore::contains(const std::string& name) {
    Statement select(*database_, "SELECT 1 FROM model WHERE name=?");
    select.bind(1, name);
    return select.step();
}

StoredRecord LibraryStore::read(const StoredModel& model) {
    StoredRecord record;
    record.model = read_one(*database_,
                            "SELECT name, file, source_sha256, vertices, triangles, shape, surface,"
                            " keypoint_points, keypoint_frames, keypoint_rows, counts, coverage,"
                            " covered, symmetry FROM model WHERE id=?",
                            model.id, kModelColumns);
    Statement entries(
        *database_,
        "SELECT number, view, direction, fraction, viewpoint, frame, ambiguity, points"
        " FROM entry WHERE model=? ORDER BY number");
    entries.bind(1, model.id);
    while (entries.step()) {
        if (entries.integer(0) != static_cast<std::int64_t>(record.entries.size())) {
            throw InvalidInput("entries are not numbered from 0");
        }
        record.entries.push_back(read_row(entries, 1, kEntryColumns));
    }
    Statement descriptors(*database_,
                          "SELECT name, rows, means, directions, scales FROM descriptor"
                          " WHERE model=? ORDER BY name");
    descriptors.bind(1, model.id);
    while (descriptors.step()) {
        record.descriptors.push_back(read_row(descriptors, 0, kDescriptorColumns));
    }
    return record;
}

ModelRecord LibraryStore::load(const StoredModel& model) {
    try {
        const StoredRecord record = read(model);
        if (digest_of(record) != model.sha256) throw InvalidInput("its checksum differs");
        return from_stored(record, settings_);
    } catch (const InvalidInput& error) {
        throw FormatError(named_, "model " + model.name, error.what());
    }
}

void LibraryStore::put(const StoredRecord& record) {
    const std::int64_t id = database_->number("SELECT coalesce(max(id) + 1, 0) FROM model");
    Statement model(*database_, insertion("model", 2 + kModelColumns).c_str());
    insert_row(model, {id, digest_of(record)}, record.model);
    Statement entry(*database_, insertion("entry", 2 + kEntryColumns).c_str());
    std::int64_t number = 0;
    for (const Row& row : record.entries) insert_row(entry, {id, number++}, row);
    Statement descriptor(*database_, insertion("descriptor", 1 + kDescriptorColumns).c_str());
    for (const Row& row : record.descriptors) insert_row(descriptor, {id}, row);
}

void LibraryStore::remove(const std::string& name) {
    const std::int64_t id = find(name).id;
    for (const char* sql : {"DELETE FROM bag WHERE model=?", "DELETE FROM descriptor WHERE model=?",
                            "DELETE FROM entry WHERE model=?", "DELETE FROM model WHERE id=?"}) {
        Statement statement(*database_, sql);
        statement.bind(1, id);
        statement.step();
    }
}

void LibraryStore::rename(const std::string& from, const std::string& to) {
    const StoredModel model = find(from);
    StoredRecord record = read(model);
    record.model[0] = to;
    Statement update(*database_, "UPDATE model SET name=?, sha256=? WHERE id=?");
    update.bind(1, to);
    update.bind(2, digest_of(record));
    update.bind(3, model.id);
    update.step();
}

bool LibraryStore::has_bags() {
    return database_->number("SELECT count(*) FROM codebook") > 0;
}

void LibraryStore::put_bags(const ModelLibrary& library) {
    database_->run("DELETE FROM codebook; DELETE FROM bag;");
    const Codebook& codebook = library.codebook;
    if (codebook.size() == 0) return;
    Statement word(*database_, "INSERT INTO codebook VALUES(?,?)");
    for (std::size_t w = 0; w < codebook.size(); ++w) {
        insert_row(
            word, {static_cast<std::int64_t>(w)},
            {bytes_of(std::span(codebook.words).subspan(w * codebook.length, codebook.length))});
    }
    Statement bag(*database_, "INSERT INTO bag VALUES(?,?)");
    const std::vector<StoredModel> stored = models();
    std::size_t first = 0;
    for (std::size_t m = 0; m < stored.size(); ++m) {
        std::size_t last = first;
        while (last < library.entries.size() && library.entries[last].model == m) ++last;
        insert_row(
            bag, {stored[m].id},
            {bytes_of(std::span(library.bags)
                          .subspan(first * codebook.size(), (last - first) * codebook.size()))});
        first = last;
    }
}

void LibraryStore::load_bags(ModelLibrary& library) {
    if (!has_bags()) return;
    try {
        library.codebook = Codebook{kShotLength, {}};
        const std::vector<Row> words =
            read_all(*database_, "SELECT word, row FROM codebook ORDER BY word", 2);
        for (const Row& row : words) {
            append_floats(library.codebook.words, row, 1, library.codebook.length);
        }
        std::vector<std::size_t> counts(library.models.size(), 0);
        for (const Entry& entry : library.entries) ++counts[entry.model];
        const std::vector<StoredModel> stored = models();
        for (std::size_t m = 0; m < stored.size(); ++m) {
            append_floats(
                library.bags,
                read_one(*database_, "SELECT rows FROM bag WHERE model=?", stored[m].id, 1), 0,
                counts[m] * library.codebook.size());
        }
    } catch (const InvalidInput& error) {
        throw FormatError(named_, "codebook", error.what());
    }
}

std::string LibraryStore::models_digest() {
    return digest_of(read_all(*database_, "SELECT name, sha256 FROM model ORDER BY name", 2));
}

void LibraryStore::put_graph(const NeighborGraph& graph) {
    // The table came after format 2; readers that don't know it search exactly.
    database_->run(
        "CREATE TABLE IF NOT EXISTS graph(name TEXT PRIMARY KEY, models_sha256 TEXT NOT NULL,"
        " sha256 TEXT NOT NULL, degree INTEGER NOT NULL, start INTEGER NOT NULL,"
        " links BLOB NOT NULL); DELETE FROM graph;");
    const Row content = {std::int64_t{graph.degree}, std::int64_t{graph.start},
                         bytes_of(std::span(graph.links))};
    Statement insert(*database_, insertion("graph", 6).c_str());
    insert_row(insert,
               {std::string("keypoints"), models_digest(), digest_of(std::vector<Row>{content})},
               content);
}

bool LibraryStore::has_graph() {
    return database_->number("SELECT count(*) FROM sqlite_master WHERE name='graph'") > 0;
}

void LibraryStore::load_graph(ModelLibrary& library) {
    if (!has_graph()) return;
    Statement select(*database_,
                     "SELECT models_sha256, sha256, degree, start, links FROM graph"
                     " WHERE name='keypoints'");
    if (!select.step() || select.text(0) != models_digest()) return;
    try {
        const Row content = read_row(select, 2, 3);
        if (digest_of(std::vector<Row>{content}) != select.text(1))
            throw InvalidInput("its checksum differs");
        NeighborGraph graph;
        graph.degree = static_cast<std::uint32_t>(select.integer(2));
        graph.start = static_cast<std::uint32_t>(select.integer(3));
        graph.links = select.blob<std::uint32_t>(4);
        std::size_t rows = 0;
        for (const Model& model : library.models) rows += model.keypoints.size();
        check_graph(graph, rows);
        library.keypoint_graph = std::move(graph);
    } catch (const InvalidInput& error) {
        throw FormatError(named_, "keypoint graph", error.what());
    }
}

std::vector<std::pair<std::string, std::string>> LibraryStore::checksums() {
    const auto digest = [&](const char* sql, std::size_t columns) {
        return digest_of(read_all(*database_, sql, columns));
    };
    return {{"models", models_digest()},
            {"codebook", digest("SELECT word, row FROM codebook ORDER BY word", 2)},
            {"bags", digest("SELECT name, rows FROM bag JOIN model ON model=id ORDER BY name", 2)},
            {"settings", digest("SELECT key, value FROM setting ORDER BY key", 2)}};
}

void LibraryStore::seal() {
    Statement insert(*database_, "INSERT OR REPLACE INTO checksum VALUES(?,?)");
    for (const auto& [part, sha256] : checksums()) insert_row(insert, {}, {part, sha256});
}

std::vector<std::string> LibraryStore::damaged_checksums() {
    std::vector<std::string> problems;
    Statement select(*database_, "SELECT sha256 FROM checksum WHERE part=?");
    for (const auto& [part, sha256] : checksums()) {
        select.bind(1, part);
        if (!select.step()) {
            problems.push_back(part + ": no checksum");
        } else if (select.text(0) != sha256) {
            problems.push_back(part + ": the checksum differs");
        }
        select.reset();
    }
    return problems;
}

}  // namespace ostraka
