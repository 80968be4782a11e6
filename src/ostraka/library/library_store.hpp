// SPDX-License-Identifier: Apache-2.0
// A library file, opened: its models are read, put in and taken out one at a time, so that memory
// depends on the largest model, not on their number. Changes are made in transactions: after a
// kill, a power failure or an exception the file is as it was before the last one begun.
// Private; schema and digests in docs/library_format.md.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ostraka/library/library_file.hpp"
#include "ostraka/library/sqlite.hpp"
#include "ostraka/library/stored_record.hpp"

namespace ostraka {

/// What a file says about a model without its content being read.
struct StoredModel {
    std::int64_t id = 0;
    std::string name;
    std::string file;           ///< provenance
    std::string source_sha256;  ///< provenance
    std::string sha256;         ///< digest_of() its record
};

class LibraryStore {
  public:
    /// Writes the schema and settings into an empty file.
    /// @param file   to write to. @param named  what messages call it.
    static LibraryStore create(const std::filesystem::path& file, const LibrarySettings& settings,
                               const std::filesystem::path& named);
    /// @throws FileError; FormatError if it isn't a library of kLibraryFormat or its settings are
    ///         damaged.
    static LibraryStore open(const std::filesystem::path& file, Database::Mode mode);

    const LibrarySettings& settings() const { return settings_; }
    Database& database() { return *database_; }
    const std::filesystem::path& path() const { return named_; }

    /// By name.
    std::vector<StoredModel> models();
    /// @throws InvalidInput if no model has the name.
    StoredModel find(const std::string& name);
    bool contains(const std::string& name);
    /// As it is in the file, unchecked.
    StoredRecord read(const StoredModel& model);
    /// Checked against its digest and decoded. @throws FormatError, naming the model.
    ModelRecord load(const StoredModel& model);

    /// These belong into a Transaction, which seal() ends.
    void put(const StoredRecord& record);
    void remove(const std::string& name);
    void rename(const std::string& from, const std::string& to);
    /// Replaces codebook and bags: those of the library (models in the order of their names), or
    /// none.
    void put_bags(const ModelLibrary& library);
    bool has_bags();
    /// @param library  joined of all records, by name: gets the codebook and bags.
    /// @throws FormatError if they are damaged.
    void load_bags(ModelLibrary& library);
    bool has_graph();
    /// Stores a graph of the keypoint rows of all models that are in the file now.
    void put_graph(const NeighborGraph& graph);
    /// Leaves the library without one where the file has none, or models have changed since.
    /// @param library  joined of all records. @throws FormatError if it is damaged.
    void load_graph(ModelLibrary& library);
    bool has_confidence();
    /// Stores what was fitted to the models that are in the file now.
    void put_confidence(const ConfidenceModel& confidence, ScanKind kind);
    /// Leaves the library without where the file has none, models have changed since, or it was
    /// fitted to other features than today's. @throws FormatError if it is damaged.
    void load_confidence(ModelLibrary& library);
    /// Brings the checksums up to date.
    void seal();

    /// Everything wrong with the parts that span models: checksums of settings, models, codebook.
    std::vector<std::string> damaged_checksums();

  private:
    LibraryStore(std::unique_ptr<Database> database, std::filesystem::path named)
        : database_(std::move(database)), named_(std::move(named)) {}
    std::vector<std::pair<std::string, std::string>> checksums();
    std::string models_digest();
    std::optional<ConfidenceModel> stored_confidence(ScanKind kind);
    void put_settings();
    void load_settings();

    std::unique_ptr<Database> database_;
    std::filesystem::path named_;
    LibrarySettings settings_;
};

/// Format of the library at a path. @throws FileError; FormatError if it is none.
std::int64_t library_format(const std::filesystem::path& path);

}  // namespace ostraka
