// SPDX-License-Identifier: Apache-2.0
// A thin owner of an SQLite connection and its statements: errors become exceptions. Private.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace ostraka {

class Database {
  public:
    /// `read` takes back what a killed writer left undone, if it may write; it changes nothing
    /// else.
    enum class Mode { read, edit, create };
    /// Waits up to 20 s for another process that is writing.
    /// @throws FileError if the file can't be opened or created.
    /// @param named  what messages call the file.
    Database(const std::filesystem::path& path, Mode mode, const std::filesystem::path& named);
    ~Database();
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    /// Runs statements without results. @throws FileError.
    void run(const char* sql);
    /// First column of the first row; 0 if there is none. @throws FileError, FormatError.
    std::int64_t number(const char* sql);
    sqlite3* handle() const { return handle_; }
    /// Throws what SQLite says about the last failure: FileError for the medium, FormatError for
    /// the content.
    [[noreturn]] void fail() const;

  private:
    std::filesystem::path path_;
    sqlite3* handle_ = nullptr;
};

/// Changes that take effect together, by commit(), or not at all. No other process may write to the
/// file in between.
class Transaction {
  public:
    explicit Transaction(Database& database);
    ~Transaction();
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    void commit();

  private:
    Database& database_;
    bool open_ = true;
};

/// A prepared statement. Parameters count from 1, columns from 0, as in SQLite.
class Statement {
  public:
    Statement(Database& database, const char* sql);
    ~Statement();
    Statement(const Statement&) = delete;
    Statement& operator=(const Statement&) = delete;

    void bind(int parameter, std::int64_t value);
    void bind(int parameter, double value);
    void bind(int parameter, const std::string& value);
    template <class T>
    void bind_blob(int parameter, std::span<const T> values) {
        bind_bytes(parameter, values.data(), values.size_bytes());
    }
    /// True if there is a row.
    bool step();
    /// Makes the statement ready for new parameters.
    void reset();

    /// The value as it is stored: integer, real, text or blob. @throws InvalidInput for NULL.
    std::variant<std::int64_t, double, std::string, std::vector<unsigned char>> cell(
        int column) const;
    std::int64_t integer(int column) const;
    double real(int column) const;
    std::string text(int column) const;
    /// The blob as values of T. @throws InvalidInput if its size is no multiple of T's.
    template <class T>
    std::vector<T> blob(int column) const {
        const std::span<const unsigned char> bytes = blob_bytes(column, sizeof(T));
        std::vector<T> values(bytes.size() / sizeof(T));
        if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
        return values;
    }

  private:
    void bind_bytes(int parameter, const void* data, std::size_t size);
    std::span<const unsigned char> blob_bytes(int column, std::size_t item) const;

    Database& database_;
    sqlite3_stmt* statement_ = nullptr;
};

}  // namespace ostraka
