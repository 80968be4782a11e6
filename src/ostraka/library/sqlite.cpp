// SPDX-License-Identifier: Apache-2.0
#include "ostraka/library/sqlite.hpp"

#include <fmt/format.h>

#include "ostraka/base/error.hpp"

namespace ostraka {
namespace {

constexpr int kBusyMilliseconds = 20000;

}  // namespace

Database::Database(const std::filesystem::path& path, Mode mode, const std::filesystem::path& named)
    : path_(named) {
    // Where writing isn't allowed SQLite falls back to reading by itself.
    const int flags = SQLITE_OPEN_READWRITE | (mode == Mode::create ? SQLITE_OPEN_CREATE : 0);
    if (sqlite3_open_v2(path.c_str(), &handle_, flags, nullptr) != SQLITE_OK) {
        const std::string problem = handle_ ? sqlite3_errmsg(handle_) : "out of memory";
        sqlite3_close(handle_);
        throw FileError(named, problem);
    }
    // The file may come from anywhere: its schema must not run anything.
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_busy_timeout(handle_, kBusyMilliseconds);
    if (mode == Mode::read) {
        sqlite3_exec(handle_, "PRAGMA query_only=1", nullptr, nullptr, nullptr);
    } else if (sqlite3_db_readonly(handle_, "main") == 1) {
        sqlite3_close(handle_);
        throw FileError(named, "can't be written: permission denied");
    }
}

Database::~Database() {
    sqlite3_close(handle_);
}

void Database::run(const char* sql) {
    if (sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

std::int64_t Database::number(const char* sql) {
    Statement statement(*this, sql);
    return statement.step() ? statement.integer(0) : 0;
}

void Database::fail() const {
    const std::string problem = sqlite3_errmsg(handle_);
    switch (sqlite3_errcode(handle_)) {
        case SQLITE_NOTADB:
        case SQLITE_CORRUPT:
            throw FormatError(path_, "library", problem);
        case SQLITE_ERROR:
            throw FormatError(path_, "library", problem);
        case SQLITE_FULL:
            throw FileError(path_, "no space left on the disk");
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
            throw FileError(path_, "another process is writing to it");
        default:
            throw FileError(path_, problem);
    }
}

Transaction::Transaction(Database& database) : database_(database) {
    database_.run("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
    // A failure to take back is of no consequence: the file does so when it is opened next.
    if (open_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void Transaction::commit() {
    database_.run("COMMIT");
    open_ = false;
}

Statement::Statement(Database& database, const char* sql) : database_(database) {
    if (sqlite3_prepare_v2(database.handle(), sql, -1, &statement_, nullptr) != SQLITE_OK) {
        database.fail();
    }
}

Statement::~Statement() {
    sqlite3_finalize(statement_);
}

void Statement::bind(int parameter, std::int64_t value) {
    if (sqlite3_bind_int64(statement_, parameter, value) != SQLITE_OK) database_.fail();
}

void Statement::bind(int parameter, double value) {
    if (sqlite3_bind_double(statement_, parameter, value) != SQLITE_OK) database_.fail();
}

void Statement::bind(int parameter, const std::string& value) {
    if (sqlite3_bind_text(statement_, parameter, value.data(), static_cast<int>(value.size()),
                          SQLITE_TRANSIENT) != SQLITE_OK) {
        database_.fail();
    }
}

void Statement::bind_bytes(int parameter, const void* data, std::size_t size) {
    static const char kEmpty = 0;
    if (sqlite3_bind_blob64(statement_, parameter, size > 0 ? data : &kEmpty, size,
                            SQLITE_TRANSIENT) != SQLITE_OK) {
        database_.fail();
    }
}

bool Statement::step() {
    const int code = sqlite3_step(statement_);
    if (code != SQLITE_ROW && code != SQLITE_DONE) database_.fail();
    return code == SQLITE_ROW;
}

void Statement::reset() {
    sqlite3_reset(statement_);
    sqlite3_clear_bindings(statement_);
}

std::variant<std::int64_t, double, std::string, std::vector<unsigned char>> Statement::cell(
    int column) const {
    switch (sqlite3_column_type(statement_, column)) {
        case SQLITE_INTEGER:
            return integer(column);
        case SQLITE_FLOAT:
            return real(column);
        case SQLITE_TEXT:
            return text(column);
        case SQLITE_BLOB:
            return blob<unsigned char>(column);
        default:
            throw InvalidInput(
                fmt::format("column {} is empty", sqlite3_column_name(statement_, column)));
    }
}

std::int64_t Statement::integer(int column) const {
    return sqlite3_column_int64(statement_, column);
}

double Statement::real(int column) const {
    return sqlite3_column_double(statement_, column);
}

std::string Statement::text(int column) const {
    const auto* bytes = sqlite3_column_text(statement_, column);
    if (bytes == nullptr) return {};
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return std::string(bytes, bytes + size);
}

std::span<const unsigned char> Statement::blob_bytes(int column, std::size_t item) const {
    const auto* bytes = static_cast<const unsigned char*>(sqlite3_column_blob(statement_, column));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    if (size % item != 0) {
        throw InvalidInput(fmt::format("column {} holds {} bytes, no multiple of {}",
                                       sqlite3_column_name(statement_, column), size, item));
    }
    return {bytes, bytes == nullptr ? 0 : size};
}

}  // namespace ostraka
